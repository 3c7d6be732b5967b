//! Errors of experiments.

use iiwa_eval::{CompareError, VirtualRobotError, identify::IdentifyError};
use iiwa_program::Fault;
use iiwa_traj::PlanError;

use crate::PictureError;

/// Reason why the report of an experiment cannot be created.
///
/// As usual, a message does not repeat its [source](std::error::Error::source);
/// [`with_causes`](crate::with_causes) returns all of them.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExperimentError {
    /// A program contains a motion that the robot cannot perform.
    #[error("{name}")]
    Path {
        /// Name of the program.
        name: String,
        /// Fault of the program.
        source: Fault,
    },
    /// A program cannot be planned.
    #[error("cannot plan {name}")]
    Planning {
        /// Name of the program.
        name: String,
        /// Cause.
        source: PlanError,
    },
    /// A virtual robot cannot run a program.
    #[error("the virtual robot cannot run {name}")]
    VirtualRobot {
        /// Name of the program.
        name: String,
        /// Cause.
        source: VirtualRobotError,
    },
    /// The recordings do not identify a robot.
    #[error("the recordings do not identify the robot")]
    Identify {
        /// Cause.
        source: IdentifyError,
    },
    /// A recording cannot be compared with the plan of its program.
    #[error("{name} cannot be compared with its plan")]
    Compare {
        /// Name of the program.
        name: String,
        /// Cause.
        source: CompareError,
    },
    /// A figure cannot be drawn.
    #[error(transparent)]
    Figure(#[from] PictureError),
}

impl ExperimentError {
    /// Returns true if the input is at fault, rather than an internal or environmental failure.
    #[must_use]
    pub fn is_input(&self) -> bool {
        matches!(self, Self::Path { .. } | Self::Planning { source: PlanError::Fault(_), .. })
    }
}
