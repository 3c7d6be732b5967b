//! `iiwasim validate`.

use iiwa_eval::Plan;
use iiwa_log::{PlanFigures, PlanOptions, Positions};
use iiwa_traj::SweepOptions;
use iiwa_view::{ValidationReport, with_causes};

use crate::{args::Validate, failure::Failure, input, output};

/// Plans the program, compares the recording with the plan and prints the figures.
pub(crate) fn run(options: &Validate) -> Result<(), Failure> {
    let (text, mut program, robot) = input::program(&options.program, options.robot.as_deref())?;
    if let Some(percent) = options.speed_override {
        program.workcell.speed_override = Some(0.01 * percent);
    }
    let log = input::recording(&options.recording, options.log, Positions::Commanded)?;
    let refuse = |error: &dyn std::error::Error| {
        Failure::input(format!("{}: {}", options.recording.display(), with_causes(error)))
    };
    log.check_robot(&robot).map_err(|error| refuse(&error))?;
    let how = PlanOptions::with_timing(options.timing.with(SweepOptions::default()));
    let trajectory = how
        .plan(&program, &robot)
        .map_err(|error| Failure::plan(&error, &program.sources, &text.name, &text.text))?;
    let comparison = iiwa_eval::compare(&Plan::from_trajectory(&trajectory), &log)
        .map_err(|error| refuse(&error))?;
    let report = ValidationReport::new(
        [&options.recording, &options.program],
        &log,
        &PlanFigures::of(&trajectory, &how),
        &comparison,
    );
    if options.json { output::print_json(&report) } else { output::print(&report.text()) }
}
