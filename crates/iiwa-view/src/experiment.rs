//! The thesis's experiments, done again: their programs, and reports on what was recorded.

mod blends;
mod chapter;
mod cycle_time;
mod limits;
mod other_robot;
mod settle;
mod virtual_arm;
mod zone_velocity;

use iiwa_eval::{
    experiment::{self, Trial},
    identify::{Identified, LeftOut, Recording, identify},
};
use iiwa_kin::Robot;
use iiwa_log::JointLog;

use crate::ViewError;

pub use chapter::{Chapter, wrapped};
pub use other_robot::other_robot;
pub use virtual_arm::VirtualArm;

/// An experiment of the thesis (Larsen 2019).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExperimentKind {
    /// Limits of the joints (Appendix A).
    Limits,
    /// The curve of blends (sections 4.2 and 4.3).
    Blends,
    /// The velocity in blends (Appendix B).
    ZoneVelocity,
    /// The time to settle (Appendix C).
    Settle,
    /// Errors of the cycle time (section 5.1.2).
    CycleTime,
}

/// What an experiment is done with.
#[derive(Clone, Debug)]
pub struct Bench {
    /// The robot that everything is calculated for.
    pub model: Robot,
    /// Seed of random programs.
    pub seed: u64,
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

/// Share of full speed at which section 4.2 is run; the thesis does not state its own. The path does not
/// depend on it.
const BLENDS_VELOCITY_REL: f64 = 0.5;

impl ExperimentKind {
    /// All experiments, in the order of the report.
    pub const ALL: [Self; 5] =
        [Self::Limits, Self::Blends, Self::ZoneVelocity, Self::Settle, Self::CycleTime];

    /// The programs of the experiment.
    #[must_use]
    pub fn trials(self, bench: &Bench) -> Vec<Trial> {
        let Bench { model, seed, .. } = bench;
        let count = |most: usize| bench.count.unwrap_or(most).min(most);
        match self {
            Self::Limits => {
                let mut trials = experiment::limits();
                let wide = trials.pop();
                trials.truncate(count(trials.len()));
                trials.extend(wide);
                trials
            }
            Self::Blends => vec![experiment::blends(BLENDS_VELOCITY_REL)],
            Self::ZoneVelocity => vec![experiment::zone_velocity()],
            Self::Settle => vec![experiment::settle(model, count(200), *seed)],
            Self::CycleTime => cycle_time::trials(bench, count(5)),
        }
    }

    /// Sample rate of a virtual robot in Hz: high enough to show the phases of constant jerk.
    #[must_use]
    pub fn rate_hz(self) -> f64 {
        if self == Self::CycleTime { 200.0 } else { 1000.0 }
    }

    /// The report on what was recorded.
    ///
    /// # Errors
    ///
    /// [`ViewError`] if the recordings do not show what the experiment is about, or a picture cannot be
    /// drawn.
    pub fn chapter(self, bench: &Bench, runs: &[TrialRun]) -> Result<Chapter, ViewError> {
        match self {
            Self::Limits => limits::chapter(bench, runs),
            Self::Blends => blends::chapter(bench, runs),
            Self::ZoneVelocity => zone_velocity::chapter(bench, runs),
            Self::Settle => settle::chapter(bench, runs),
            Self::CycleTime => cycle_time::chapter(bench, runs),
        }
    }
}

/// What the recordings tell of the robot.
fn identified(bench: &Bench, runs: &[TrialRun]) -> Result<Identified, ViewError> {
    let recordings: Vec<_> =
        runs.iter().map(|run| Recording { program: &run.trial.program, log: &run.log }).collect();
    identify(&recordings, &bench.model).map_err(|source| ViewError::Identify { source })
}

/// Says what of the recordings was not used.
fn left_out(runs: &[TrialRun], left_out: &[LeftOut]) -> String {
    match left_out {
        [] => String::new(),
        [first, ..] => {
            let LeftOut { recording, motion, why, .. } = first;
            let name = runs.get(*recording).map_or("", |run| run.trial.name.as_str());
            format!(
                "Not used: {} motions; the first of them is motion {} of `{name}`: {why}.",
                left_out.len(),
                motion + 1
            )
        }
    }
}

/// Mean and standard deviation.
fn spread(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0).max(1.0)).sqrt())
}

/// The program's path as the model has it.
fn path(
    bench: &Bench,
    trial: &Trial,
    options: iiwa_path::PathOptions,
) -> Result<iiwa_path::JointPath, ViewError> {
    iiwa_path::JointPath::with_options(&trial.program, &bench.model, options)
        .map_err(|source| ViewError::Path { name: trial.name.clone(), source })
}

/// The program as the model plans it.
fn plan(
    bench: &Bench,
    trial: &Trial,
    timing: iiwa_traj::Timing,
) -> Result<iiwa_traj::Trajectory, ViewError> {
    let path = path(bench, trial, iiwa_path::PathOptions::default())?;
    iiwa_traj::Trajectory::plan(&path, timing)
        .map_err(|source| ViewError::Timing { name: trial.name.clone(), source })
}
