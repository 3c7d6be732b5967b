//! Setup of an experiment, and its recordings.

use iiwa_eval::experiment::Trial;
use iiwa_kin::{Load, Robot};
use iiwa_log::JointLog;

/// Setup of an experiment.
#[derive(Clone, Debug)]
pub struct Bench {
    /// Robot model of all calculations.
    pub model: Robot,
    /// Seed of random programs.
    pub seed: u64,
    /// Load of the load experiment.
    pub load: Load,
    /// Number of poses, points or paths, if fewer than in the thesis.
    pub count: Option<usize>,
    /// Text for the robot that ran the programs: `on a virtual robot`.
    pub on: String,
    /// Path from the report to the folder of the figures: empty, or with a trailing slash.
    pub link: String,
}

/// Program and its recording.
#[derive(Clone, Debug)]
pub struct TrialRun {
    /// Program.
    pub trial: Trial,
    /// Recording.
    pub log: JointLog,
}
