//! Run start and end events, as published by the drive.

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
    /// Stream time, in s.
    pub t_s: f64,
    /// Number of the run, unique among the runs and starts of a drive.
    pub run: RunId,
    /// Kind of the run: motions or a trajectory.
    pub kind: DriveState,
    /// The client's label.
    #[serde(default, skip_serializing_if = "RunLabel::is_empty")]
    pub label: RunLabel,
    /// End of the run; `None` at its beginning.
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
    /// Start of the run, in s on the time scale of the stream, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_s: Option<f64>,
    /// Source of start and end; `None` for the clock of the robot program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timed_by: Option<TimedBy>,
    /// The reason why the run did not succeed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<Refusal>,
}

impl RunEnd {
    /// Creates the end of a run from its measurements and its error.
    #[must_use]
    pub fn new(run: &Run, error: Option<Refusal>) -> Self {
        Self { cycle_time_s: run.cycle_time_s, start_s: run.start_s, timed_by: run.timed_by, error }
    }
}
