//! Result of a run beside its plan, as JSON and as text.

use std::{fmt::Write as _, path::Path};

use iiwa_eval::{PlannedTrajectory, compare};
use iiwa_log::{CycleClock, JointLog};
use serde::Serialize;

use crate::{signed::signed, stated_time::stated_time};

/// Result of a run beside its plan. As JSON, this is the object of `iiwasim run --json`.
///
/// The measured cycle time is that of `iiwasim compare` and of the report: from departure to
/// arrival according to the joint positions, plus the plan's standstill at start and end. It is
/// finer than the cycle of the robot program's clock. If the positions show no departure or arrival
/// (an arm that does not move), the measured cycle time is that of the robot program, or that of
/// the commanded positions plus the plan's standstill.
#[derive(Clone, Debug, Serialize)]
pub struct RunReport {
    planned_cycle_time_s: f64,
    measured_cycle_time_s: Option<f64>,
    error_s: Option<f64>,
    error_percent: Option<f64>,
    /// Cycle time of the robot program, in whole cycles.
    robot_program_cycle_time_s: Option<f64>,
    /// Time from the first to the last change of the commanded positions, if the robot program
    /// reported no times.
    #[serde(skip_serializing_if = "Option::is_none")]
    commanded_cycle_time_s: Option<f64>,
    /// Standstill of the plan at start and end, which `commanded_cycle_time_s` does not include.
    #[serde(skip)]
    standing_s: f64,
    /// Median time between two samples.
    sample_step_s: Option<f64>,
    /// End of a run that was aborted.
    ended_after_s: Option<f64>,
    samples: usize,
    output: Option<String>,
}

impl RunReport {
    /// Creates the report on the run of a plan. The log has the robot program's time if the robot
    /// program reported it. `file` contains the samples, if written.
    #[must_use]
    pub fn new(
        plan: &PlannedTrajectory,
        measured: &JointLog,
        complete: bool,
        file: Option<&Path>,
    ) -> Self {
        let planned_s = plan.cycle_time_s();
        let stated_s = measured.cycle_time_s;
        let complete_s = |by| stated_s.filter(|_| complete && measured.timed_by == by);
        let measured_s = complete.then(|| measured_cycle_time_s(plan, measured)).flatten();
        // Relative to the measured time, as in Eq. 40 of the thesis.
        let error_s = measured_s.map(|measured_s| planned_s - measured_s);
        Self {
            planned_cycle_time_s: planned_s,
            measured_cycle_time_s: measured_s,
            error_s,
            error_percent: error_s
                .zip(measured_s)
                .map(|(error, measured)| 100.0 * error / measured),
            robot_program_cycle_time_s: complete_s(CycleClock::RobotProgram),
            commanded_cycle_time_s: complete_s(CycleClock::CommandedPosition),
            standing_s: plan.standing_s(),
            sample_step_s: measured.period_s(),
            ended_after_s: stated_s.filter(|_| !complete),
            samples: measured.t_s.len(),
            output: file.map(|file| file.display().to_string()),
        }
    }

    /// Formats the report as text.
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
        let stated = [
            (self.robot_program_cycle_time_s, CycleClock::RobotProgram),
            (self.commanded_cycle_time_s, CycleClock::CommandedPosition),
        ];
        for (stated_s, timed_by) in stated {
            let Some(stated_s) = stated_s else { continue };
            let plan_s = [planned_s, self.standing_s];
            let stated = stated_time(stated_s, timed_by, self.sample_step_s, plan_s);
            let _ = writeln!(text, "           {stated}");
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

/// Returns the cycle time of a run, in s, see [`RunReport`].
fn measured_cycle_time_s(plan: &PlannedTrajectory, measured: &JointLog) -> Option<f64> {
    compare(plan, measured).map(|comparison| comparison.cycle_time.real_s).ok().or_else(|| {
        let stands_s = match measured.timed_by {
            CycleClock::CommandedPosition => plan.standing_s(),
            _ => 0.0,
        };
        Some(measured.cycle_time_s? + stands_s)
    })
}
