//! Errors of pages.

use std::io;

use iiwa_log::{JointLogError, PlanRecordError, RecordedRobotError, WriteError};
use iiwa_scene::ArmMeshError;

/// Reason why a page cannot be created.
///
/// As usual, a message does not repeat its [source](std::error::Error::source);
/// [`with_causes`](iiwa_report::with_causes) returns all of them.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PageError {
    /// A file cannot be opened or read.
    #[error("cannot read {name}")]
    Open {
        /// Name of the file.
        name: String,
        /// Error of the system.
        source: io::Error,
    },
    /// A file has no joint positions to show, or they do not fit the robot.
    #[error("{name}")]
    Recording {
        /// Name of the file.
        name: String,
        /// Fault of the file.
        source: JointLogError,
    },
    /// The plan in a file cannot be read.
    #[error("{name}")]
    Plan {
        /// Name of the file.
        name: String,
        /// Fault of the file.
        source: PlanRecordError,
    },
    /// The robot of a file is unknown, and no other robot was given.
    #[error("{name}")]
    UnknownRobot {
        /// Name of the file.
        name: String,
        /// Cause.
        source: RecordedRobotError,
    },
    /// A plan was given as the measurement, and a recording as the plan.
    #[error("{recording} is a recording and {plan} a plan: name the plan first")]
    Swapped {
        /// Name of the recording.
        recording: String,
        /// Name of the plan.
        plan: String,
    },
    /// A program cannot be planned for the page.
    #[error("the program")]
    Program {
        /// Cause.
        source: Box<iiwa_plan::Error>,
    },
    /// A URDF contains no meshes of the arm.
    #[error("no meshes of the arm")]
    Arm {
        /// Cause.
        #[from]
        source: ArmMeshError,
    },
    /// A plan is too long to draw.
    #[error("it takes {duration} or more, too long to be drawn")]
    TooLong {
        /// Lower bound on its duration.
        duration: String,
    },
    /// A plan computed for a page cannot be stored.
    #[error("cannot store the plan of a program")]
    Write {
        /// Cause.
        #[from]
        source: WriteError,
    },
    /// Data cannot be converted to JSON.
    #[error("cannot write JSON")]
    Json {
        /// Cause.
        source: serde_json::Error,
    },
    /// The caller interrupted the work.
    #[error("interrupted")]
    Interrupted,
}

impl PageError {
    pub(crate) fn program(source: iiwa_plan::Error) -> Self {
        Self::Program { source: Box::new(source) }
    }

    /// Returns true if the input is at fault, rather than an internal failure.
    #[must_use]
    pub fn is_input(&self) -> bool {
        !matches!(self, Self::Write { .. } | Self::Json { .. } | Self::Interrupted)
    }
}
