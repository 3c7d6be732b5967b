//! `iiwasim identify`.

use std::{path::Path, sync::Arc};

use iiwa_eval::identify::{RecordedRun, identify};
use iiwa_kin::Robot;
use iiwa_log::{JointLog, Loss, Positions};
use iiwa_plan::ProgramSource;
use iiwa_program::Program;
use iiwa_report::{IdentificationReport, with_causes};

use crate::{args::Identify, failure::Failure, input, output, output_kind::OutputKind};

/// Recording and its program.
struct RecordedProgram {
    name: String,
    program: Arc<Program>,
    log: JointLog,
}

/// Identifies a robot, prints the result and writes its profile.
pub(crate) fn run(options: &Identify) -> Result<(), Failure> {
    let target = (!options.no_output).then_some(options.output.as_path());
    if let Some(target) = target {
        let recordings = options.recordings.iter().map(|path| ("recording", path.as_path()));
        let program = options.program.as_deref().map(|path| ("program", path));
        let robot = options.robot.as_deref().map(|path| ("robot", Path::new(path)));
        let read = recordings.chain(program).chain(robot);
        output::keep_others(OutputKind::Profile, target, read, "--output")?;
        output::keep_existing(OutputKind::Profile, target, options.overwrite)?;
    }
    let (mut sources, model) = read(options)?;
    if let Some(percent) = options.speed_override {
        for source in &mut sources {
            Arc::make_mut(&mut source.program).workcell.speed_override = Some(0.01 * percent);
        }
    }
    let recordings: Vec<_> = sources
        .iter()
        .map(|RecordedProgram { program, log, .. }| RecordedRun { program, log })
        .collect();
    let identified = identify(&recordings, &model)
        .map_err(|error| Failure::input(format!("{}: {error}", sources[error.recording()].name)))?;
    let name = options.name.as_deref().unwrap_or(model.name());
    let logs: Vec<_> =
        sources.iter().map(|RecordedProgram { name, log, .. }| (name.as_str(), log)).collect();
    let report = IdentificationReport::new(&logs, name, &identified, target);
    if report.is_empty() {
        let losses = report.first_losses().fold(String::new(), |text, loss| text + "; " + loss);
        return Err(Failure::input(format!(
            "the recordings show no limit, no time to settle and no blend: `iiwasim experiment` \
             has programs that do{losses}"
        )));
    }
    if let Some(target) = target {
        let robot = identified.robot(&model).with_name(name);
        let profile = format!("{}\n", robot.to_profile());
        // A given name may be invalid in profiles.
        Robot::from_profile(&profile)
            .map_err(|error| Failure::input(format!("--name: {}", error.message())))?;
        output::write(target, profile.as_bytes())?;
    }
    if options.json { output::print_json(&report) } else { output::print(&report.text(&model)) }
}

/// Reads the recordings with their programs, and the robot assumed for them.
fn read(options: &Identify) -> Result<(Vec<RecordedProgram>, Robot), Failure> {
    let given = options.program.as_deref();
    let robot = options.robot.as_deref();
    let given = given.map(|path| input::program(path, robot)).transpose()?;
    let mut model = match &given {
        Some(given) => Some(given.robot()?),
        None => robot.map(input::find_robot).transpose()?,
    };
    let mut sources = Vec::with_capacity(options.recordings.len());
    for path in &options.recordings {
        let name = path.display().to_string();
        let log = input::recording(path, options.log, Positions::Commanded)?;
        let program_name = format!("{name}, its program.json");
        let source = match (&given, &log.program) {
            (Some(given), _) => given.source.clone(),
            (None, Some(text)) => ProgramSource::from_json(text)
                .map_err(|error| Failure::program(&error, &program_name, text))?,
            (None, None) => {
                return Err(Failure::input(format!(
                    "{name} does not hold the program that was run; name it with --program{}",
                    broken_off(&log).map_or_else(String::new, |loss| format!(" ({loss})"))
                )));
            }
        };
        if model.is_none() {
            let recorded = log.recorded_robot().map_err(|error| {
                let why = with_causes(&error);
                Failure::input(format!("{name}: {why}; name its profile with --robot"))
            })?;
            model = Some(match recorded {
                Some(robot) => robot,
                None => input::request(&source, None)?.robot(&source).map_err(|error| {
                    Failure::program(&error, &program_name, source.text.as_read())
                })?,
            });
        }
        if let Some(model) = &model {
            let to_failure = |error: &dyn std::error::Error| {
                Failure::input(format!("{name}: {}", with_causes(error)))
            };
            log.check_robot(model).map_err(|error| to_failure(&error))?;
            log.check_motion().map_err(|error| to_failure(&error))?;
        }
        sources.push(RecordedProgram { name, program: source.program, log });
    }
    Ok((sources, model.map_or_else(input::default_robot, Ok)?))
}

/// Returns the loss of the rest of a file.
fn broken_off(log: &JointLog) -> Option<&Loss> {
    log.losses.iter().find(|loss| matches!(loss, Loss::BrokenOff { .. }))
}
