//! `iiwasim plan`: of one program here, of many in `many`.

mod many;
mod programs;
mod tables;
mod work;

use std::{
    fmt::Write as _,
    iter,
    path::{Path, PathBuf},
};

use iiwa_report::{assumption_lines, plan_table, warning_lines};

use crate::{
    application::application,
    args::{Plan, Timing},
    failure::{Failure, print_note},
    features,
    input::{self, is_stdin},
    output,
    output_kind::OutputKind,
    picture,
    progress::Progress,
    terminal, trace,
};

pub(super) use programs::programs_in;
use work::{FailedProgram, PlanOutcome, file_name, gates, scene, write};

/// Plans programs, writes their trajectories and prints their figures.
pub(crate) fn run(options: &Plan) -> Result<(), Failure> {
    if options.min_clearance.is_some() && options.scene.is_none() {
        return Err(Failure::input("--min-clearance needs a scene: --scene SCENE.json"));
    }
    match options.programs.as_slice() {
        [folder] if options.answering.is_given() => one(options, folder),
        _ if options.answering.is_given() => Err(Failure::input(
            "--application and answers are for one Sunrise project, which is named by its folder",
        )),
        [program] if is_stdin(program) || !program.is_dir() => one(options, program),
        given => many::run(options, given),
    }
}

/// Plans one program.
fn one(options: &Plan, program: &Path) -> Result<(), Failure> {
    if options.trace {
        if matches!(options.timing, Timing::Acceleration) {
            return Err(Failure::input(
                "--trace shows solver iterations; --timing acceleration has none",
            ));
        }
        trace::start();
    }
    let name = program.display().to_string();
    let input = if options.answering.is_given() {
        application(program, &options.answering, options.robot.as_deref())
    } else {
        input::program(program, options.robot.as_deref())
    };
    let input = input.map_err(|failure| failed(options, program, failure))?;
    let named = if options.answering.is_given() { Path::new(&input.name) } else { program };
    let target = output_path(options, named);
    distinct(options, program, target.as_deref())?;
    let scene = scene(options)?;
    output::catch_interrupts();
    let mut progress = Progress::of_program();
    let show = |share| progress.show_share(share);
    let planned = write(options, &name, scene.as_ref(), input, target.as_deref(), show);
    progress.clear();
    let outcome = planned.map_err(|failure| failed(options, program, failure))?;
    print_note(&warning_lines(&outcome.figures.warnings, None));
    report(options, &outcome)?;
    match gates(options).judge(&outcome.figures).complaint() {
        Some(how) => Err(Failure::Gate(format!("the program {how}"))),
        None => Ok(()),
    }
}

/// Prints the errors of a program that was not planned, if the output is JSON; returns its failure.
fn failed(options: &Plan, program: &Path, failure: Failure) -> Failure {
    // An interrupt is not a failure of the program.
    if !options.json || output::check_interrupt().is_err() {
        return failure;
    }
    let name = program.display().to_string();
    let failure = if is_stdin(program) { failure } else { failure.about(&name) };
    let printed = output::print_json(&FailedProgram { program: &name, errors: failure.errors() });
    // A closed output is less important than the failure of the program.
    drop(printed);
    failure
}

/// Returns the path of the MCAP file, if one is written.
fn output_path(options: &Plan, program: &Path) -> Option<PathBuf> {
    if options.no_output {
        return None;
    }
    Some(options.output.clone().unwrap_or_else(|| file_name(program)))
}

/// Rejects outputs that would overwrite an input or each other.
fn distinct(options: &Plan, program: &Path, target: Option<&Path>) -> Result<(), Failure> {
    let robot = options.robot.as_deref().map(|path| ("robot", Path::new(path)));
    let scene = options.scene.as_deref().map(|path| ("scene", path));
    let urdf = options.arm.urdf.as_deref().map(|path| ("URDF", path));
    let mut others: Vec<_> =
        iter::once(("program", program)).chain(robot).chain(scene).chain(urdf).collect();
    if options.parquet.is_some() {
        features::PARQUET.require("--parquet")?;
    }
    let picture = options.picture.as_deref();
    let picture_kind = picture.map(picture::format).transpose()?.map(OutputKind::Picture);
    let outputs = [
        (Some(OutputKind::Trajectory), target, "--output"),
        (Some(OutputKind::Csv), options.csv.as_deref(), "--csv"),
        (Some(OutputKind::Parquet), options.parquet.as_deref(), "--parquet"),
        (picture_kind, picture, "--picture"),
    ];
    for (kind, path, option) in outputs {
        if let (Some(kind), Some(path)) = (kind, path) {
            output::keep_others(kind, path, others.iter().copied(), option)?;
            others.push((kind.name(), path));
        }
    }
    Ok(())
}

/// Prints the outcome.
fn report(options: &Plan, outcome: &PlanOutcome) -> Result<(), Failure> {
    if options.json {
        return output::print_json(outcome);
    }
    let PlanOutcome { figures, output: file, .. } = outcome;
    let mut text = plan_table(figures, terminal::width());
    if options.assumptions {
        text.push_str(&assumption_lines(&figures.rests_on));
    }
    if let Some(file) = file {
        let _ = writeln!(text, "Trajectory in {file}");
    }
    for table in options.csv.iter().chain(&options.parquet) {
        let _ = writeln!(text, "Table in {}", table.display());
    }
    output::print(&text)
}
