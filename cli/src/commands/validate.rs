//! `iiwasim validate`.

use iiwa_eval::Plan;
use iiwa_log::{PlanFigures, PlanOptions, Positions};
use iiwa_traj::{JerkOptions, SweepOptions, Timing};
use iiwa_view::{ValidationReport, with_causes};

use crate::{
    args::{self, Validate},
    failure::Failure,
    input, output,
};

/// Plans the program, compares the recording with the plan and prints the figures.
pub(crate) fn run(options: &Validate) -> Result<(), Failure> {
    let (text, program, robot) = input::program(&options.program, options.robot.as_deref())?;
    let mut log = input::recording(&options.recording, options.log, Positions::Commanded)?;
    let refuse = |error: &dyn std::error::Error| {
        Failure::input(format!("{}: {}", options.recording.display(), with_causes(error)))
    };
    log.check_robot(&robot).map_err(|error| refuse(&error))?;
    let how = PlanOptions::with_timing(timing(options.timing));
    let trajectory = how
        .plan(&program, &robot)
        .map_err(|error| Failure::plan(&error, &program.sources, &text.name, &text.text))?;
    // As the robot would have done it at full override.
    let first_s = log.t_s.first().copied().unwrap_or_default();
    for t_s in &mut log.t_s {
        *t_s = (*t_s - first_s) * 0.01 * options.override_percent;
    }
    let comparison = iiwa_eval::compare(&Plan::from_trajectory(&trajectory), &log)
        .map_err(|error| refuse(&error))?;
    let report = ValidationReport::new(
        [&options.recording, &options.program],
        &log,
        &PlanFigures::of(&trajectory, &how),
        &comparison,
        options.override_percent,
    );
    if options.json { output::print_json(&report) } else { output::print(&report.text()) }
}

fn timing(timing: args::Timing) -> Timing {
    match timing {
        args::Timing::Acceleration => Timing::Acceleration(SweepOptions::default()),
        args::Timing::Jerk => Timing::Jerk(JerkOptions::default()),
        args::Timing::Sunrise => Timing::Sunrise(JerkOptions::default()),
    }
}
