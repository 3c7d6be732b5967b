//! Why a picture or a report cannot be made.

use std::{error::Error, fmt::Write as _};

use iiwa_eval::{CompareError, VirtualRobotError, identify::IdentifyError};
use iiwa_program::Fault;
use iiwa_traj::PlanError;

/// Why a picture or a report cannot be made.
///
/// As usual, a message does not repeat its [source](Error::source); [`with_causes`] gives all of them.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The robot cannot do what a program asks for.
    #[error("{name}")]
    Path {
        /// The program's name.
        name: String,
        /// What it cannot do.
        source: Fault,
    },
    /// A program cannot be planned.
    #[error("cannot plan {name}")]
    Planning {
        /// The program's name.
        name: String,
        /// Why not.
        source: PlanError,
    },
    /// A virtual robot cannot run a program.
    #[error("the virtual robot cannot run {name}")]
    VirtualRobot {
        /// The program's name.
        name: String,
        /// Why not.
        source: VirtualRobotError,
    },
    /// No robot can be identified from the recordings.
    #[error("the recordings do not identify the robot")]
    Identify {
        /// Why not.
        source: IdentifyError,
    },
    /// A recording cannot be compared with the plan of its program.
    #[error("{name} cannot be compared with its plan")]
    Compare {
        /// The program's name.
        name: String,
        /// Why not.
        source: CompareError,
    },
    /// A picture cannot be drawn.
    #[error("cannot draw the picture")]
    Draw {
        /// Why not.
        source: Box<dyn Error + Send + Sync>,
    },
}

impl ReportError {
    /// Whether what was given is at fault, rather than what happened while it was worked on.
    #[must_use]
    pub fn is_input(&self) -> bool {
        matches!(self, Self::Path { .. } | Self::Planning { source: PlanError::Fault(_), .. })
    }
}

/// An error and all its causes in one line.
#[must_use]
pub fn with_causes(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(error) = source {
        let _ = write!(text, ": {error}");
        source = error.source();
    }
    text
}
