//! Beginnings and ends of runs, as the drive publishes them.

use serde::{Deserialize, Serialize};

use crate::{
    message::{
        refusal::Refusal,
        reply::{DriveState, Run, TimedBy},
        run_label::RunLabel,
    },
    robot_program::RunId,
};

/// The beginning or the end of a run, published under the topic `run`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunEvent {
    /// Time stamp of the stream, in s.
    pub t_s: f64,
    /// The number of the run, different for each run of a drive and with each start of a drive.
    pub run: RunId,
    /// What runs: motions or a trajectory.
    pub kind: DriveState,
    /// The client's label.
    #[serde(default, skip_serializing_if = "RunLabel::is_empty")]
    pub label: RunLabel,
    /// How it ended; `None` at its beginning.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end: Option<RunEnd>,
}

/// The end of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct RunEnd {
    /// Time from the start to the end of the run, in s, if both are known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycle_time_s: Option<f64>,
    /// Start of the run, in s on the time scale of the stream, if it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_s: Option<f64>,
    /// What start and end were taken from; `None` for the clock of the robot program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timed_by: Option<TimedBy>,
    /// Why the run did not succeed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<Refusal>,
}

impl RunEnd {
    /// The end of a run with these measurements, and with this error.
    #[must_use]
    pub fn new(run: &Run, error: Option<Refusal>) -> Self {
        Self { cycle_time_s: run.cycle_time_s, start_s: run.start_s, timed_by: run.timed_by, error }
    }
}
