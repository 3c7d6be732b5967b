//! `iiwasim run`.

use std::path::{Path as FilePath, PathBuf};

use iiwa_kin::Robot;
use iiwa_link::{ClientError, message::Run as Measured};
use iiwa_log::{PlanFigures, PlanOptions};
use iiwa_program::Program;
use iiwa_traj::Trajectory;
use iiwa_view::{RunReport, plan_table};

use crate::{
    args::Run,
    connection,
    failure::{Failure, print_note},
    input::{self, ProgramText},
    output::{self, Output},
    runner::{
        DriveConnection, Task, execute_with_progress, go_to_start, hint, recording, sampled,
        since_start,
    },
    warning::{warning_lines, warnings},
};

/// Runs a program on the robot.
pub(crate) fn run(options: &Run) -> Result<(), Failure> {
    let (text, program, robot) = input::program(&options.program, options.robot.as_deref())?;
    let target = target(options);
    output::catch_interrupts();
    let (plan, figures) = plan(&text, &program, &robot)?;
    print_note(&warning_lines(&warnings(&program, plan.path()), None));

    let mut line = DriveConnection::new(&options.drive, &options.stream)?;
    if !options.json {
        output::print(&plan_table(&figures))?;
    }
    let output = target.as_deref().map(Output::new).transpose()?;
    let task = if options.as_trajectory {
        Task::Trajectory(sampled(&plan)?)
    } else {
        Task::Motions(program.into())
    };
    go_to_start(&mut line, options.move_to_start, plan.path().start_rad())?;
    output::check_interrupt()?;

    let watched = execute_with_progress(&mut line, task, Some(plan.cycle_time_s()));
    let (measured, failure) = match watched.result {
        Ok(measured) => (measured, None),
        Err(ClientError::Refused { mut refusal, run }) => {
            let run = run.map(|run| *run).unwrap_or_default();
            let what = match run.samples.t_s.as_slice() {
                [] => "the robot did not run the program",
                _ => "the robot did not finish the program",
            };
            if !options.as_trajectory {
                refusal.message.push_str(hint(&refusal));
            }
            let failed = ClientError::Refused { refusal, run: None };
            (run, Some(connection::failed(what, &failed)))
        }
        // The samples of the stream are all there is.
        Err(error) => {
            // A motion continues without the drive.
            let failure =
                connection::failed("the run broke off, the robot may still be moving", &error);
            (Measured::new(watched.streamed), Some(failure))
        }
    };
    let samples = since_start(&measured);
    let written = output.filter(|_| !samples.is_empty());
    let file = match written {
        Some(output) => {
            let recording = recording(&samples, measured.cycle_time_s, &robot, text.complete())?;
            output.write(&recording)?;
            output.complete_always()?;
            target.as_deref()
        }
        None => None,
    };
    let figures = RunReport::new(
        plan.cycle_time_s(),
        measured.cycle_time_s,
        failure.is_none(),
        samples.len(),
        file,
    );
    if options.json {
        output::print_json(&figures)?;
    } else {
        output::print(&figures.text())?;
    }
    failure.map_or(Ok(()), Err)
}

fn target(options: &Run) -> Option<PathBuf> {
    if options.no_output {
        return None;
    }
    let stem = match options.program.file_stem() {
        Some(stem) if options.program != FilePath::new("-") => stem.to_string_lossy().into_owned(),
        _ => "program".to_owned(),
    };
    Some(options.output.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}.measured.mcap"))))
}

fn plan(
    text: &ProgramText,
    program: &Program,
    robot: &Robot,
) -> Result<(Trajectory, PlanFigures), Failure> {
    let how = PlanOptions::default();
    let plan =
        how.plan(program, robot).map_err(|error| Failure::plan(error, &text.name, &text.text))?;
    let mut figures = PlanFigures::new(how.timing, robot, how.samples);
    plan.sections().iter().for_each(|section| figures.add(section));
    Ok((plan, figures))
}
