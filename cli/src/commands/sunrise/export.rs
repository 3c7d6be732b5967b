//! `iiwasim export`.

use std::{fs, path::Path};

use iiwa_files::write_folder;
use iiwa_json::{JsonStep, locate, printable};
use iiwa_kin::Robot;
use iiwa_program::motion_path;
use iiwa_sunrise::{ExportError, ExportOptions, ExportedProject};
use serde::Serialize;

use crate::{
    args::Export,
    failure::{Failure, print_note},
    input::{self, Input},
    output,
    output_kind::OutputKind,
};

/// Writes a program as a Sunrise project.
pub(crate) fn run(options: &Export) -> Result<(), Failure> {
    let folder = options.output.as_path();
    keep_existing(folder, options.overwrite)?;
    let input = input::program(&options.program, options.robot.as_deref())?;
    let robot = input.robot()?;
    let name = match options.program.file_stem() {
        Some(stem) if options.program != Path::new("-") => stem.to_string_lossy().into_owned(),
        _ => "motion program".to_owned(),
    };
    let how = ExportOptions { name, class: options.name.clone() };
    let project = write_project(&input, &robot, &how, folder)?;
    let (java, data_file) = (project.java_file(), ExportedProject::DATA_FILE);
    let sources = &input.source.program.sources;
    let notices = project.notices.iter().map(|notice| sources.in_message(&notice.to_string()));
    let notices: Vec<String> = notices.collect();
    let start_deg = project.start_deg.map(|deg| deg.to_string()).join(",");
    if options.json {
        let files = [Path::new(&java), Path::new(data_file)];
        let files = files.map(|path| folder.join(path).display().to_string());
        let start_deg = project.start_deg;
        return output::print_json(&Exported {
            class: &project.class,
            files,
            start_deg,
            notices: &notices,
        });
    }
    for notice in &notices {
        print_note(&format!("Note: {}\n", printable(notice)));
    }
    output::print(&format!(
        "{}: the application {}\n{}: its frames and tools\nThe arm must be at {start_deg} deg \
         before the application runs.\n",
        folder.join(&java).display(),
        project.class,
        folder.join(data_file).display()
    ))
}

/// Checks that a program can be exported.
#[cfg(feature = "optimise")]
pub(crate) fn check(input: &Input, robot: &Robot) -> Result<(), Failure> {
    let how = ExportOptions { name: "motion program".to_owned(), class: None };
    let project = ExportedProject::new(&input.source.program, robot, &how);
    project.map(drop).map_err(|error| export_failure(&error, input))
}

/// Writes a program as a Sunrise project, atomically.
pub(crate) fn write_project(
    input: &Input,
    robot: &Robot,
    how: &ExportOptions,
    folder: &Path,
) -> Result<ExportedProject, Failure> {
    let project = ExportedProject::new(&input.source.program, robot, how)
        .map_err(|error| export_failure(&error, input))?;
    let java = project.java_file();
    let files = [
        (Path::new(&java), project.java.as_bytes()),
        (Path::new(ExportedProject::DATA_FILE), project.data_file.as_bytes()),
    ];
    output::catch_interrupts();
    write_folder(folder, &files)?;
    Ok(project)
}

/// Written files.
#[derive(Serialize)]
struct Exported<'a> {
    class: &'a str,
    files: [String; 2],
    start_deg: [f64; 7],
    notices: &'a [String],
}

/// Rejects a folder that is not empty, since its files may have been edited by hand, unless
/// `overwrite` is set.
pub(crate) fn keep_existing(folder: &Path, overwrite: bool) -> Result<(), Failure> {
    let is_empty = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
    output::keep_existing(OutputKind::Project, folder, overwrite || is_empty)
}

/// Converts an export error to a failure, with the places of the faults.
fn export_failure(error: &ExportError, input: &Input) -> Failure {
    Failure::several(error.errors().iter().map(|error| one_failure(error, input)))
}

fn one_failure(error: &ExportError, input: &Input) -> Failure {
    let (name, text) = (&input.name, input.source.text.as_read());
    let place = match error {
        ExportError::Fault(fault) => fault.place_in(text),
        ExportError::NotInSunrise { motion: index, key, .. } => {
            let mut steps = motion_path(text, *index);
            steps.push(JsonStep::Key(key));
            locate(text, &steps)
        }
        ExportError::Name { motion: Some(index), .. } => locate(text, &motion_path(text, *index)),
        error => return Failure::input(format!("{name}: {error}{}", hint(error))),
    };
    let message = input.source.program.sources.in_message(&error.to_string());
    Failure::in_text(&message, &place, name, text)
}

/// Returns the option that resolves the error.
fn hint(error: &ExportError) -> &'static str {
    match error {
        ExportError::ClassName { .. } => "; give another one with --name",
        _ => "",
    }
}
