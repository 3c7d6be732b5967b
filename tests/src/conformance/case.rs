//! Case files.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    time::Duration,
};

use serde::{Deserialize, Deserializer};
use serde_json::Value;

/// Capabilities that cases may require of a robot program.
pub const NEEDS: [&str; 7] =
    ["motion", "kinematics", "commanding", "no_fri", "io", "temperatures", "times"];

/// Returns the folder with the cases.
#[must_use]
pub fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../sunrise/conformance"))
}

/// Case: sent instructions, and expected answers.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConformanceCase {
    /// Name, unique in its file.
    pub name: String,
    /// Required capabilities of the program.
    #[serde(default)]
    pub needs: Vec<String>,
    pub(super) steps: Vec<Step>,
    /// Line in the file, from 1.
    #[serde(skip)]
    pub line: usize,
}

/// Acknowledgement of state changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Acknowledge {
    Yes,
    No,
    Garbage,
}

#[derive(Debug)]
pub(super) enum Step {
    /// Frames of an instruction's body.
    Send(Vec<Vec<u8>>),
    /// Next answers, in any order.
    Expect(Vec<Value>),
    ExpectNothing(Duration),
    State(Value, Duration),
    Acknowledge(Acknowledge),
    CountStates {
        over: Duration,
        at_least: usize,
        at_most: usize,
    },
    Pause(Duration),
}

/// Keys of a step; exactly one, not counting `within_s`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StepWire {
    send: Option<Value>,
    send_text: Option<String>,
    send_hex: Option<String>,
    send_repeated: Option<RepeatedWire>,
    send_frames: Option<Vec<String>>,
    expect: Option<Value>,
    expect_in_any_order: Option<Vec<Value>>,
    expect_nothing: Option<bool>,
    state: Option<Value>,
    within_s: Option<f64>,
    acknowledge: Option<Value>,
    count_states: Option<CountWire>,
    pause_s: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RepeatedWire {
    text: String,
    times: usize,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CountWire {
    over_s: f64,
    #[serde(default)]
    at_least: usize,
    at_most: Option<usize>,
}

impl<'de> Deserialize<'de> for Step {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        let wire = StepWire::deserialize(reader)?;
        wire.step().ok_or_else(|| serde::de::Error::custom("not exactly one step"))
    }
}

impl StepWire {
    fn step(self) -> Option<Step> {
        let one = |bytes: Vec<u8>| Step::Send(vec![bytes]);
        let within = self.within_s.map(Duration::from_secs_f64);
        let sends = [
            self.send.map(|value| one(value.to_string().into_bytes())),
            self.send_text.map(|text| one(text.into_bytes())),
            self.send_hex.and_then(|text| hex(&text)).map(one),
            self.send_repeated.map(|wire| one(wire.text.repeat(wire.times).into_bytes())),
            self.send_frames
                .map(|frames| Step::Send(frames.into_iter().map(String::into_bytes).collect())),
            self.expect.map(|pattern| Step::Expect(vec![pattern])),
            self.expect_in_any_order.map(Step::Expect),
            self.expect_nothing.and_then(|_| within.map(Step::ExpectNothing)),
            self.state.and_then(|pattern| within.map(|within| Step::State(pattern, within))),
            self.acknowledge.and_then(|how| acknowledge(&how)).map(Step::Acknowledge),
            self.count_states.map(|wire| Step::CountStates {
                over: Duration::from_secs_f64(wire.over_s),
                at_least: wire.at_least,
                at_most: wire.at_most.unwrap_or(usize::MAX),
            }),
            self.pause_s.map(|pause_s| Step::Pause(Duration::from_secs_f64(pause_s))),
        ];
        let mut given = sends.into_iter().flatten();
        given.next().filter(|_| given.next().is_none())
    }
}

fn acknowledge(how: &Value) -> Option<Acknowledge> {
    match how {
        Value::Bool(true) => Some(Acknowledge::Yes),
        Value::Bool(false) => Some(Acknowledge::No),
        Value::String(text) if text == "garbage" => Some(Acknowledge::Garbage),
        _ => None,
    }
}

fn hex(text: &str) -> Option<Vec<u8>> {
    let pairs = (0..text.len()).step_by(2);
    pairs.map(|i| u8::from_str_radix(text.get(i..i + 2)?, 16).ok()).collect()
}

/// Parses the cases of a text, one per line.
///
/// # Errors
///
/// The first line that is not a case, a repeated name, or an unknown capability.
pub fn cases(text: &str) -> Result<Vec<ConformanceCase>, String> {
    let mut names = BTreeSet::new();
    let mut cases = Vec::new();
    for (line, text) in (1..).zip(text.lines()) {
        let mut case: ConformanceCase =
            serde_json::from_str(text).map_err(|error| format!("line {line}: {error}"))?;
        case.line = line;
        if let Some(need) = case.needs.iter().find(|need| !NEEDS.contains(&need.as_str())) {
            return Err(format!("line {line}: an unknown need, {need}"));
        }
        if !names.insert(case.name.clone()) {
            return Err(format!("line {line}: another case is called {}", case.name));
        }
        cases.push(case);
    }
    Ok(cases)
}

/// Returns all files by name, with their cases.
///
/// # Panics
///
/// Panics if a file cannot be read.
#[expect(clippy::expect_used, clippy::panic, reason = "a test fails by it")]
pub(super) fn files() -> Vec<(String, Vec<ConformanceCase>)> {
    let entries = fs::read_dir(folder()).expect("the folder sunrise/conformance");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    let is_list = |path: &Path| path.extension().is_some_and(|extension| extension == "jsonl");
    let mut files = Vec::new();
    for path in paths.into_iter().filter(|path| is_list(path)) {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let text = fs::read_to_string(&path).expect("a text");
        files.push((
            name.clone(),
            cases(&text).unwrap_or_else(|message| panic!("{name}: {message}")),
        ));
    }
    files
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_step_says_one_thing() {
        let case = |step: &str| cases(&format!(r#"{{"name": "a", "steps": [{step}]}}"#));
        for step in [
            r#"{"send": {"seq": 1}}"#,
            r#"{"send_hex": "fffe"}"#,
            r#"{"state": {}, "within_s": 1}"#,
            r#"{"acknowledge": "garbage"}"#,
        ] {
            assert_eq!(case(step).unwrap()[0].steps.len(), 1, "{step}");
        }
        for step in [
            "{}",
            r#"{"state": {}}"#,
            r#"{"send_hex": "f"}"#,
            r#"{"acknowledge": 1}"#,
            r#"{"send": {}, "expect": {}}"#,
            r#"{"sent": {}}"#,
        ] {
            assert!(case(step).is_err(), "{step}");
        }
        assert!(
            cases("{\"name\": \"a\", \"steps\": []}\n{\"name\": \"a\", \"steps\": []}").is_err()
        );
        assert!(cases(r#"{"name": "a", "needs": ["luck"], "steps": []}"#).is_err());
    }
}
