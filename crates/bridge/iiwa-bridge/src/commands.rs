//! Commands from brokers: authorisation, expiry and replay protection.
//!
//! A command wraps a drive request in an envelope, so that a broker that stores or repeats messages
//! cannot move the robot:
//!
//! ```json
//! { "version": 1, "robot": "cell-1", "id": "7f3c", "at": "2026-11-25T22:00:00Z",
//!   "request": { "type": "stop" } }
//! ```
//!
//! A command is refused if the bridge does not accept commands, if the command is malformed or too
//! long, if `at` is not within [`MAX_AGE`] of the bridge clock, or if its `id` has been seen
//! before; broker connections refuse further commands because of their delivery
//! ([`CommandGate::reject`]). The drive checks and executes accepted commands. The reply contains
//! the `id`.

mod envelope;
mod replies;
mod worker;

use std::{
    collections::{HashMap, VecDeque},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, SystemTime},
};

use iiwa_link::message::{Code, Refusal, Request};

use crate::{
    BridgeError,
    message::{CommandCounts, Timestamp},
    robot::BridgedRobot,
};

use envelope::Envelope;
pub use replies::{Answer, CommandReply};
use worker::Worker;

/// Maximum length of a command, in bytes, equal to the maximum length of a drive's list of motions.
pub const MAX_COMMAND_BYTES: usize = iiwa_link::message::MAX_MOTIONS_BYTES;

/// Maximum difference between `at` of a command and the bridge clock.
pub const MAX_AGE: Duration = Duration::from_secs(10);

/// Maximum number of remembered ids: further commands within twice [`MAX_AGE`] are refused.
const MAX_IDS: usize = 10_000;

/// Number of additional ids reserved for stops.
const STOPS: usize = 1000;

/// Checks commands and forwards them to drives.
#[derive(Debug)]
pub struct CommandGate {
    allowed: bool,
    workers: HashMap<String, Worker>,
    seen: Mutex<SeenIds>,
    accepted: AtomicU64,
    refused: AtomicU64,
}

impl CommandGate {
    /// Creates a gate to these robots that accepts commands only if they are `allowed`.
    ///
    /// # Errors
    ///
    /// An address is invalid or requires keys, or a thread cannot be started.
    pub fn new(robots: &[BridgedRobot], allowed: bool) -> Result<Self, BridgeError> {
        let worker = |robot: &BridgedRobot| Ok((robot.name().to_owned(), Worker::start(robot)?));
        let workers = robots.iter().map(worker).collect::<Result<_, BridgeError>>()?;
        Ok(Self {
            allowed,
            workers,
            seen: Mutex::new(SeenIds { since: Timestamp::now(), ids: VecDeque::new() }),
            accepted: AtomicU64::new(0),
            refused: AtomicU64::new(0),
        })
    }

    /// Checks and forwards a command; `robot` is the robot of the topic, if the topic names one.
    /// The reply may be sent from another thread, at the end of a run.
    pub fn command(&self, robot: Option<&str>, body: &[u8], answer: Answer) {
        let (envelope, checked) = self.check(robot, body);
        let robot = envelope.robot.as_deref().or(robot).map(str::to_owned);
        let passed = match checked {
            Ok((worker, request)) => {
                worker.send(envelope.id.clone().unwrap_or_default(), request, answer)
            }
            Err(refusal) => Err((refusal, answer)),
        };
        match passed {
            Ok(()) => {
                self.accepted.fetch_add(1, Ordering::Relaxed);
            }
            Err((refusal, answer)) => self.reply(robot, envelope.id, &refusal, answer),
        }
    }

    /// Refuses a command because of its delivery, and replies, regardless of its content.
    pub fn reject(&self, robot: Option<&str>, body: &[u8], refusal: &Refusal, answer: Answer) {
        let named = if body.len() > MAX_COMMAND_BYTES {
            Envelope::default()
        } else {
            Envelope::read(body).unwrap_or_else(|(named, _)| named)
        };
        let robot = named.robot.as_deref().or(robot).map(str::to_owned);
        self.reply(robot, named.id, refusal, answer);
    }

    /// Counts and logs a refusal, and sends it as the reply.
    fn reply(&self, robot: Option<String>, id: Option<String>, refusal: &Refusal, answer: Answer) {
        self.refused.fetch_add(1, Ordering::Relaxed);
        tracing::warn!("a command was refused: {refusal}");
        answer(CommandReply::refused(robot, id, refusal));
    }

    /// Returns the counts so far.
    #[must_use]
    pub fn counts(&self) -> CommandCounts {
        CommandCounts {
            accepted: self.accepted.load(Ordering::Relaxed),
            refused: self.refused.load(Ordering::Relaxed),
        }
    }

    fn check(
        &self,
        robot: Option<&str>,
        body: &[u8],
    ) -> (Envelope, Result<(&Worker, Request), Refusal>) {
        if body.len() > MAX_COMMAND_BYTES {
            let size = body.len();
            let reason =
                format!("the command has {size} bytes; at most {MAX_COMMAND_BYTES} are allowed");
            return (Envelope::default(), Err(Refusal::bad(reason)));
        }
        match Envelope::read(body) {
            Err((envelope, refusal)) => (envelope, Err(refusal)),
            Ok(envelope) => {
                let checked = self.check_envelope(robot, &envelope);
                (envelope, checked)
            }
        }
    }

    fn check_envelope(
        &self,
        topic: Option<&str>,
        envelope: &Envelope,
    ) -> Result<(&Worker, Request), Refusal> {
        if !self.allowed {
            let reason = "this bridge takes no commands: they are not allowed";
            return Err(Refusal::new(Code::Unauthorized, reason));
        }
        let robot = envelope.robot.as_deref().or(topic);
        let worker = robot.and_then(|robot| self.workers.get(robot)).ok_or_else(|| {
            let names: Vec<_> = self.workers.keys().map(String::as_str).collect();
            Refusal::bad(format!("`robot` has to be one of: {}", names.join(", ")))
        })?;
        if topic.is_some_and(|topic| Some(topic) != robot) {
            return Err(Refusal::bad("`robot` is another one than that of the topic"));
        }
        let request = envelope.request()?;
        let (id, time) = envelope.identity()?;
        let max_ids = if request == Request::Stop { MAX_IDS + STOPS } else { MAX_IDS };
        let mut seen_ids = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        seen_ids.admit(id, time, Timestamp::now(), max_ids)?;
        drop(seen_ids);
        Ok((worker, request))
    }
}

/// Ids of recent commands.
#[derive(Debug)]
struct SeenIds {
    /// Start time of the bridge: a previous bridge may have executed commands sent before.
    since: Timestamp,
    /// Times and ids in order of arrival.
    ids: VecDeque<(Timestamp, String)>,
}

impl SeenIds {
    /// Admits a new command.
    fn admit(
        &mut self,
        id: &str,
        time: Timestamp,
        now: Timestamp,
        max_ids: usize,
    ) -> Result<(), Refusal> {
        let age = SystemTime::from(now).duration_since(time.into());
        let (apart, which) = match age {
            Ok(age) => (age, "ago by the bridge's clock: it is too old"),
            Err(ahead) => (ahead.duration(), "ahead of the bridge's clock: set the clocks"),
        };
        if apart > MAX_AGE {
            let seconds = apart.as_secs_f64();
            return Err(Refusal::new(
                Code::Timeout,
                format!("the command was sent {seconds:.1} s {which}"),
            ));
        }
        if time < self.since {
            let reason = "the command was sent before the bridge was started";
            return Err(Refusal::new(Code::Timeout, reason));
        }
        // Commands with forgotten ids are refused because of their age.
        let forgotten = now.micros().saturating_sub(2_000_000 * MAX_AGE.as_secs());
        while self.ids.front().is_some_and(|(since, _)| since.micros() < forgotten) {
            self.ids.pop_front();
        }
        if self.ids.iter().any(|(_, earlier)| earlier == id) {
            return Err(Refusal::bad("a command with this `id` has been received before"));
        }
        if self.ids.len() >= max_ids {
            return Err(Refusal::robot("too many commands; wait some seconds"));
        }
        self.ids.push_back((now, id.to_owned()));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_passes_once_and_only_in_time() {
        let mut seen_ids = SeenIds { since: Timestamp::from_micros(0), ids: VecDeque::new() };
        let s = |s: u64| Timestamp::from_micros(s * 1_000_000);
        assert!(seen_ids.admit("a", s(100), s(105), MAX_IDS).is_ok());
        assert!(seen_ids.admit("a", s(105), s(105), MAX_IDS).is_err());
        assert!(seen_ids.admit("b", s(116), s(105), MAX_IDS).is_err());
        assert!(seen_ids.admit("c", s(94), s(105), MAX_IDS).is_err());
        assert!(seen_ids.admit("c", s(115), s(105), MAX_IDS).is_ok());
        // The id is still remembered at the maximum age that passes the check.
        assert!(seen_ids.admit("c", s(115), s(125), MAX_IDS).is_err());
        assert!(seen_ids.admit("a", s(126), s(126), MAX_IDS).is_ok());
    }

    #[test]
    fn a_flood_of_ids_is_bounded() {
        let mut seen_ids = SeenIds { since: Timestamp::from_micros(0), ids: VecDeque::new() };
        let now = Timestamp::from_micros(1_000_000_000);
        let admitted =
            (0..MAX_IDS + 5).filter(|i| seen_ids.admit(&i.to_string(), now, now, MAX_IDS).is_ok());
        assert_eq!(admitted.count(), MAX_IDS);
    }
}
