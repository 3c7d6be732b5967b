//! Statistics of the FRI connection.

use std::fmt;

use iiwa_fri::{Quality, SessionState};

use crate::latency::{LateAnswer, Latency};

/// Statistics of the FRI connection, as measured by the controller.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ConnectionReport {
    /// Messages sent.
    pub cycles: u64,
    /// Cycles in which the simulation itself was late and its clock waited.
    pub delayed_cycles: u64,
    /// `true` if the simulation clock has real-time priority.
    pub real_time: bool,
    /// Times from messages to their answers.
    pub latency: Latency,
    /// Answers more than one cycle after their messages, at most the first ten thousand.
    pub late: Vec<LateAnswer>,
    /// Messages without an answer a thousand messages later. With a receive multiplier above 1,
    /// most messages do not require an answer.
    pub unanswered: u64,
    /// Session state.
    pub session: SessionState,
    /// Connection quality.
    pub quality: Quality,
}

/// Formats the number of messages and the answer latency.
impl fmt::Display for ConnectionReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let micros = |share| {
            let latency = self.latency.quantile(share);
            latency.map_or_else(|| "-".to_owned(), |t| format!("{} us", t.as_micros()))
        };
        write!(
            f,
            "{} messages, {} answers: after {} (median), {} (99.9 %), {} (maximum); {} cycles \
             delayed by this machine",
            self.cycles,
            self.latency.count(),
            micros(0.5),
            micros(0.999),
            micros(1.0),
            self.delayed_cycles
        )
    }
}
