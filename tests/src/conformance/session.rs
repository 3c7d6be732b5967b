//! Connection to a robot program, and execution of cases on it.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

use serde_json::{Value, json};

use super::{
    case::{Acknowledge, ConformanceCase, Step},
    pattern::mismatch,
    peer::{DrivePeer, Incoming},
};

/// Time limit of an answer. Programs must answer within 2 s, but machines may be slow.
const ANSWER: Duration = Duration::from_mins(1);

/// Error codes.
const CODES: [&str; 5] = ["bad_request", "not_idle", "limit", "robot", "timeout"];

/// Maximum length of an error message, in bytes.
const MESSAGE_BYTES: usize = 500;

pub(super) struct Session<P> {
    peer: P,
    answers: VecDeque<Value>,
    states: VecDeque<Value>,
    acknowledge: Acknowledge,
    /// Latest state.
    latest: Value,
    /// Violation of a rule for all messages.
    wrong: Option<String>,
}

impl<P: DrivePeer> Session<P> {
    pub(super) fn new(peer: P) -> Self {
        Self {
            peer,
            answers: VecDeque::new(),
            states: VecDeque::new(),
            acknowledge: Acknowledge::Yes,
            latest: Value::Null,
            wrong: None,
        }
    }

    /// Runs a case.
    pub(super) fn run(&mut self, case: &ConformanceCase) -> Result<(), String> {
        self.acknowledge = Acknowledge::Yes;
        self.states.clear();
        for (number, step) in (1..).zip(&case.steps) {
            self.step(step).map_err(|message| format!("step {number}: {message}"))?;
        }
        self.acknowledge = Acknowledge::Yes;
        self.receive(Duration::ZERO)?;
        match self.answers.pop_front() {
            Some(answer) => Err(format!("an answer too many: {answer}")),
            None => Ok(()),
        }
    }

    /// Stops pending actions, and waits for the state idle.
    pub(super) fn come_to_rest(&mut self, within: Duration) -> Result<(), String> {
        self.send(&[json!({"seq": u32::MAX, "type": "stop"}).to_string().into_bytes()]);
        let answered =
            |session: &Self| session.answers.iter().any(|answer| answer["seq"] == json!(u32::MAX));
        if !self.wait(within, answered)? {
            return Err("a stop is not answered".to_owned());
        }
        self.answers.clear();
        let idle = json!({"state": "idle", "run": null});
        self.state(&idle, within)
    }

    fn step(&mut self, step: &Step) -> Result<(), String> {
        match step {
            Step::Send(frames) => {
                self.states.clear();
                self.send(frames);
                Ok(())
            }
            Step::Expect(patterns) => self.expect(patterns),
            Step::ExpectNothing(within) => {
                self.wait(*within, |session| !session.answers.is_empty())?;
                match self.answers.front() {
                    Some(answer) => Err(format!("an answer, {answer}")),
                    None => Ok(()),
                }
            }
            Step::State(pattern, within) => self.state(pattern, *within),
            Step::Acknowledge(how) => {
                self.acknowledge = *how;
                Ok(())
            }
            Step::CountStates { over, at_least, at_most } => {
                self.states.clear();
                self.wait(*over, |_| false)?;
                let count = self.states.len();
                if (*at_least..=*at_most).contains(&count) {
                    return Ok(());
                }
                Err(format!("{count} states in {over:?} instead of {at_least} to {at_most}"))
            }
            Step::Pause(pause) => self.wait(*pause, |_| false).map(drop),
        }
    }

    fn send(&mut self, body: &[Vec<u8>]) {
        self.peer.instruct([&[Vec::new()], body].concat());
    }

    /// Checks that the next answers match these patterns, in any order.
    fn expect(&mut self, patterns: &[Value]) -> Result<(), String> {
        let mut open: Vec<&Value> = patterns.iter().collect();
        while !open.is_empty() {
            self.wait(ANSWER, |session| !session.answers.is_empty())?;
            let answer = self.answers.pop_front().ok_or("no answer")?;
            let fits = |pattern: &&Value| mismatch(pattern, Some(&answer)).is_none();
            let Some(place) = open.iter().position(fits) else {
                let difference = mismatch(open[0], Some(&answer)).unwrap_or_default();
                return Err(format!("{difference}, in {}", shortened(&answer)));
            };
            open.remove(place);
        }
        Ok(())
    }

    /// Waits for a state that matches; earlier states are skipped.
    fn state(&mut self, pattern: &Value, within: Duration) -> Result<(), String> {
        let end = Instant::now() + within;
        let mut last = None;
        loop {
            while let Some(state) = self.states.pop_front() {
                let Some(difference) = mismatch(pattern, Some(&state)) else { return Ok(()) };
                last = Some(format!("{difference}, in {}", shortened(&state)));
            }
            let left = end.saturating_duration_since(Instant::now());
            if !self.wait(left, |session| !session.states.is_empty())? {
                let last = last.unwrap_or_else(|| "no state at all".to_owned());
                return Err(format!("no such state within {within:?}; the last: {last}"));
            }
        }
    }

    /// Receives until `done` or a time-out; returns true if `done`.
    fn wait(&mut self, within: Duration, done: impl Fn(&Self) -> bool) -> Result<bool, String> {
        let end = Instant::now() + within;
        while !done(self) {
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(false);
            }
            self.receive(left)?;
        }
        Ok(true)
    }

    /// Receives all available messages; waits up to `timeout` for the first.
    fn receive(&mut self, timeout: Duration) -> Result<(), String> {
        let mut timeout = timeout;
        while let Some(incoming) = self.peer.next(timeout) {
            timeout = Duration::ZERO;
            match incoming {
                Incoming::Answer(frames) => match message(&frames).and_then(checked_answer) {
                    Ok(answer) => self.answers.push_back(answer),
                    Err(error) => self.wrong = Some(format!("of an answer, {error}")),
                },
                Incoming::State(frames) => {
                    match self.acknowledge {
                        Acknowledge::Yes => self.reply(br#"{"ok":true}"#),
                        Acknowledge::Garbage => self.reply(b"\xff garbage"),
                        Acknowledge::No => {}
                    }
                    match message(&frames).and_then(|state| checked_state(state, &self.latest)) {
                        Ok(state) => {
                            self.latest = state.clone();
                            self.states.push_back(state);
                        }
                        Err(error) => self.wrong = Some(format!("of a state, {error}")),
                    }
                }
            }
        }
        self.wrong.take().map_or(Ok(()), Err)
    }

    fn reply(&mut self, body: &[u8]) {
        self.peer.acknowledge(vec![Vec::new(), body.to_vec()]);
    }
}

/// Parses a message: a JSON object in one frame, after an empty frame.
fn message(frames: &[Vec<u8>]) -> Result<Value, String> {
    let [envelope, body] = frames else { return Err(format!("{} frames", frames.len())) };
    if !envelope.is_empty() {
        return Err("the first frame is not empty".to_owned());
    }
    let text = std::str::from_utf8(body).map_err(|_| "no text in UTF-8")?;
    let value: Value = serde_json::from_str(text).map_err(|error| format!("{error} in {text}"))?;
    if value.is_object() { Ok(value) } else { Err(format!("no object: {text}")) }
}

fn checked_answer(answer: Value) -> Result<Value, String> {
    match answer.get("seq") {
        Some(seq) if seq.is_null() || seq.is_u64() => {}
        _ => return Err(format!("`seq` in {answer}")),
    }
    check_error(answer.get("error"))?;
    Ok(answer)
}

fn checked_state(state: Value, before: &Value) -> Result<Value, String> {
    if !state["boot"].is_u64() || !before.is_null() && before["boot"] != state["boot"] {
        return Err(format!("`boot` in {state} after {before}"));
    }
    let runs = match state["state"].as_str() {
        Some("idle") => false,
        Some("running_motion" | "running_trajectory") => true,
        _ => return Err(format!("`state` in {state}")),
    };
    if state["run"].is_u64() != runs || state["run"].is_null() == runs {
        return Err(format!("`run` in {state}"));
    }
    if let Some(outcome) = state.get("outcome").filter(|outcome| !outcome.is_null()) {
        if !outcome["run"].is_u64() {
            return Err(format!("`run` of the outcome in {state}"));
        }
        check_error(outcome.get("error"))?;
    }
    if !runs && before["run"].is_u64() && before["outcome"]["run"] == state["outcome"]["run"] {
        return Err(format!("a run is over without an outcome: {state} after {before}"));
    }
    Ok(state)
}

/// Checks that an error has a code, and a message that fits on one line.
fn check_error(error: Option<&Value>) -> Result<(), String> {
    let Some(error) = error.filter(|error| !error.is_null()) else { return Ok(()) };
    let code = error["code"].as_str().unwrap_or_default();
    let message = error["message"].as_str().unwrap_or_default();
    if !CODES.contains(&code) {
        return Err(format!("the code of {error}"));
    }
    if message.is_empty() || message.len() > MESSAGE_BYTES || message.contains(char::is_control) {
        return Err(format!("a message that is empty, long or not on one line, in {error}"));
    }
    Ok(())
}

fn shortened(value: &Value) -> String {
    value.to_string().chars().take(600).collect()
}
