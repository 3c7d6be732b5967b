//! How a run went beside its plan, as JSON and in words.

use std::{fmt::Write as _, path::Path};

use iiwa_eval::{Plan, compare};
use iiwa_log::JointLog;
use serde::Serialize;

use crate::signed::signed;

/// How a run went beside its plan. As JSON, this is the object of `iiwasim run --json`.
///
/// The measured cycle time is that of `iiwasim compare` and of the report: from departure to arrival as the joint
/// positions tell, plus the plan's standing at the start and the end. It is finer than the cycle in which the robot
/// program counts. Where the positions do not tell (an arm that does not move), the robot program's time is taken.
#[derive(Clone, Debug, Serialize)]
pub struct RunReport {
    planned_cycle_time_s: f64,
    measured_cycle_time_s: Option<f64>,
    error_s: Option<f64>,
    error_percent: Option<f64>,
    /// As the robot program counts it, in whole cycles.
    robot_program_cycle_time_s: Option<f64>,
    /// The usual time between two samples.
    sample_step_s: Option<f64>,
    /// When a run that broke off did so.
    ended_after_s: Option<f64>,
    samples: usize,
    output: Option<String>,
}

impl RunReport {
    /// Of the run of a plan, whose log has the robot program's time if that reported one. `file` has the samples, if
    /// they were written.
    #[must_use]
    pub fn new(plan: &Plan, measured: &JointLog, complete: bool, file: Option<&Path>) -> Self {
        let planned_s = plan.cycle_time_s();
        let stated_s = measured.cycle_time_s;
        let measured_s = complete.then(|| measured_cycle_time_s(plan, measured)).flatten();
        // As Eq. 40 of the thesis has it: of the measured time.
        let error_s = measured_s.map(|measured_s| planned_s - measured_s);
        Self {
            planned_cycle_time_s: planned_s,
            measured_cycle_time_s: measured_s,
            error_s,
            error_percent: error_s
                .zip(measured_s)
                .map(|(error, measured)| 100.0 * error / measured),
            robot_program_cycle_time_s: stated_s.filter(|_| complete),
            sample_step_s: measured.period_s(),
            ended_after_s: stated_s.filter(|_| !complete),
            samples: measured.t_s.len(),
            output: file.map(|file| file.display().to_string()),
        }
    }

    /// In words.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = String::new();
        let planned_s = self.planned_cycle_time_s;
        if let (Some(measured_s), Some(error_s), Some(percent)) =
            (self.measured_cycle_time_s, self.error_s, self.error_percent)
        {
            let _ = writeln!(
                text,
                "Measured   {measured_s:.3} s, planned {planned_s:.3} s: the plan is off by \
                 {} s, {} %",
                signed(error_s, 3),
                signed(percent, 2)
            );
        }
        if let Some(stated_s) = self.robot_program_cycle_time_s {
            let step = self.sample_step_s.map_or_else(String::new, |step_s| {
                format!(", in cycles of {:.0} ms", 1e3 * step_s)
            });
            let _ = writeln!(text, "           {stated_s:.3} s by the robot program's clock{step}");
        }
        if let Some(after_s) = self.ended_after_s {
            let _ = writeln!(text, "Ended after {after_s:.3} s of {planned_s:.3} s");
        }
        if let Some(file) = &self.output {
            let _ = writeln!(text, "{} samples recorded in {file}", self.samples);
        }
        text
    }
}

/// The cycle time of a run, in s, see [`RunReport`].
fn measured_cycle_time_s(plan: &Plan, measured: &JointLog) -> Option<f64> {
    compare(plan, measured)
        .map(|comparison| comparison.cycle_time.real_s)
        .ok()
        .or(measured.cycle_time_s)
}
