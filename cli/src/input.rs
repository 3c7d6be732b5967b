//! Reading programs, robot profiles, scenes and recordings.

use std::{
    io,
    path::Path,
    sync::{Arc, OnceLock},
};

use iiwa_files::{self as files, NotBeside, NotUtf8, beside, interrupt};
use iiwa_json::UTF_16;
use iiwa_kin::Robot;
use iiwa_log::{JointLog, Positions};
use iiwa_plan::{Plan, PlanRequest, ProgramSource};
#[cfg(feature = "sunrise")]
use iiwa_program::Program;
use iiwa_program::Workcell;
use iiwa_report::with_causes;
use iiwa_scene::Scene;

use crate::{
    args::LogReading,
    failure::Failure,
    file_kind::{JsonKind, binary_hint, other_kind},
};

/// Returns true if a file is read from standard input.
pub(crate) fn is_stdin(path: &Path) -> bool {
    path == Path::new("-")
}

/// Name and text of a file.
#[derive(Debug)]
pub(crate) struct FileText {
    pub(crate) name: String,
    pub(crate) text: String,
}

impl FileText {
    /// Reads a file, or standard input for `-`.
    pub(crate) fn read(path: &Path) -> Result<Self, Failure> {
        let (name, bytes) = if is_stdin(path) {
            ("standard input".to_owned(), files::read_stdin())
        } else {
            (path.display().to_string(), files::read(path))
        };
        let bytes = bytes.map_err(|error| unreadable(&name, &error))?;
        match files::text(bytes) {
            Ok(text) => Ok(Self { name, text }),
            Err(NotUtf8::Utf16(_)) => Err(Failure::input(format!("{name} is {UTF_16}"))),
            Err(error) => {
                let hint = binary_hint(error.as_bytes());
                Err(Failure::input(format!("{name} is not text in UTF-8{hint}")))
            }
        }
    }
}

/// Returns the failure for a file that cannot be read; an interrupt ends the wait for a pipe.
pub(crate) fn unreadable(name: &str, error: &io::Error) -> Failure {
    if interrupt::has_come() {
        return Failure::interrupted();
    }
    Failure::input(format!("cannot read {name}: {error}"))
}

/// Robot of programs and commands that name none, if it is not the default model.
static ROBOT: OnceLock<String> = OnceLock::new();

/// Sets the robot of programs and commands that name none: a built-in model, or the path of a
/// profile.
pub(crate) fn set_default_robot(name: String) {
    let _ = ROBOT.set(name);
}

/// Returns the robot that the settings name: a built-in model, or the path of a profile.
pub(crate) fn usual_robot() -> Option<&'static str> {
    ROBOT.get().map(String::as_str)
}

/// Returns the robot of programs and commands that name none.
pub(crate) fn default_robot() -> Result<Robot, Failure> {
    usual_robot().map_or_else(|| Ok(Robot::default()), find_robot)
}

/// Program with its name, and the request for its plan.
pub(crate) struct Input {
    pub(crate) name: String,
    pub(crate) source: ProgramSource,
    pub(crate) request: PlanRequest,
}

impl Input {
    /// Creates the input for a program without a file.
    #[cfg(feature = "sunrise")]
    pub(crate) fn generated(name: String, program: Program, robot: Robot) -> Self {
        let request = PlanRequest { robot: Some(robot), ..PlanRequest::default() };
        Self { name, source: program.into(), request }
    }

    /// Returns the robot of the plan.
    pub(crate) fn robot(&self) -> Result<Robot, Failure> {
        self.request.robot(&self.source).map_err(|error| self.to_failure(&error))
    }

    /// Returns the failure for an error of reading or planning.
    pub(crate) fn to_failure(&self, error: &iiwa_plan::Error) -> Failure {
        Failure::program(error, &self.name, self.source.text.as_read())
    }

    /// Plans the whole program.
    pub(crate) fn plan(&self) -> Result<Plan, Failure> {
        self.request.plan(&self.source).map_err(|error| self.to_failure(&error))
    }
}

/// Reads a program with the files that it names; `robot` overrides its own robot.
pub(crate) fn program(path: &Path, robot: Option<&str>) -> Result<Input, Failure> {
    program_of(path, FileText::read(path)?, robot)
}

/// Reads the tools, bases and frames of a program, or of a file for inclusion; and the robot.
pub(crate) fn workcell(path: &Path, robot: Option<&str>) -> Result<(Workcell, Robot), Failure> {
    let text = FileText::read(path)?;
    match Workcell::from_json(&text.text) {
        Ok(workcell) => {
            return Ok((workcell, robot.map_or_else(default_robot, find_robot)?));
        }
        Err(error) if JsonKind::of(&text.text) != Some(JsonKind::Program) => {
            return Err(Failure::in_text(&error.message(), error.place(), &text.name, &text.text));
        }
        Err(_) => {}
    }
    let input = program_of(path, text, robot)?;
    let robot = input.robot()?;
    Ok((Arc::unwrap_or_clone(input.source.program).workcell, robot))
}

/// Creates the input for the program read from `path`.
fn program_of(
    path: &Path,
    FileText { name, text }: FileText,
    robot: Option<&str>,
) -> Result<Input, Failure> {
    let source = ProgramSource::beside(path, &text).map_err(|error| {
        other_kind(&name, &text, JsonKind::Program, "program")
            .map_or_else(|| Failure::program(&error, &name, &text), Failure::input)
    })?;
    let request = request(&source, robot)?;
    Ok(Input { name, source, request })
}

/// Creates the request for a plan of a program; `robot` overrides the program's robot.
pub(crate) fn request(source: &ProgramSource, robot: Option<&str>) -> Result<PlanRequest, Failure> {
    let mut request = PlanRequest::default();
    match robot {
        Some(robot) => request.robot = Some(find_robot(robot)?),
        None if source.program.robot.is_none() => request.default_robot = default_robot()?,
        None => {}
    }
    Ok(request)
}

/// Reads a scene with the meshes that it names.
pub(crate) fn scene(path: &Path) -> Result<Scene, Failure> {
    let FileText { name, text } = FileText::read(path)?;
    Scene::from_json_with(&text, |name| mesh(path, name)).map_err(|error| {
        other_kind(&name, &text, JsonKind::Scene, "scene").map_or_else(
            || Failure::in_text(&error.message(), error.place(), &name, &text),
            Failure::input,
        )
    })
}

/// Reads the file of a mesh that the scene at `path` names; the error is the reason for failure.
fn mesh(path: &Path, name: &str) -> Result<Vec<u8>, String> {
    let file = beside(path, name, &["stl", "obj"]).map_err(|reason| match reason {
        NotBeside::Elsewhere => {
            "it has to be a file *.stl or *.obj beside the scene or in a folder below it".to_owned()
        }
        reason => reason.to_string(),
    })?;
    files::read_mesh(&file)
}

/// Opens a file or a pipe.
pub(crate) fn open(path: &Path) -> Result<files::InputFile, Failure> {
    files::InputFile::open(path).map_err(|error| unreadable(&path.display().to_string(), &error))
}

/// Reads a recording in any format with joint positions.
pub(crate) fn recording(
    path: &Path,
    reading: LogReading,
    default: Positions,
) -> Result<JointLog, Failure> {
    JointLog::read_with(open(path)?, reading.options(default))
        .and_then(|log| log.check_rate().map(|()| log))
        .map_err(|error| {
            if interrupt::has_come() {
                return Failure::interrupted();
            }
            let hint = match path.extension() {
                Some(extension) if extension == "json" => "; a program has to be planned first",
                _ => "",
            };
            Failure::input(format!("{}: {}{hint}", path.display(), with_causes(&error)))
        })
}

/// Returns the built-in model called `name`, or the robot of the profile at this path.
pub(crate) fn find_robot(name: &str) -> Result<Robot, Failure> {
    let path = Path::new(name);
    match Robot::built_in(name) {
        Some(robot) => Ok(robot),
        None if path.exists() && !path.is_dir() => robot_of(&FileText::read(path)?),
        None => Err(Failure::input(unknown_robot(name, path))),
    }
}

/// Returns the robot of a profile.
fn robot_of(FileText { name, text }: &FileText) -> Result<Robot, Failure> {
    Robot::from_profile(text).map_err(|error| {
        other_kind(name, text, JsonKind::Profile, "robot profile").map_or_else(
            || Failure::in_text(&error.message(), error.place(), name, text),
            Failure::input,
        )
    })
}

fn unknown_robot(name: &str, path: &Path) -> String {
    format!(
        "no robot is called `{name}`: {} are built in, and there is no profile file {}",
        Robot::BUILT_IN.join(" and "),
        path.display()
    )
}
