//! Planning of one program.

use std::{
    fmt::Write as _,
    iter,
    path::{Path, PathBuf},
};

use iiwa_plan::PlanFigures;
use iiwa_report::{assumption_lines, plan_table, warning_lines};

use crate::{
    args::{Plan, Timing},
    failure::{Failure, print_note},
    features,
    input::{self, Input},
    output,
    output_kind::OutputKind,
    picture,
    progress::Progress,
    trace,
};

use super::{
    answer::PlanAnswer,
    target::file_name,
    work::{PlanOutcome, gates, scene, write},
};

/// Plans one program.
pub(super) fn run(options: &Plan, program: &Path) -> Result<(), Failure> {
    if options.trace {
        if matches!(options.timing, Timing::Acceleration) {
            return Err(Failure::input(
                "--trace shows iterations, which --timing acceleration has none of",
            ));
        }
        trace::start();
    }
    let input = if options.answering.is_given() {
        application(options, program)?
    } else {
        input::program(program, options.robot.as_deref())?
    };
    let named = if options.answering.is_given() { Path::new(&input.name) } else { program };
    let target = output_path(options, named);
    distinct(options, program, target.as_deref())?;
    let scene = scene(options)?;
    output::catch_interrupts();
    let mut progress = Progress::of_program();
    let show = |share| progress.show_share(share);
    let planned = write(options, scene.as_ref(), input, target.as_deref(), show);
    progress.clear();
    let PlanOutcome { figures, warnings } = planned?;
    print_note(&warning_lines(&warnings, None));
    report(options, &figures, &warnings, target.as_deref())?;
    match gates(options).judge(&figures).complaint() {
        Some(how) => Err(Failure::Gate(format!("the program {how}"))),
        None => Ok(()),
    }
}

/// Imports the program of a Sunrise application.
#[cfg(feature = "sunrise")]
fn application(options: &Plan, project: &Path) -> Result<Input, Failure> {
    crate::sunrise::program(project, &options.answering, options.robot.as_deref())
}

#[cfg(not(feature = "sunrise"))]
fn application(_: &Plan, _: &Path) -> Result<Input, Failure> {
    Err(features::SUNRISE.missing("the application of a Sunrise project"))
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

fn report(
    options: &Plan,
    figures: &PlanFigures,
    warnings: &[String],
    file: Option<&Path>,
) -> Result<(), Failure> {
    if !options.json {
        let mut text = plan_table(figures);
        if options.assumptions {
            text.push_str(&assumption_lines(&figures.rests_on));
        }
        if let Some(file) = file {
            let _ = writeln!(text, "Trajectory in {}", file.display());
        }
        for table in options.csv.iter().chain(&options.parquet) {
            let _ = writeln!(text, "Table in {}", table.display());
        }
        return output::print(&text);
    }
    let output = file.map(|file| file.display().to_string());
    output::print_json(&PlanAnswer { program: None, figures, output, warnings })
}
