//! Import of frames and tools for inclusion in programs.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use iiwa_report::ImportReport;
use iiwa_sunrise::{DataFile, ImportedCell};

use crate::{
    args::Import,
    failure::{Failure, print_note},
    input::{FileText, default_robot, find_robot},
    output,
    output_kind::OutputKind,
    terminal,
};

/// File of a project with its frames and tools.
const DATA_FILE: &str = "RoboticsAPI.data.xml";

/// Default output file.
const FRAMES_FILE: &str = "frames.json";

/// Maximum depth of the searched folders.
const DEPTH: usize = 2;

/// Writes the frames and tools of a project as a file for inclusion, and reports the result.
pub(super) fn run(options: &Import) -> Result<(), Failure> {
    let project = if options.project.is_dir() {
        data_file(&options.project)?
    } else {
        options.project.clone()
    };
    let output = options.output.as_deref().unwrap_or(Path::new(FRAMES_FILE));
    let target = (!options.no_output).then_some(output);
    if let Some(target) = target {
        let robot = options.robot.as_deref().map(|path| ("robot", Path::new(path)));
        let read = [("project", project.as_path())].into_iter().chain(robot);
        output::keep_others(OutputKind::Frames, target, read, "--output")?;
        output::keep_existing(OutputKind::Frames, target, options.overwrite)?;
    }
    let robot = options.robot.as_deref().map_or_else(default_robot, find_robot)?;
    let FileText { name, text } = FileText::read(&project)?;
    let file = DataFile::from_xml(&text)
        .map_err(|error| Failure::in_text(&error.message(), error.place(), &name, &text))?;
    let cell = ImportedCell::new(&file);
    if cell.tools.is_empty() && cell.frames.is_empty() {
        return Err(Failure::input(format!("{name} has neither frames nor tools")));
    }
    if let Some(target) = target {
        output::write(target, format!("{}\n", cell.workcell.to_json()).as_bytes())?;
    }
    let report = ImportReport::new(Path::new(&name), &file, &cell, &robot, target);
    if let Some(model) = report.taught_on() {
        print_note(&format!(
            "Note: the frames were taught on another robot than {}; --robot {model} checks them on \
             that\n",
            robot.name()
        ));
    }
    if options.json {
        output::print_json(&report)
    } else {
        output::print(&report.text(terminal::width()))
    }
}

/// Finds the data file of the project in a folder, or below it: the nearest one; that of the
/// sources has priority over copies.
fn data_file(folder: &Path) -> Result<PathBuf, Failure> {
    let to_failure = |error: io::Error| {
        Failure::input(format!("cannot read the folder {}: {error}", folder.display()))
    };
    let mut folders = vec![folder.to_owned()];
    for _ in 0..=DEPTH {
        let mut entries: Vec<_> = folders
            .iter()
            .map(|folder| folder.join(DATA_FILE))
            .filter(|file| file.is_file())
            .collect();
        entries.sort();
        let sources: Vec<_> = entries
            .iter()
            .filter(|file| file.parent().is_some_and(|folder| folder.ends_with("src")))
            .collect();
        match (entries.as_slice(), sources.as_slice()) {
            ([], _) => {}
            ([only], _) => return Ok(only.clone()),
            (_, [source]) => return Ok(PathBuf::clone(source)),
            ([first, second, ..], _) => {
                return Err(Failure::input(format!(
                    "{} has several projects, as {} and {}; name one of them",
                    folder.display(),
                    first.display(),
                    second.display()
                )));
            }
        }
        let mut below = Vec::new();
        for folder in &folders {
            // Unreadable subfolders contain no project of this user.
            let entries = match fs::read_dir(folder) {
                Ok(entries) => entries,
                Err(error) if folders.len() == 1 => return Err(to_failure(error)),
                Err(_) => continue,
            };
            below.extend(entries.flatten().map(|entry| entry.path()).filter(|path| path.is_dir()));
        }
        folders = below;
    }
    Err(Failure::input(format!(
        "{} is not a Sunrise project: no {DATA_FILE} in it, nor {DEPTH} folders further down",
        folder.display()
    )))
}
