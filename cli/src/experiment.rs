//! The thesis's experiments, done again: which programs, and what is told of their recordings.

mod arm;
mod blends;
mod chapter;
mod cycle_time;
mod folder;
mod limits;
mod other_robot;
mod settle;
mod zone_velocity;

use iiwa_eval::{
    experiment::{self, Trial},
    identify::{Identified, LeftOut, Recording, identify},
};
use iiwa_kin::Robot;
use iiwa_log::JointLog;

use crate::failure::Failure;

pub(crate) use arm::{Arm, VirtualArm};
pub(crate) use chapter::{Chapter, wrapped};
pub(crate) use folder::{Folder, write};
pub(crate) use other_robot::other_robot;

/// One of the experiments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Limits,
    Blends,
    ZoneVelocity,
    Settle,
    CycleTime,
}

/// What an experiment is done with.
pub(crate) struct Bench {
    /// What is calculated is calculated for it.
    pub(crate) model: Robot,
    pub(crate) seed: u64,
    /// How many poses, points or paths, if fewer than the thesis has.
    pub(crate) count: Option<usize>,
    /// What ran the programs, in words: `on a virtual robot`.
    pub(crate) on: String,
    /// What stands before a figure's name in a link to it.
    pub(crate) link: String,
}

/// A program, and what was recorded while it ran.
pub(crate) struct Run {
    pub(crate) trial: Trial,
    pub(crate) log: JointLog,
}

/// Share of full speed at which section 4.2 is run; the thesis does not state its own. The path does not
/// depend on it.
const BLENDS_VELOCITY_REL: f64 = 0.5;

impl Kind {
    pub(crate) const ALL: [Self; 5] =
        [Self::Limits, Self::Blends, Self::ZoneVelocity, Self::Settle, Self::CycleTime];

    /// The programs.
    pub(crate) fn trials(self, bench: &Bench) -> Vec<Trial> {
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

    /// Samples of the virtual robot a second: the more, the shorter the phases of jerk that they show.
    pub(crate) fn rate_hz(self) -> f64 {
        if self == Self::CycleTime { 200.0 } else { 1000.0 }
    }

    /// What came of it.
    pub(crate) fn chapter(self, bench: &Bench, runs: &[Run]) -> Result<Chapter, Failure> {
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
fn identified(bench: &Bench, runs: &[Run]) -> Result<Identified, Failure> {
    let recordings: Vec<_> =
        runs.iter().map(|run| Recording { program: &run.trial.program, log: &run.log }).collect();
    identify(&recordings, &bench.model)
        .map_err(|error| Failure::run("the recordings tell nothing of the robot", &error))
}

/// Says what of the recordings was not used.
fn left_out(runs: &[Run], left_out: &[LeftOut]) -> String {
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
) -> Result<iiwa_path::JointPath, Failure> {
    iiwa_path::JointPath::with_options(&trial.program, &bench.model, options)
        .map_err(|fault| Failure::input(format!("{}: {fault}", trial.name)))
}

/// The program as the model plans it.
fn plan(
    bench: &Bench,
    trial: &Trial,
    timing: iiwa_traj::Timing,
) -> Result<iiwa_traj::Trajectory, Failure> {
    let path = path(bench, trial, iiwa_path::PathOptions::default())?;
    iiwa_traj::Trajectory::plan(&path, timing)
        .map_err(|error| Failure::run(format!("cannot plan {}", trial.name), &error))
}
