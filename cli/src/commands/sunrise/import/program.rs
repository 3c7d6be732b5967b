//! Import of an application as a program.

use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
};

use iiwa_json::printable;
use iiwa_kin::Robot;
use iiwa_sunrise::{Application as Found, ImportError};
use iiwa_sunrise::{DataFile, ProjectData};

use crate::{
    args::Import as ImportArgs,
    failure::Failure,
    input::FileText,
    output,
    output_kind::OutputKind,
    sunrise::{ApplicationArgs, failure},
};

use super::{listing, report::ProgramReport};

/// Writes the program of an application, and reports the result.
pub(super) fn run(options: &ImportArgs) -> Result<(), Failure> {
    let folder = options.project.as_path();
    let name = options.answering.application.as_deref();
    let application = ApplicationArgs::read(folder, &options.answering, options.robot.as_deref())?;
    if name.is_none() {
        let all = Found::all(&application.project);
        if all.len() > 1 {
            return listing::run(folder, &application, all, options.json);
        }
    }
    if let Some(target) = &options.write_data {
        return write_data(options, &application, target);
    }
    let mut import = match application.import(name) {
        Ok(import) => import,
        Err(ImportError::Refused(refused)) => {
            let report = ProgramReport::refused(folder, &refused);
            if options.json {
                output::print_json(&report)?;
            } else if options.no_output {
                output::print(&report.text())?;
            }
            return Err(failure(folder, &ImportError::Refused(refused)));
        }
        Err(error) => return Err(failure(folder, &error)),
    };
    let target = target(options, &import.application.name);
    if let Some(target) = &target {
        output::keep_existing(OutputKind::Program, target, options.overwrite)?;
        if let Some(robot) = &import.program.robot {
            import.program.robot = Some(beside(target, robot, options.overwrite)?);
        }
        output::write(target, format!("{}\n", import.program.to_json()).as_bytes())?;
    }
    let report = ProgramReport::new(folder, &import, target.as_deref());
    if options.json { output::print_json(&report) } else { output::print(&report.text()) }
}

/// Writes a data file with the entries that the application needs and the project lacks; their
/// values are zeros.
fn write_data(
    options: &ImportArgs,
    application: &ApplicationArgs,
    target: &Path,
) -> Result<(), Failure> {
    let folder = options.project.as_path();
    let name = options.answering.application.as_deref();
    let missing = match application.import(name) {
        Err(ImportError::Refused(refused)) if !refused.missing.is_empty() => refused.missing,
        Err(error) => return Err(failure(folder, &error)),
        Ok(_) => {
            return Err(Failure::input(format!(
                "{}: the application needs no entry of a data file that the project lacks",
                folder.display()
            )));
        }
    };
    if !matches!(application.project.data(), ProjectData::Absent) {
        let all: Vec<_> = missing.iter().map(ToString::to_string).collect();
        return Err(Failure::input(format!(
            "{}: the project has a data file, which lacks {}: add these entries to that file",
            folder.display(),
            all.join(", ")
        )));
    }
    output::keep_existing(OutputKind::DataFile, target, options.overwrite)?;
    let mut file = DataFile::default();
    for entry in &missing {
        entry.add_to(&mut file);
    }
    output::write(target, file.to_xml().as_bytes())?;
    let mut text = format!("{} lists, with zeros for its numbers:\n", target.display());
    for entry in &missing {
        let _ = writeln!(text, "- {}", printable(&entry.to_string()));
    }
    text += "Fill it in (x, y, z in mm, a, b, c in rad), and put it into the project as \
        RoboticsAPI.data.xml.\n";
    output::print(&text)
}

/// Returns the name by which a program in the file `target` refers to its robot: a profile is
/// copied to the folder of the program.
fn beside(target: &Path, robot: &str, overwrite: bool) -> Result<String, Failure> {
    if Robot::built_in(robot).is_some() {
        return Ok(robot.to_owned());
    }
    let profile = Path::new(robot);
    output::keep_others(OutputKind::Program, target, [("robot profile", profile)], "--output")?;
    // Programs refer to profiles by names with this extension.
    let name = Path::new(profile.file_name().unwrap_or_default()).with_extension("json");
    let copy = target.with_file_name(&name);
    if !output::same_file(&copy, profile) {
        let text = FileText::read(profile)?.text;
        if !FileText::read(&copy).is_ok_and(|known| known.text == text) {
            output::keep_existing(OutputKind::Profile, &copy, overwrite)?;
            output::write(&copy, text.as_bytes())?;
        }
    }
    Ok(name.display().to_string())
}

/// Returns the path of the program: by default, named after the application.
fn target(options: &ImportArgs, name: &str) -> Option<PathBuf> {
    let default_path = || Path::new(name).with_extension("json");
    (!options.no_output).then(|| options.output.clone().unwrap_or_else(default_path))
}
