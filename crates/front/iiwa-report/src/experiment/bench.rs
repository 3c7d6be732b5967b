//! What an experiment is done with, and what was recorded.

use iiwa_eval::experiment::Trial;
use iiwa_kin::{Load, Robot};
use iiwa_log::JointLog;

/// What an experiment is done with.
#[derive(Clone, Debug)]
pub struct Bench {
    /// The robot that everything is calculated for.
    pub model: Robot,
    /// Seed of random programs.
    pub seed: u64,
    /// The load of the experiment with one.
    pub load: Load,
    /// How many poses, points or paths, if fewer than the thesis has.
    pub count: Option<usize>,
    /// What ran the programs, in words: `on a virtual robot`.
    pub on: String,
    /// The path from the report to the folder of the figures: empty, or with a slash at its end.
    pub link: String,
}

/// A program, and what was recorded while it ran.
#[derive(Clone, Debug)]
pub struct TrialRun {
    /// The program.
    pub trial: Trial,
    /// What was recorded.
    pub log: JointLog,
}
