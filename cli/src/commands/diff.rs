//! `iiwasim diff`.

use std::{
    collections::BTreeMap,
    ffi::OsString,
    fs::File,
    io::{BufReader, Read},
    path::{Path, PathBuf},
};

use iiwa_eval::PlanVersion;
use iiwa_json::printable;
use iiwa_log::PlanRecord;
use iiwa_report::{DifferenceReport, DifferenceSummary, add_clearances, carried, with_causes};
use iiwa_scene::{ArmInScene, Scene};
use iiwa_traj::SweepOptions;

use crate::{
    application::program_or_application,
    args::Diff,
    commands::plan::programs_in,
    failure::{Failure, print_note},
    input, output, terminal,
};

/// Compares two versions, prints the differences and applies the gate.
pub(crate) fn run(options: &Diff) -> Result<(), Failure> {
    let Diff { old, new, .. } = options;
    if old == new {
        return Err(Failure::input(format!("{} is compared with itself", old.display())));
    }
    match [old, new].map(|path| is_folder_of_programs(options, path)) {
        [false, false] => run_one(options),
        [true, true] => run_folders(options),
        [old_is_folder, _] => {
            let [folder, other] = if old_is_folder { [old, new] } else { [new, old] };
            Err(Failure::input(format!(
                "{} is a folder of programs and {} is not: give two folders, or two files",
                folder.display(),
                other.display()
            )))
        }
    }
}

/// Returns true for a folder of programs: not that of a Sunrise project, which has its Java in
/// `src`, or no programs. Below a folder of programs, there may be projects.
fn is_folder_of_programs(options: &Diff, path: &Path) -> bool {
    let is_folder = path.is_dir() && !options.answering.is_given();
    #[cfg(feature = "sunrise")]
    if is_folder && iiwa_sunrise::Project::has_sources(path) {
        return !path.join("src").is_dir() && has_json(path);
    }
    is_folder
}

/// Returns true for a folder with files `*.json`.
#[cfg(feature = "sunrise")]
fn has_json(folder: &Path) -> bool {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .into_iter()
        .any(|entry| Path::new(&entry.file_name()).extension() == Some("json".as_ref()))
}

/// Compares two versions of one program.
fn run_one(options: &Diff) -> Result<(), Failure> {
    let scene = options.scene.as_deref().map(input::scene).transpose()?;
    let [old, new] =
        [&options.old, &options.new].map(|path| version(options, scene.as_ref(), path));
    let report = DifferenceReport::new(&old?, &new?);
    if options.json {
        output::print_json(&report)?;
    } else if options.markdown {
        output::print(&report.markdown())?;
    } else {
        output::print(&report.text(terminal::width()))?;
    }
    let unmet = report.complaint(options.max_growth_percent);
    unmet.map_or(Ok(()), |unmet| Err(Failure::Gate(unmet)))
}

/// Compares the programs of two folders.
fn run_folders(options: &Diff) -> Result<(), Failure> {
    let mut all: BTreeMap<OsString, [Option<PathBuf>; 2]> = BTreeMap::new();
    for (side, folder) in [&options.old, &options.new].into_iter().enumerate() {
        for program in programs_in(folder)? {
            let name = program.file_name().unwrap_or_default().to_owned();
            all.entry(name).or_default()[side] = Some(program);
        }
    }
    let scene = options.scene.as_deref().map(input::scene).transpose()?;
    let mut summary = DifferenceSummary::default();
    for (name, [old, new]) in all {
        let name = name.to_string_lossy().into_owned();
        let plan = |path: Option<PathBuf>| {
            path.map(|path| version(options, scene.as_ref(), &path)).transpose()
        };
        // An old version that fails is not an error: the change may have mended the program.
        let old = plan(old).unwrap_or_else(|failure| {
            print_note(&format!("Note: {name} before the change: {}\n", failure.message()));
            None
        });
        match plan(new) {
            Ok(None) if old.is_none() => {}
            Ok(new) => summary.add(name, old.as_ref(), new.as_ref()),
            Err(failure) => {
                let failure = failure.about(&name);
                print_note(&failure.text());
                summary.add_failed(name, failure.errors());
            }
        }
    }
    if options.json {
        summary.programs().try_for_each(|program| {
            output::json_line(program).and_then(|line| output::print(&line))
        })?;
    } else if options.markdown {
        output::print(&summary.markdown())?;
    } else {
        output::print(&summary.text(terminal::width()))?;
    }
    let unmet = summary.complaint(options.max_growth_percent);
    unmet.map_or(Ok(()), |unmet| Err(Failure::Gate(unmet)))
}

/// Plans a version with its clearances, or reads its plan.
fn version(options: &Diff, scene: Option<&Scene>, path: &Path) -> Result<PlanVersion, Failure> {
    if let Some(plan) = recorded_plan(path)? {
        if scene.is_some() {
            let name = printable(&path.display().to_string());
            let clearances = match plan.figures().clearance {
                Some(_) => "its clearances are those in the scene that it was planned with",
                None => "it was planned without a scene and has no clearances to obstacles",
            };
            print_note(&format!("Note: {name} is a plan: {clearances}\n"));
        }
        return Ok(plan);
    }
    let robot = options.robot.as_deref();
    let mut input = program_or_application(path, &options.answering, robot)?;
    input.request.options.timing = options.timing.with(SweepOptions::default());
    let plan = input.plan()?;
    let mut version = PlanVersion::from(&plan);
    if let Some(scene) = scene {
        let shapes = carried(&input.source).map_err(|error| input.to_failure(&error))?;
        let arm = ArmInScene::new(&input.robot()?, scene).carrying(&shapes);
        for section in plan.trajectory.sections() {
            add_clearances(version.figures_mut(), &arm, section);
        }
    }
    Ok(version)
}

/// Reads a plan, if the file is one. A pipe is left to the reader of programs, since its first
/// bytes could not be read twice.
fn recorded_plan(path: &Path) -> Result<Option<PlanVersion>, Failure> {
    const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";
    let Some(mut file) = path.is_file().then(|| File::open(path).ok()).flatten() else {
        return Ok(None);
    };
    let mut first = [0; 8];
    if file.read_exact(&mut first).is_err() || first != MAGIC {
        return Ok(None);
    }
    let to_failure = |error| {
        let name = printable(&path.display().to_string());
        Failure::input(format!("{name}: {}", with_causes(&error)))
    };
    let record = PlanRecord::read(BufReader::new(first.chain(file))).map_err(to_failure)?;
    PlanVersion::from_record(record).map(Some).map_err(to_failure)
}
