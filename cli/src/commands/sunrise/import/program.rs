//! An application as a program.

use std::path::{Path, PathBuf};

use iiwa_application::{Application as Found, ImportError};

use crate::{
    args::Import as ImportArgs,
    failure::Failure,
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
    let import = match application.import(name) {
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
        output::write(target, format!("{}\n", import.program.to_json()).as_bytes())?;
    }
    let report = ProgramReport::new(folder, &import, target.as_deref());
    if options.json { output::print_json(&report) } else { output::print(&report.text()) }
}

/// Where the program goes: named after the application.
fn target(options: &ImportArgs, name: &str) -> Option<PathBuf> {
    let own = || Path::new(name).with_extension("json");
    (!options.no_output).then(|| options.output.clone().unwrap_or_else(own))
}
