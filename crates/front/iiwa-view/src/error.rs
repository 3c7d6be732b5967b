//! Why a page, a picture or a report cannot be made.

use std::{error::Error, fmt::Write as _, io};

use iiwa_eval::{CompareError, VirtualRobotError, identify::IdentifyError};
use iiwa_log::{JointLogError, ReadError, RecordedRobotError, WriteError};
use iiwa_program::Fault;
use iiwa_scene::ArmMeshError;
use iiwa_traj::PlanError;

/// Why a page, a picture or a report cannot be made.
///
/// As usual, a message does not repeat its [source](Error::source); [`with_causes`] gives all of them.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
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

impl ViewError {
    /// Whether what was given is at fault, rather than what happened while it was worked on.
    #[must_use]
    pub fn is_input(&self) -> bool {
        match self {
            Self::Open { .. }
            | Self::Recording { .. }
            | Self::Plan { .. }
            | Self::UnknownRobot { .. }
            | Self::Swapped { .. }
            | Self::RecordedProgram { .. }
            | Self::Arm { .. }
            | Self::Path { .. }
            | Self::Planning { source: PlanError::Fault(_), .. }
            | Self::TooLong { .. } => true,
            Self::Planning { .. }
            | Self::Write { .. }
            | Self::VirtualRobot { .. }
            | Self::Identify { .. }
            | Self::Compare { .. }
            | Self::Draw { .. }
            | Self::Json { .. }
            | Self::Interrupted => false,
        }
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
