//! Why a page cannot be made.

use std::io;

use iiwa_log::{JointLogError, ReadError, RecordedRobotError, WriteError};
use iiwa_scene::ArmMeshError;

/// Why a page cannot be made.
///
/// As usual, a message does not repeat its [source](std::error::Error::source);
/// [`with_causes`](iiwa_report::with_causes) gives all of them.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PageError {
    /// A file cannot be opened or read.
    #[error("cannot read {name}")]
    Open {
        /// The file's name.
        name: String,
        /// What the system reports.
        source: io::Error,
    },
    /// A file has no joint positions that can be shown, or they do not fit the robot.
    #[error("{name}")]
    Recording {
        /// The file's name.
        name: String,
        /// What is wrong with it.
        source: JointLogError,
    },
    /// The plan in a file cannot be read.
    #[error("{name}")]
    Plan {
        /// The file's name.
        name: String,
        /// What is wrong with it.
        source: ReadError,
    },
    /// The robot that a file was made with is unknown, and no other one was given.
    #[error("{name}")]
    UnknownRobot {
        /// The file's name.
        name: String,
        /// Why it is unknown.
        source: RecordedRobotError,
    },
    /// A plan was given as what was measured, and a recording as the plan.
    #[error("{recording} is a recording and {plan} a plan: name the plan first")]
    Swapped {
        /// The file's name.
        recording: String,
        /// The other file's name.
        plan: String,
    },
    /// The program that a recording holds has no plan.
    #[error("the recorded program")]
    RecordedProgram {
        /// Why not.
        source: Box<iiwa_plan::Error>,
    },
    /// A URDF gives no meshes of the arm.
    #[error("no meshes of the arm")]
    Arm {
        /// Why not.
        #[from]
        source: ArmMeshError,
    },
    /// A plan is too long to be drawn.
    #[error("it takes {duration} or more, too long to be drawn")]
    TooLong {
        /// How long it takes, at least.
        duration: String,
    },
    /// A plan that is made for a page cannot be stored.
    #[error("cannot store the plan of the recorded program")]
    Write {
        /// Why not.
        #[from]
        source: WriteError,
    },
    /// Data does not become JSON.
    #[error("cannot write JSON")]
    Json {
        /// Why not.
        source: serde_json::Error,
    },
    /// The caller ended the work.
    #[error("interrupted")]
    Interrupted,
}

impl PageError {
    /// Whether what was given is at fault, rather than what happened while it was worked on.
    #[must_use]
    pub fn is_input(&self) -> bool {
        !matches!(self, Self::Write { .. } | Self::Json { .. } | Self::Interrupted)
    }
}
