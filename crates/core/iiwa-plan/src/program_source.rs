//! Reading of programs from a text, or from a file with the files that it names.

use std::{fs, path::Path, sync::Arc};

use iiwa_files::beside;
use iiwa_kin::Robot;
use iiwa_program::Program;

use crate::{Error, ProgramText};

/// A program with its text, its included file and its robot.
#[derive(Clone, Debug)]
pub struct ProgramSource {
    /// Program.
    pub program: Arc<Program>,
    /// Text of the program.
    pub text: ProgramText,
    /// Robot named by the program, before its flange length is set. An error is reported only if
    /// the request does not override the robot.
    robot: Result<Option<Robot>, Error>,
}

/// Reason why a program that is not in a file cannot name other files.
const TEXT_ALONE: &str = "only the text of the program is at hand, and no other file";

/// A file named by a program.
struct NamedFile {
    path: String,
    text: String,
}

impl ProgramSource {
    /// Reads a program that names no other files.
    ///
    /// # Errors
    ///
    /// [`Error::Program`] if the text is not a valid program, or includes a file.
    pub fn from_json(text: &str) -> Result<Self, Error> {
        Self::with_files(text, |_| Err(TEXT_ALONE.to_owned()))
    }

    /// Reads a program from a file, with the files beside it that the program names.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be read, and as [`beside`](Self::beside).
    pub fn load(path: &Path) -> Result<Self, Error> {
        let text = read(path)
            .map_err(|reason| Error::File { file: path.display().to_string(), reason })?;
        Self::beside(path, &text)
    }

    /// Reads a program whose text is that of the file at `path`, with the files beside it that the
    /// program names: tools, bases and frames, and the robot profile.
    ///
    /// # Errors
    ///
    /// [`Error::Program`] if the text is not a valid program, or the included file cannot be read.
    /// An unreadable profile is reported by [`PlanRequest::robot`](crate::PlanRequest::robot).
    pub fn beside(path: &Path, text: &str) -> Result<Self, Error> {
        Self::with_files(text, |name| {
            let file = beside(path, name, &["json"]).map_err(|reason| reason.to_string())?;
            let text = read(&file)
                .map_err(|reason| format!("cannot read {}: {reason}", file.display()))?;
            // Error messages quote lines of these files, and must not reveal lines of other kinds
            // of files.
            if text.trim_start().starts_with('{') {
                Ok(NamedFile { path: file.display().to_string(), text })
            } else {
                Err(format!("{} is not a JSON object", file.display()))
            }
        })
    }

    fn with_files(
        text: &str,
        read: impl Fn(&str) -> Result<NamedFile, String>,
    ) -> Result<Self, Error> {
        let mut included = None;
        let program = Program::from_json_with(text, |name| {
            let file = read(name)?;
            Ok(included.insert(file.text).clone())
        })?;
        let robot = program.robot.as_deref().map(|name| named(name, text, read)).transpose();
        let text = ProgramText::new(text, included.as_deref())?;
        Ok(Self { program: Arc::new(program), text, robot })
    }

    /// Robot named by the program, with the flange length that the program states; `None` if the
    /// program names no robot.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownRobot`] and [`Error::Profile`].
    pub fn named_robot(&self) -> Result<Option<Robot>, Error> {
        let robot = self.robot.clone()?;
        Ok(robot.map(|robot| self.program.with_flange(robot)))
    }
}

/// Converts a program built in code, with its text as written by [`Program::to_json`]. The profile
/// of a robot that it names is not read.
impl From<Program> for ProgramSource {
    fn from(program: Program) -> Self {
        let text = program.to_json();
        let robot = match program.robot.as_deref() {
            None => Ok(None),
            Some(name) => Robot::built_in(name)
                .map(Some)
                .ok_or_else(|| Error::unknown_robot(name, TEXT_ALONE, &text)),
        };
        Self { program: Arc::new(program), text: text.into(), robot }
    }
}

/// Reads the text of a file; the error gives the reason.
fn read(path: &Path) -> Result<String, String> {
    let bytes = fs::read(path).map_err(|error| error.to_string())?;
    let text = String::from_utf8(bytes).map_err(|_| "it is not text in UTF-8".to_owned())?;
    Ok(text.trim_start_matches('\u{feff}').to_owned())
}

/// Reads the robot named by the program in `text`: a built-in model, or a profile.
fn named(
    name: &str,
    text: &str,
    read: impl Fn(&str) -> Result<NamedFile, String>,
) -> Result<Robot, Error> {
    if let Some(robot) = Robot::built_in(name) {
        return Ok(robot);
    }
    let NamedFile { path: file, text } =
        read(name).map_err(|reason| Error::unknown_robot(name, reason, text))?;
    Robot::from_profile(&text).map_err(|error| Error::Profile {
        file,
        text,
        error: Box::new(error),
    })
}
