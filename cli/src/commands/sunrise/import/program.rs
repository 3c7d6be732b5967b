//! An application as a program.

use std::path::{Path, PathBuf};

use iiwa_application::{Application as Found, ImportError};
use iiwa_kin::Robot;

use crate::{
    args::Import as ImportArgs,
    failure::Failure,
    input::Text,
    output,
    sunrise::{Application, failure},
};

use super::{listing, report::ProgramReport};

/// Writes the program of an application, and says what became of it.
pub(super) fn run(options: &ImportArgs) -> Result<(), Failure> {
    let folder = options.project.as_path();
    let name = options.answering.application.as_deref();
    let application = Application::read(folder, &options.answering, options.robot.as_deref())?;
    if name.is_none() {
        let all = Found::all(&application.project);
        if all.len() > 1 {
            return listing::run(folder, &application, all, options.json);
        }
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
        output::keep_existing("program", target, options.overwrite)?;
        if let Some(robot) = &import.program.robot {
            import.program.robot = Some(beside(target, robot, options.overwrite)?);
        }
        output::write(target, format!("{}\n", import.program.to_json()).as_bytes())?;
    }
    let report = ProgramReport::new(folder, &import, target.as_deref());
    if options.json { output::print_json(&report) } else { output::print(&report.text()) }
}

/// The name by which a program in the file `target` finds its robot: a profile is copied to the folder of the program.
fn beside(target: &Path, robot: &str, overwrite: bool) -> Result<String, Failure> {
    if Robot::built_in(robot).is_some() {
        return Ok(robot.to_owned());
    }
    let profile = Path::new(robot);
    output::keep_inputs("program", target, [("robot profile", profile)], "--output")?;
    // Programs name profiles that are called so.
    let name = Path::new(profile.file_name().unwrap_or_default()).with_extension("json");
    let copy = target.with_file_name(&name);
    if !output::same_file(&copy, profile) {
        let text = Text::read(profile)?.text;
        if !Text::read(&copy).is_ok_and(|known| known.text == text) {
            output::keep_existing("robot profile", &copy, overwrite)?;
            output::write(&copy, text.as_bytes())?;
        }
    }
    Ok(name.display().to_string())
}

/// Where the program goes: named after the application.
fn target(options: &ImportArgs, name: &str) -> Option<PathBuf> {
    let own = || Path::new(name).with_extension("json");
    (!options.no_output).then(|| options.output.clone().unwrap_or_else(own))
}
