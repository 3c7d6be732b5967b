//! The robot, the start and the answers with which an application is imported.

use iiwa_kin::{Joints, Robot};
use iiwa_sunrise::Answers;

/// How an application is imported.
#[derive(Clone, Debug, Default)]
pub struct ImportOptions {
    /// The robot that runs it; if absent, the one that the project states. A built-in model has the flange that is given, or
    /// that the project states.
    pub robot: Option<Robot>,
    /// What the program calls the robot that is given; its own name if absent.
    pub robot_name: Option<String>,
    /// The length of the robot's flange, in m; if absent, the one that the project states.
    pub flange_m: Option<f64>,
    /// Where the arm stands when it begins, in rad; if absent, where the project's process data say
    /// ([`START_ID`](iiwa_sunrise::ExportedProject::START_ID)), or else with all joints at 0.
    pub start_rad: Option<Joints>,
    /// What it is answered where it asks.
    pub answers: Answers,
}
