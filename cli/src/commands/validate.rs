//! `iiwasim validate`.

use iiwa_eval::PlannedTrajectory;
use iiwa_log::Positions;
use iiwa_plan::PlanOptions;
use iiwa_report::{ValidationReport, with_causes};
use iiwa_traj::SweepOptions;

use crate::{args::Validate, failure::Failure, input, output, terminal};

/// Plans the program, compares the recording with the plan and prints the figures.
pub(crate) fn run(options: &Validate) -> Result<(), Failure> {
    let mut input = input::program(&options.program, options.robot.as_deref())?;
    input.request.speed_override = options.speed_override.map(|percent| 0.01 * percent);
    input.request.options = PlanOptions::with_timing(options.timing.with(SweepOptions::default()));
    let robot = input.robot()?;
    let log = input::recording(&options.recording, options.log, Positions::Commanded)?;
    let to_failure = |error: &dyn std::error::Error| {
        Failure::input(format!("{}: {}", options.recording.display(), with_causes(error)))
    };
    log.check_robot(&robot).map_err(|error| to_failure(&error))?;
    let plan = input.plan()?;
    let comparison =
        iiwa_eval::compare(&PlannedTrajectory::from_trajectory(&plan.trajectory), &log)
            .map_err(|error| to_failure(&error))?;
    let report = ValidationReport::new(
        [&options.recording, &options.program],
        &log,
        &plan.figures(),
        &comparison,
    );
    if options.json {
        output::print_json(&report)
    } else {
        output::print(&report.text(terminal::width()))
    }
}
