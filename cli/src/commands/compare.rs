//! `iiwasim compare`.

use iiwa_eval::PlannedTrajectory;
use iiwa_log::{PlanRecordError, Positions};
use iiwa_report::{ComparisonReport, draw_comparison, with_causes};

use crate::{
    args::Compare, failure::Failure, input, output, output_kind::OutputKind, picture, terminal,
};

/// Compares a recording with a plan, prints the figures and applies the gates.
pub(crate) fn run(options: &Compare) -> Result<(), Failure> {
    let Compare { plan: plan_file, measured: measured_file, .. } = options;
    if let Some(picture) = &options.picture {
        let read = [("plan", plan_file.as_path()), ("recording", measured_file.as_path())];
        let kind = OutputKind::Picture(picture::format(picture)?);
        output::keep_others(kind, picture, read, "--picture")?;
        kind.check_existing(picture)?;
    }
    let robot = options.robot.as_deref().map(input::find_robot).transpose()?;
    let plan = PlannedTrajectory::read_mcap(input::open(plan_file)?, robot).map_err(|error| {
        let hint = match error {
            PlanRecordError::Robot(_) => "; name its profile with --robot",
            _ => "",
        };
        Failure::input(format!("{}: {}{hint}", plan_file.display(), with_causes(&error)))
    })?;
    let to_failure = |error: &dyn std::error::Error| {
        Failure::input(format!("{}: {}", measured_file.display(), with_causes(error)))
    };
    let measured = input::recording(measured_file, options.log, Positions::Measured)?;
    measured.check_robot(plan.robot()).map_err(|error| to_failure(&error))?;
    let comparison = iiwa_eval::compare(&plan, &measured).map_err(|error| to_failure(&error))?;

    if let Some(file) = &options.picture {
        let drawing = draw_comparison(&plan, &comparison)?;
        output::write(file, &picture::content(file, drawing)?)?;
    }
    let picture = options.picture.as_deref();
    let files = [plan_file.as_path(), measured_file.as_path()];
    let report = ComparisonReport::new(files, picture, &plan, &measured, &comparison);
    if options.json {
        output::print_json(&report)?;
    } else {
        output::print(&report.text(terminal::width()))?;
    }
    let unmet = report.complaint(options.max_error_percent, options.max_deviation_mm);
    unmet.map_or(Ok(()), |unmet| Err(Failure::Gate(unmet)))
}
