//! `iiwasim run`.

use std::{
    iter,
    path::{Path as FilePath, PathBuf},
    sync::Arc,
};

use iiwa_files::Output;
use iiwa_json::printable;
use iiwa_link::{
    ClientError,
    message::{Request, Run as Measured},
};
use iiwa_log::Config;
use iiwa_plan::{PlanFigures, PlanGates, PlanOptions};
use iiwa_program::{IoEntry, Program};
use iiwa_report::{RunReport, add_clearances, carried, plan_table, warning_lines};
use iiwa_scene::ArmInScene;
use iiwa_traj::Timing;
use iiwa_twin::{
    run_parts::{RunPart, check_signals, parts},
    runs::{began, label, longest_log, now, since_start},
};

use crate::{
    args::Run,
    connection,
    failure::{Failure, print_note},
    input, output,
    output_kind::OutputKind,
    progress::Progress,
    runner::{
        connect, execute_parts_with_progress, execute_with_progress, go_to_start, hint, recording,
        sampled,
    },
    terminal,
};

/// Runs a program on the robot.
pub(crate) fn run(options: &Run) -> Result<(), Failure> {
    let mut input = input::program(&options.program, options.robot.as_deref())?;
    // Set-points sent by the drive must keep strict jerk limits.
    let timing = if options.as_trajectory { Timing::jerk_limited() } else { Timing::default() };
    input.request.options = PlanOptions::with_timing(timing);
    let parts = parts_with_io(options, &input.source.program)?;
    let target = target(options)?;
    let scene = options.scene.as_deref().map(input::scene).transpose()?;
    output::catch_interrupts();
    let plan = input.plan()?;
    let (robot, trajectory) = (plan.robot(), &plan.trajectory);
    let mut figures = plan.figures();
    if let Some(scene) = &scene {
        let shapes = carried(&input.source).map_err(|error| input.to_failure(&error))?;
        let arm = ArmInScene::new(robot, scene).carrying(&shapes);
        trajectory
            .sections()
            .iter()
            .for_each(|section| add_clearances(&mut figures, &arm, section));
    }
    print_note(&warning_lines(&plan.warnings(&figures), None));

    // Anything that would lose the recording is reported before the arm moves.
    let output = target.as_deref().map(Output::new).transpose()?;
    let file = |epoch| Config { epoch, names: options.ros.names(), ..Config::default() };
    if output.is_some() {
        let file = file(options.epoch.unwrap_or_else(now));
        recording(
            &longest_log(trajectory.cycle_time_s()),
            file,
            robot,
            input.source.text.complete(),
        )?;
    }
    let mut line = connect(&options.drive, &options.stream)?;
    if !options.json {
        output::print(&plan_table(&figures, terminal::width()))?;
    }
    check_clearance(options, &figures)?;
    let sources = input.source.program.sources.clone();
    let request = if options.as_trajectory {
        Request::trajectory(sampled(trajectory)?)
    } else {
        Request::motions(Arc::unwrap_or_clone(input.source.program))
    };
    let label = label(&stem(options), &figures, robot);
    let request = request.labelled(label.clone());
    if let Some(parts) = &parts {
        check_signals(&mut line, parts, &sources)
            .map_err(|error| connection::failed("the robot cannot run the program", &error))?;
    }
    go_to_start(&mut line, options.move_to_start, trajectory.path().start_rad(), robot)?;
    output::check_interrupt()?;

    let planned_s = trajectory.cycle_time_s();
    let watched = match &parts {
        Some(parts) => execute_parts_with_progress(&mut line, parts, &sources, &label, planned_s),
        None => execute_with_progress(&mut line, &request, planned_s, Progress::of_run()),
    };
    let (measured, failure) = match watched.result {
        Ok(measured) => (measured, None),
        Err(ClientError::Refused { mut refusal, run }) => {
            let run = run.map(|run| *run).unwrap_or_default();
            let verb = if run.samples.t_s.is_empty() { "run" } else { "finish" };
            if !options.as_trajectory && parts.is_none() {
                refusal.message.push_str(hint(&refusal));
            }
            let failed = ClientError::Refused { refusal, run: None };
            let message = format!("the robot did not {verb} the program");
            (run, Some(connection::failed(&message, &failed)))
        }
        // The samples of the stream are the only ones.
        Err(error) => {
            // A motion continues without the drive.
            let failure =
                connection::failed("the run broke off, the robot may still be moving", &error);
            (Measured::new(watched.streamed), Some(failure))
        }
    };
    if let Some(why) = &measured.untimed_because {
        print_note(&format!("No cycle time by the controller: {}\n", printable(why)));
    }
    if measured.samples_left_out > 0 {
        print_note(&format!(
            "The recording has a gap: {} samples were too many to be stored\n",
            measured.samples_left_out
        ));
    }
    let log = since_start(&measured, &watched.torques);
    let written = target.as_deref().filter(|_| !log.t_s.is_empty());
    if let (Some(output), Some(_)) = (output, written) {
        let file = file(options.epoch.unwrap_or_else(|| began(&log)));
        output.write(&recording(&log, file, robot, input.source.text.complete())?)?;
        output.complete_always()?;
    }
    let plan = iiwa_eval::PlannedTrajectory::from_trajectory(trajectory);
    let figures = RunReport::new(&plan, &log, failure.is_none(), written);
    if options.json {
        output::print_json(&figures)?;
    } else {
        output::print(&figures.text())?;
    }
    failure.map_or(Ok(()), Err)
}

/// Returns the parts of a program with inputs and outputs; `None` for other programs.
fn parts_with_io(options: &Run, program: &Program) -> Result<Option<Vec<RunPart>>, Failure> {
    let Some((motion, _)) = program.entries().find(|(_, entry)| entry.io().is_some()) else {
        return Ok(None);
    };
    let failed = |message: &str| Err(Failure::input(program.sources.in_message(message)));
    if options.as_trajectory {
        return failed(&format!(
            "motion {motion} is an input or output, which a trajectory lacks; run the program \
             without --as-trajectory"
        ));
    }
    match parts(program) {
        Ok(parts) => Ok(Some(parts)),
        Err((motion, IoEntry { io, .. })) => failed(&format!(
            "motion {motion} uses `{}` while the robot moves (`overlap`), which a drive cannot do; \
             remove the overlap, or run the program in Sunrise (`iiwasim export`)",
            printable(&io)
        )),
    }
}

/// Returns the file of the recording, if one is written. A default name never overwrites a file.
fn target(options: &Run) -> Result<Option<PathBuf>, Failure> {
    if options.no_output {
        return Ok(None);
    }
    if let Some(path) = &options.output {
        output::keep_existing(OutputKind::Recording, path, options.overwrite)?;
        return Ok(Some(path.clone()));
    }
    let stem = stem(options);
    let later = (2..).map(|run: u32| format!("{stem}.measured-{run}.mcap"));
    let names = iter::once(format!("{stem}.measured.mcap")).chain(later);
    Ok(names.map(PathBuf::from).find(|path| !path.exists()))
}

/// Returns the name of the program, without folder and extension.
fn stem(options: &Run) -> String {
    match options.program.file_stem() {
        Some(stem) if options.program != FilePath::new("-") => stem.to_string_lossy().into_owned(),
        _ => "program".to_owned(),
    }
}

/// Rejects a program with a clearance below the limit of the options.
fn check_clearance(options: &Run, figures: &PlanFigures) -> Result<(), Failure> {
    let gates = PlanGates { min_clearance_mm: Some(options.min_clearance), ..PlanGates::default() };
    match gates.judge(figures).complaint() {
        Some(how) => Err(Failure::Gate(format!("the program {how}; it was not run"))),
        None => Ok(()),
    }
}
