//! Common evaluation of recordings.

use iiwa_eval::{
    experiment::Trial,
    identify::{Identified, LeftOut, RecordedRun, identify},
};
use iiwa_kin::Robot;
use iiwa_path::{JointPath, PathOptions};
use iiwa_plan::PlanOptions;
use iiwa_traj::{Timing, Trajectory};

use crate::ExperimentError;

use super::bench::{Bench, TrialRun};

/// Identifies the robot from the recordings.
pub(super) fn identified(bench: &Bench, runs: &[TrialRun]) -> Result<Identified, ExperimentError> {
    let recordings: Vec<_> =
        runs.iter().map(|run| RecordedRun { program: &run.trial.program, log: &run.log }).collect();
    identify(&recordings, &bench.model).map_err(|source| ExperimentError::Identify { source })
}

/// Reports the unused parts of the recordings.
pub(super) fn left_out(runs: &[TrialRun], left_out: &[LeftOut]) -> String {
    match left_out {
        [] => String::new(),
        [first, ..] => {
            let LeftOut { recording, motion, why, .. } = first;
            let name = runs.get(*recording).map_or("", |run| run.trial.name.as_str());
            format!(
                "Not used: {} motions; the first of them is motion {motion} of `{name}`: {why}.",
                left_out.len()
            )
        }
    }
}

/// Returns mean and standard deviation.
pub(super) fn spread(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0).max(1.0)).sqrt())
}

/// Returns the path of the program for the model.
pub(super) fn path(
    bench: &Bench,
    trial: &Trial,
    options: PathOptions,
) -> Result<JointPath, ExperimentError> {
    JointPath::with_options(&trial.program, &bench.model, options)
        .map_err(|source| ExperimentError::Path { name: trial.name.clone(), source })
}

/// Returns the plan of the program for a robot.
pub(super) fn planned(
    robot: &Robot,
    trial: &Trial,
    timing: Timing,
) -> Result<Trajectory, ExperimentError> {
    PlanOptions::with_timing(timing)
        .plan(&trial.program, robot)
        .map_err(|source| ExperimentError::Planning { name: trial.name.clone(), source })
}
