//! `iiwasim plan`.

mod many;
mod programs;

use std::{
    fmt::Write as _,
    path::{Path as FilePath, PathBuf},
};

use bytesize::ByteSize;
use iiwa_kin::Robot;
use iiwa_log::{ClearanceRecord, PlanConfig, PlanFigures, PlanSize, PlanWriter};
use iiwa_path::{JointPath, PathOptions, Program};
use iiwa_scene::{ArmInScene, PlannedClearance, Scene};
use iiwa_traj::{JerkOptions, Planner, Section, SweepOptions, Timing, TimingError};
use iiwa_view::{PlanPicture, long_duration, plan_table, printable};
use serde::Serialize;

use crate::{
    args::{self, Plan},
    failure::Failure,
    input::{self, Text},
    output::{self, Output},
    progress::Progress,
};

/// Plans programs, writes their trajectories and prints their figures.
pub(crate) fn run(options: &Plan) -> Result<(), Failure> {
    match options.programs.as_slice() {
        [program] if is_stdin(program) || !program.is_dir() => one(options, program),
        given => many::run(options, given),
    }
}

fn is_stdin(program: &FilePath) -> bool {
    program == FilePath::new("-")
}

/// Plans one program.
fn one(options: &Plan, program: &FilePath) -> Result<(), Failure> {
    let target = output_path(options, program);
    distinct(options, program, target.as_deref())?;
    let scene = scene(options)?;
    let input = input::program(program, options.robot.as_deref())?;
    output::catch_interrupts();
    let mut progress = Progress::of_program();
    let show = |share| progress.show_share(share);
    let figures = write(options, scene.as_ref(), input, target.as_deref(), show);
    progress.clear();
    let figures = figures?;
    report(options, &figures, target.as_deref())?;
    match Gates::new(options, &figures).complaint() {
        Some(how) => Err(Failure::Gate(format!("the program {how}"))),
        None => Ok(()),
    }
}

/// The scene that the arm is to be held against, if any.
fn scene(options: &Plan) -> Result<Option<Scene>, Failure> {
    options.scene.as_deref().map(input::scene).transpose()
}

/// Plans a program and writes its trajectory to `target`. What is written appears when all of it is
/// done; `progress` hears of the share that is.
fn write(
    options: &Plan,
    scene: Option<&Scene>,
    (text, program, robot): (Text, Program, Robot),
    target: Option<&FilePath>,
    mut progress: impl FnMut(f64),
) -> Result<PlanFigures, Failure> {
    let path_options = PathOptions {
        blend_shape: options.blend_shape.into(),
        blend_search: options.blend_search.into(),
    };
    let path = JointPath::with_options(&program, &robot, path_options).map_err(|fault| {
        let place = fault.place_in(&text.text);
        Failure::in_text(&fault.to_string(), &place, &text.name, &text.text)
    })?;
    drop(program);

    let timing = match options.timing {
        args::Timing::Acceleration => {
            Timing::Acceleration(SweepOptions { samples: options.samples as usize })
        }
        args::Timing::Jerk => Timing::Jerk(JerkOptions::default()),
    };
    let mut figures = PlanFigures::new(timing, &robot, options.samples);
    let arm = scene.map(|scene| ArmInScene::new(&robot, scene));

    let output = target.map(Output::new).transpose()?;
    let drawing = options.picture.as_deref().map(Output::new).transpose()?;
    let mut writer = match &output {
        None => None,
        Some(output) => {
            let mut config = PlanConfig { rate_hz: options.rate, ..PlanConfig::default() };
            if let Some(epoch) = options.epoch {
                config.file.epoch = epoch;
            }
            let writer = PlanWriter::new(output.stream()?, &robot, config);
            Some(writer.map_err(|error| output.failure(&error))?)
        }
    };
    let mut picture = drawing.as_ref().map(|_| PlanPicture::new(&robot));

    let mut size = PlanSize::new(options.rate);
    let mut planner = Planner::new(&path, timing);
    while let Some(section) = planner.next() {
        output::check_interrupt()?;
        let section = section.map_err(|error| match error {
            TimingError::CurvatureJumps { .. } => {
                Failure::input(format!("{error} (--blend-shape iiwa, or --timing acceleration)"))
            }
            _ => Failure::run("cannot plan the program", &error),
        })?;
        figures.add(&section);
        if let Some(nearest) = arm.as_ref().and_then(|arm| clearance(arm, &section)) {
            figures.add_clearance(nearest);
        }
        if let (Some(writer), Some(output)) = (&mut writer, &output) {
            size.add(&section);
            if size.bytes() > options.max_file_size.as_u64() {
                return Err(too_large(options, size, planner));
            }
            writer.section(&section).map_err(|error| output.failure(&error))?;
        }
        if let Some(picture) = &mut picture {
            picture.add(&section);
        }
        progress(planner.progress());
    }

    if let (Some(writer), Some(output)) = (writer, &output) {
        let program = ("program.json", "application/json", text.text.as_bytes());
        let stream = writer.finish(&figures.to_metadata(), &[program]);
        stream
            .map_err(|error| output.failure(&error))?
            .into_inner()
            .map_err(|error| output.failure(error.error()))?;
    }
    if let (Some(picture), Some(drawing)) = (picture, &drawing) {
        drawing.write(picture.draw()?.as_bytes())?;
    }
    for whole in output.into_iter().chain(drawing) {
        whole.complete()?;
    }
    Ok(figures)
}

/// How near the arm comes to its scene in a section.
fn clearance(arm: &ArmInScene, section: &Section) -> Option<ClearanceRecord> {
    let PlannedClearance { clearance, at_s, .. } = arm.clearance_of_section(section)?;
    Some(ClearanceRecord {
        distance_mm: 1e3 * clearance.distance_m,
        link: clearance.link,
        obstacle: arm.scene().obstacles()[clearance.obstacle].name.clone(),
        at_s,
    })
}

/// A program whose file would be too large, with all that it would need; `planner` has the rest of it.
fn too_large(options: &Plan, mut size: PlanSize, planner: Planner) -> Failure {
    let rest = planner.take_while(|_| !output::interrupted());
    rest.flatten().for_each(|section| size.add(&section));
    Failure::input(format!(
        "the program takes {}: at {} Hz its file would have about {}, more than the {} of --max-file-size; \
         lower --rate, raise --max-file-size, or have the figures alone with --no-output",
        long_duration(size.duration_s()),
        options.rate,
        ByteSize::b(size.bytes()).display().si(),
        options.max_file_size.display().si()
    ))
}

/// Which gates a program does not meet, and how.
struct Gates {
    too_long: Option<String>,
    too_near: Option<String>,
}

impl Gates {
    fn new(options: &Plan, figures: &PlanFigures) -> Self {
        let cycle_time_s = figures.cycle_time_s;
        let too_long = options
            .max_cycle_time
            .filter(|limit| cycle_time_s > *limit)
            .map(|limit| format!("takes {cycle_time_s:.3} s, more than {limit} s"));
        let too_near = options
            .min_clearance
            .zip(figures.clearance.as_ref())
            .and_then(|(limit_mm, nearest)| too_near(limit_mm, nearest));
        Self { too_long, too_near }
    }

    /// All that is not met, if anything.
    fn complaint(&self) -> Option<String> {
        match (&self.too_long, &self.too_near) {
            (Some(long), Some(near)) => Some(format!("{long}, and {near}")),
            (long, near) => long.as_ref().or(near.as_ref()).cloned(),
        }
    }
}

/// How the arm comes too near to an obstacle, if it does. What touches is too near for any gate.
fn too_near(limit_mm: f64, nearest: &ClearanceRecord) -> Option<String> {
    let ClearanceRecord { distance_mm, link, obstacle, at_s } = nearest;
    let obstacle = printable(obstacle);
    let place = format!("link {link} at {at_s:.3} s");
    if *distance_mm == 0.0 {
        Some(format!("touches {obstacle}: {place}"))
    } else if *distance_mm < limit_mm {
        Some(format!(
            "comes within {distance_mm:.1} mm of {obstacle}, less than {limit_mm} mm: {place}"
        ))
    } else {
        None
    }
}

/// Where the MCAP file goes, if anywhere.
fn output_path(options: &Plan, program: &FilePath) -> Option<PathBuf> {
    if options.no_output {
        return None;
    }
    Some(options.output.clone().unwrap_or_else(|| file_name(program)))
}

/// How the MCAP file of a program is called.
fn file_name(program: &FilePath) -> PathBuf {
    let stem = match program.file_stem() {
        Some(stem) if !is_stdin(program) => stem.to_owned(),
        _ => "program".into(),
    };
    let mut name = stem;
    name.push(".mcap");
    PathBuf::from(name)
}

/// Refuses to write over what is read, or one file twice.
fn distinct(options: &Plan, program: &FilePath, target: Option<&FilePath>) -> Result<(), Failure> {
    let robot = options.robot.as_deref().map(FilePath::new);
    let scene = options.scene.as_deref();
    let read = [("program", Some(program)), ("robot", robot), ("scene", scene)];
    let written = [("trajectory", target), ("picture", options.picture.as_deref())];
    for (what, path) in written {
        let others = read.iter().chain(written.iter().filter(|(other, _)| *other < what));
        for (other, its) in others {
            if let (Some(path), Some(its)) = (path, its)
                && output::same_file(path, its)
            {
                return Err(Failure::input(format!(
                    "the {what} would be written over the {other}, {}; name another file with {}",
                    path.display(),
                    if what == "picture" { "--picture" } else { "--output" }
                )));
            }
        }
    }
    Ok(())
}

/// The figures, and where the file is.
#[derive(Serialize)]
struct Report<'a> {
    /// Which of many programs it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    program: Option<&'a str>,
    #[serde(flatten)]
    figures: &'a PlanFigures,
    output: Option<String>,
}

fn report(options: &Plan, figures: &PlanFigures, file: Option<&FilePath>) -> Result<(), Failure> {
    if !options.json {
        let mut text = plan_table(figures);
        if let Some(file) = file {
            let _ = writeln!(text, "Trajectory in {}", file.display());
        }
        return output::print(&text);
    }
    let output = file.map(|file| file.display().to_string());
    output::print_json(&Report { program: None, figures, output })
}
