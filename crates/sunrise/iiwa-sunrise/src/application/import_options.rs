//! Robot, start position and answers for an import.

use crate::Answers;
use iiwa_kin::{Joints, Robot};

/// Options of an import.
#[derive(Clone, Debug, Default)]
pub struct ImportOptions {
    /// Robot; if absent, the one that the project states. A built-in model gets the flange that is
    /// given, or that the project states.
    pub robot: Option<Robot>,
    /// Name of the given robot in the program; if absent, the robot's own name.
    pub robot_name: Option<String>,
    /// Flange length in m; if absent, the one that the project states.
    pub flange_m: Option<f64>,
    /// Joint positions at the start, in rad; if absent, those in the project's process data
    /// ([`START_ID`](crate::ExportedProject::START_ID)), or else all joints at 0.
    pub start_rad: Option<Joints>,
    /// Answers to the questions of the application.
    pub answers: Answers,
}
