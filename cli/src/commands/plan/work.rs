//! Planning of one program, with its file and its picture.

use std::path::{Path, PathBuf};

use bytesize::ByteSize;
use iiwa_files::interrupt;
use iiwa_log::{PlanConfig, PlanSize, PlanWriter};
use iiwa_path::PathOptions;
use iiwa_plan::{GateRecords, PlanFigures, PlanGates, PlanOptions, Planning, ProgramSource};
use iiwa_report::{PlanPicture, ProgramErrors, add_clearances, carried, long_duration};
use iiwa_scene::{ArmInScene, CarriedBodies, Scene};
use iiwa_traj::SweepOptions;
use serde::Serialize;

use crate::{
    args::Plan,
    arm_files::ArmFiles,
    failure::Failure,
    input::{self, Input},
    output,
    output_kind::OutputKind,
    picture,
};

use super::tables::Tables;

/// Reads the scene of the options, if any.
pub(super) fn scene(options: &Plan) -> Result<Option<Scene>, Failure> {
    if options.arm.urdf.is_some() && options.scene.is_none() {
        return Err(Failure::input("--urdf affects clearances only: it needs --scene"));
    }
    options.scene.as_deref().map(input::scene).transpose()
}

/// Result of a planned program, as `--json` prints it.
#[derive(Serialize)]
pub(super) struct PlanOutcome {
    /// Program, as it was given.
    pub(super) program: String,
    #[serde(flatten)]
    pub(super) figures: PlanFigures,
    /// Path of the trajectory's file, if one is written.
    pub(super) output: Option<String>,
    /// Gates that the options set, with the values of the plan.
    pub(super) gates: GateRecords,
}

/// A program that was not planned, as `--json` prints it.
#[derive(Serialize)]
pub(super) struct FailedProgram<'a> {
    pub(super) program: &'a str,
    #[serde(flatten)]
    pub(super) errors: ProgramErrors,
}

/// Plans a program, with the name `program` in JSON, and writes its trajectory to `target`, which
/// appears when it is complete. `progress` is called with the completed share.
pub(super) fn write(
    options: &Plan,
    program: &str,
    scene: Option<&Scene>,
    mut input: Input,
    target: Option<&Path>,
    mut progress: impl FnMut(f64),
) -> Result<PlanOutcome, Failure> {
    let request = &mut input.request;
    request.options = plan_options(options);
    request.torque_limit_rel = options.limit_torque.map(|percent| percent / 100.0);
    request.speed_override = options.speed_override.map(|percent| percent / 100.0);
    let planning = request.begin(&input.source).map_err(|error| input.to_failure(&error))?;
    let mut planning = planning.interrupted_by(interrupt::flag());
    // The iterations of a section are traced together; threads of many programs have their own.
    let threads = if options.trace { Some(1) } else { options.jobs };
    if let Some(threads) = threads.filter(|_| rayon::current_thread_index().is_none()) {
        planning = planning.with_threads(threads.into());
    }
    let robot = planning.robot().clone();
    let picture = options.picture.as_ref();
    let mut picture = picture.map(|_| PlanPicture::new(&robot).with_frames(&input.source.program));
    let shapes = match scene {
        Some(_) => carried(&input.source).map_err(|error| input.to_failure(&error))?,
        None => CarriedBodies::default(),
    };
    // Frees the memory of the program.
    let Input { name, source: ProgramSource { text, .. }, .. } = input;
    let to_failure = |error| Failure::program(&error, &name, text.as_read());
    let mut size = PlanSize::new(options.rate);
    let files = ArmFiles::new(&options.arm)?;
    let meshes = files.map(|files| files.meshes(&robot)).transpose()?;
    let arm = scene.map(|scene| match &meshes {
        Some(meshes) => ArmInScene::with_meshes(&robot, scene, meshes),
        None => ArmInScene::new(&robot, scene),
    });
    let arm = arm.map(|arm| arm.carrying(&shapes));

    let output = target.map(|path| output::replacing(path, OutputKind::Trajectory)).transpose()?;
    let drawing = options.picture.as_deref().map(picture::output).transpose()?;
    let mut writer = match &output {
        None => None,
        Some(output) => {
            let mut config = PlanConfig { rate_hz: options.rate, ..PlanConfig::default() };
            config.file.names = options.ros.names();
            if let Some(epoch) = options.epoch {
                config.file.epoch = epoch;
            }
            let writer = PlanWriter::new(output.stream()?, &robot, config);
            Some(writer.map_err(|error| output.failure(error))?)
        }
    };

    let mut tables = Tables::new(options)?;
    while let Some(section) = planning.next() {
        output::check_interrupt()?;
        let section = section.map_err(to_failure)?;
        size.add(&section);
        if let Some(arm) = &arm {
            add_clearances(planning.figures_mut(), arm, &section);
        }
        let is_written = writer.is_some() || !tables.is_empty();
        if is_written && size.bytes() > options.max_file_size.as_u64() {
            return Err(too_large(options, planning, size));
        }
        if let (Some(writer), Some(output)) = (&mut writer, &output) {
            writer.section(&section).map_err(|error| output.failure(error))?;
        }
        tables.add(&section)?;
        if let Some(picture) = &mut picture {
            picture.add(&section);
        }
        progress(planning.progress());
    }

    if let (Some(writer), Some(output)) = (writer, &output) {
        writer
            .finish(planning.figures(), Some(text.complete()))
            .map_err(|error| output.failure(error))?
            .into_inner()
            .map_err(|error| output.failure(error.into_error()))?;
    }
    if let (Some(picture), Some(drawing), Some(path)) = (picture, &drawing, &options.picture) {
        drawing.write(&picture::content(path, picture.draw()?)?)?;
    }
    for whole in output.into_iter().chain(drawing).chain(tables.finish()?) {
        whole.complete()?;
    }
    let figures = planning.finish();
    let gates = gates(options).records(&figures);
    let output = target.map(|file| file.display().to_string());
    Ok(PlanOutcome { program: program.to_owned(), figures, output, gates })
}

/// Returns the name of a program's MCAP file.
pub(super) fn file_name(program: &Path) -> PathBuf {
    let stem = match program.file_stem() {
        Some(stem) if !input::is_stdin(program) => stem.to_owned(),
        _ => "program".into(),
    };
    let mut name = stem;
    name.push(".mcap");
    PathBuf::from(name)
}

/// Returns the gates that the options set.
pub(super) fn gates(options: &Plan) -> PlanGates {
    PlanGates {
        max_cycle_time_s: options.max_cycle_time,
        min_clearance_mm: options.min_clearance,
        max_torque_percent: options.max_torque_percent,
    }
}

fn plan_options(options: &Plan) -> PlanOptions {
    PlanOptions {
        path: PathOptions {
            blend_shape: options.blend_shape.into(),
            blend_search: options.blend_search.into(),
        },
        timing: options.timing.with(SweepOptions { samples: options.samples as usize }),
        samples: options.samples,
    }
}

/// Returns the failure for a program whose file would be too large, with the size of the whole
/// file: `size` is that of the sections before `planning`.
fn too_large(options: &Plan, planning: Planning, mut size: PlanSize) -> Failure {
    let planned = planning.take_while(|_| !interrupt::has_come());
    planned.flatten().for_each(|section| size.add(&section));
    Failure::input(format!(
        "the program takes {}: at {} Hz its file would have about {}, more than the {} of \
         --max-file-size; lower --rate, raise --max-file-size, or print the figures only with \
         --no-output",
        long_duration(size.duration_s()),
        options.rate,
        ByteSize::b(size.bytes()).display().si(),
        options.max_file_size.display().si()
    ))
}
