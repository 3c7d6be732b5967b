//! Resources of an FMU: the program, the robot, and the planning options.

use std::{collections::BTreeMap, fs, path::Path};

use iiwa_kin::Robot;

use super::description::description;
use iiwa_plan::ProgramSource;

use crate::{
    failure::{CallFailure, FailureKind},
    planned::{Choices, PlannedProgram, to_json},
};

/// Contents of the files in `resources/`.
struct Resources {
    program: String,
    robot: String,
    options: String,
}

const PROGRAM: &str = "program.json";
const ROBOT: &str = "robot.json";
const OPTIONS: &str = "options.json";

impl Resources {
    fn of(planned: &PlannedProgram) -> Result<Self, CallFailure> {
        Ok(Self {
            program: planned.program.clone(),
            robot: planned.robot().to_profile(),
            options: to_json(&planned.choices)?,
        })
    }

    fn read(folder: &Path) -> Result<Self, CallFailure> {
        let read = |name| {
            let path = folder.join(name);
            fs::read_to_string(&path).map_err(|error| {
                let message = format!("cannot read {}: {error}", path.display());
                CallFailure::new(FailureKind::File, message)
            })
        };
        Ok(Self { program: read(PROGRAM)?, robot: read(ROBOT)?, options: read(OPTIONS)? })
    }

    /// Token that ties the binary to the description: same version, and same resources.
    fn token(&self) -> String {
        let text = [&self.program, &self.robot, &self.options].map(String::as_str).join("\0");
        format!("iiwasim-{}-{:08x}", env!("CARGO_PKG_VERSION"), crc32fast::hash(text.as_bytes()))
    }
}

/// Returns the text files of an FMU that runs a plan, by their paths.
pub(crate) fn fmu_files(
    planned: &PlannedProgram,
    name: &str,
) -> Result<BTreeMap<String, String>, CallFailure> {
    if name.trim().is_empty() || name.chars().any(char::is_control) {
        return Err(CallFailure::argument(
            "the model's name is empty, or has control characters in it",
        ));
    }
    let resources = Resources::of(planned)?;
    let description = description(name, &resources.token(), planned.trajectory().cycle_time_s());
    let Resources { program, robot, options } = resources;
    let files = [(PROGRAM, program), (ROBOT, robot), (OPTIONS, options)];
    let files = files.map(|(name, text)| (format!("resources/{name}"), text));
    Ok([("modelDescription.xml".to_owned(), description)].into_iter().chain(files).collect())
}

/// Plans the program in the folder `resources` of an FMU, which must have this token.
pub(super) fn plan(folder: &Path, token: &str) -> Result<PlannedProgram, CallFailure> {
    let resources = Resources::read(folder)?;
    let expected = resources.token();
    if expected != token {
        let message = format!(
            "the instantiation token is {token}; of this binary and these resources it is \
             {expected}: make the FMU anew"
        );
        return Err(CallFailure::argument(message));
    }
    let choices: Choices = serde_json::from_str(&resources.options)
        .map_err(|error| CallFailure::new(FailureKind::Program, format!("{OPTIONS}: {error}")))?;
    let robot =
        Robot::from_profile(&resources.robot).map_err(|error| CallFailure::profile(&error))?;
    PlannedProgram::new(&ProgramSource::from_json(&resources.program)?, Some(robot), choices)
}
