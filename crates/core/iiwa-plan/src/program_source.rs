//! Reading of programs from a text, or from a file with the files that it names; their texts.

use std::{path::Path, sync::Arc};

use iiwa_files::{beside, read_text};
use iiwa_json::without_mark;
use iiwa_kin::Robot;
use iiwa_program::{Program, ProgramError};

use crate::{
    Error,
    meshes::{Meshes, embedded_mesh, meshes, read_beside, with_embedded},
};

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
    /// Mesh files of payloads, by their names in the program.
    meshes: Arc<Meshes>,
}

/// Text of a program. Clones share the memory.
#[derive(Clone, Debug)]
pub struct ProgramText {
    text: Arc<str>,
    /// Text merged with the included file and with mesh files, if any.
    merged: Option<Arc<str>>,
}

impl ProgramText {
    /// Creates the text of a program from the program's file and the files that it names.
    fn new(
        text: &str,
        included: Option<&str>,
        program: &Program,
        meshes: &Meshes,
    ) -> Result<Self, ProgramError> {
        let merged = included.map(|file| Program::merged_json(text, file)).transpose()?;
        let embedded = with_embedded(merged.as_deref().unwrap_or(text), program, meshes);
        let merged = embedded.or(merged);
        Ok(Self { text: text.into(), merged: merged.map(Arc::from) })
    }

    /// Text as read; places in errors refer to it.
    #[must_use]
    pub fn as_read(&self) -> &str {
        &self.text
    }

    /// Text as stored and sent: merged with the included file and with mesh files, as data URIs, so
    /// that it needs no other file.
    #[must_use]
    pub fn complete(&self) -> &str {
        self.merged.as_deref().unwrap_or(&self.text)
    }
}

/// Converts a text that includes no file.
impl From<String> for ProgramText {
    fn from(text: String) -> Self {
        Self { text: text.into(), merged: None }
    }
}

/// Reason why a program without a path cannot name other files.
const TEXT_ALONE: &str = "only the text of the program is available, but no other file";

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
    /// [`Error::Program`] if the text is not a valid program, or names an included file or a mesh
    /// file.
    pub fn from_json(text: &str) -> Result<Self, Error> {
        let no_meshes = |_: &str| Err(TEXT_ALONE.to_owned());
        Self::with_files(text, |_| Err(TEXT_ALONE.to_owned()), no_meshes)
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

    /// Reads a program from `text`. The files that the program names (tools, bases and frames,
    /// meshes, and the robot profile) are read from the folder of `path`. The file `path` itself is
    /// not read.
    ///
    /// # Errors
    ///
    /// [`Error::Program`] if the text is not a valid program, or the included file cannot be read.
    /// An unreadable profile is reported by [`PlanRequest::robot`](crate::PlanRequest::robot).
    pub fn beside(path: &Path, text: &str) -> Result<Self, Error> {
        let json = |name: &str| {
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
        };
        Self::with_files(text, json, |name| read_beside(path, name))
    }

    fn with_files(
        text: &str,
        read: impl Fn(&str) -> Result<NamedFile, String>,
        read_mesh: impl Fn(&str) -> Result<Vec<u8>, String>,
    ) -> Result<Self, Error> {
        let text = without_mark(text);
        let mut included = None;
        let program = Program::from_json_with(text, |name| {
            let file = read(name)?;
            Ok(included.insert(file.text).clone())
        })
        .map_err(|first| Error::of_text(first, text))?;
        let robot = program.robot.as_deref().map(|name| named(name, text, read)).transpose();
        let meshes = meshes(&program, text, read_mesh)?;
        let text = ProgramText::new(text, included.as_deref(), &program, &meshes)?;
        Ok(Self { program: Arc::new(program), text, robot, meshes: Arc::new(meshes) })
    }

    /// Contents of a mesh file of a payload, by its name in the program, or its data URI.
    ///
    /// # Errors
    ///
    /// The reason why the contents are unknown.
    pub fn mesh(&self, file: &str) -> Result<Vec<u8>, String> {
        embedded_mesh(file)
            .unwrap_or_else(|| self.meshes.get(file).cloned().ok_or_else(|| TEXT_ALONE.to_owned()))
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
        Self { program: Arc::new(program), text: text.into(), robot, meshes: Arc::default() }
    }
}

/// Reads the text of a file; the error gives the reason.
fn read(path: &Path) -> Result<String, String> {
    read_text(path).map_err(|error| error.to_string())
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
