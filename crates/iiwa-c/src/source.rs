//! Programs as they are read: from a text, or from a file with what it names.

use std::{fs, path::Path};

use iiwa_files::beside;
use iiwa_json::{Step, excerpt, locate};
use iiwa_kin::Robot;
use iiwa_program::Program;

use crate::failure::{Failure, FailureKind};

/// A program with its text, and with the robot that it names.
#[derive(Clone, Debug)]
pub(crate) struct ProgramSource {
    pub(crate) program: Program,
    /// As it was read: places in errors are places in it.
    pub(crate) text: String,
    /// With what it includes, so that it needs no other file.
    pub(crate) complete: String,
    /// The robot of the profile that it names; none if it names a built-in model, or nothing.
    profile: Option<Robot>,
}

impl ProgramSource {
    /// A program that needs no other file.
    pub(crate) fn from_json(text: &str) -> Result<Self, Failure> {
        let program = Program::from_json(text).map_err(|error| Failure::program(&error, text))?;
        Ok(Self { program, text: text.to_owned(), complete: text.to_owned(), profile: None })
    }

    /// The program of a file, with the files beside it that it names.
    pub(crate) fn load(path: &Path) -> Result<Self, Failure> {
        let text = read(path)?;
        let mut file = None;
        let program = Program::from_json_with(&text, |name| {
            let included = object_beside(path, name)?;
            Ok(file.insert(included).clone())
        })
        .map_err(|error| Failure::program(&error, &text))?;
        let complete = match file {
            None => text.clone(),
            Some(file) => Program::merged_json(&text, &file)
                .map_err(|error| Failure::program(&error, &text))?,
        };
        let profile = match &program.robot {
            Some(name) if Robot::built_in(name).is_none() => {
                let profile =
                    object_beside(path, name).map_err(|why| no_robot(name, &why, &text))?;
                Some(Robot::from_profile(&profile).map_err(|error| Failure::profile(&error))?)
            }
            _ => None,
        };
        Ok(Self { program, text, complete, profile })
    }

    /// The robot that it names; the default model if it names none.
    pub(crate) fn robot(&self) -> Result<Robot, Failure> {
        let robot = match (&self.profile, &self.program.robot) {
            (Some(robot), _) => robot.clone(),
            (None, None) => Robot::default(),
            (None, Some(name)) => Robot::built_in(name).ok_or_else(|| {
                let why = "a program that is no file has its profile in the options";
                no_robot(name, why, &self.text)
            })?,
        };
        Ok(self.program.with_flange(robot))
    }
}

/// A robot that the program names, and that there is not.
fn no_robot(name: &str, why: &str, text: &str) -> Failure {
    let place = locate(text, &[Step::Key("robot")]);
    let built_in = Robot::BUILT_IN.join(" and ");
    let name = excerpt(name);
    let what = format!("no robot is called `{name}`: {built_in} are built in; {why}, at {place}");
    Failure::in_program(FailureKind::Program, what, &place, text)
}

/// A file's text.
fn read(path: &Path) -> Result<String, Failure> {
    let refuse = |why: &dyn std::fmt::Display| {
        Failure::new(FailureKind::File, format!("cannot read {}: {why}", path.display()))
    };
    let bytes = fs::read(path).map_err(|error| refuse(&error))?;
    let text = String::from_utf8(bytes).map_err(|_| refuse(&"it is no text in UTF-8"))?;
    Ok(text.trim_start_matches('\u{feff}').to_owned())
}

/// The text of a JSON object in a file that the program at `path` names. Errors show lines of such files, which must not be
/// those of any other kind.
fn object_beside(path: &Path, name: &str) -> Result<String, String> {
    let file = beside(path, name, &["json"]).map_err(|error| error.to_string())?;
    let text = read(&file).map_err(|failure| failure.message)?;
    if text.trim_start().starts_with('{') {
        Ok(text)
    } else {
        Err("it holds no JSON object".to_owned())
    }
}
