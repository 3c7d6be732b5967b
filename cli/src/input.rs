//! Reading programs, robot profiles, scenes and recordings.

use std::{
    fs::{self, File},
    io::{self, Read},
    path::Path,
    sync::OnceLock,
};

use iiwa_files::{NotBeside, beside, folder_of};
use iiwa_json::{Step, locate};
use iiwa_kin::Robot;
use iiwa_log::{JointLog, Positions};
use iiwa_program::{Program, ProgramError, Workcell};
use iiwa_scene::Scene;
use iiwa_view::with_causes;

use crate::{
    args::LogReading,
    failure::Failure,
    file_kind::{JsonKind, binary_hint},
};

/// A file's name and text.
#[derive(Debug)]
pub(crate) struct Text {
    pub(crate) name: String,
    pub(crate) text: String,
}

impl Text {
    /// Reads a file, or standard input for `-`.
    pub(crate) fn read(path: &Path) -> Result<Self, Failure> {
        let (name, bytes) = if path == Path::new("-") {
            let mut bytes = Vec::new();
            let read = io::stdin().lock().read_to_end(&mut bytes).map(|_| bytes);
            ("standard input".to_owned(), read)
        } else {
            (path.display().to_string(), fs::read(path))
        };
        let bytes =
            bytes.map_err(|error| Failure::input(format!("cannot read {name}: {error}")))?;
        match String::from_utf8(bytes) {
            Ok(text) => Ok(Self { text: text.trim_start_matches('\u{feff}').to_owned(), name }),
            Err(error) => {
                let hint = binary_hint(error.as_bytes());
                Err(Failure::input(format!("{name} is not text in UTF-8{hint}")))
            }
        }
    }
}

/// The robot of programs and commands that name none, if it is not the default model.
static ROBOT: OnceLock<String> = OnceLock::new();

/// From now on, programs and commands that name no robot are for this one: a built-in model, or the path of a profile.
pub(crate) fn set_default_robot(name: String) {
    let _ = ROBOT.set(name);
}

/// The robot that the settings name: a built-in model, or the path of a profile.
#[cfg(feature = "sunrise")]
pub(crate) fn usual_robot() -> Option<&'static str> {
    ROBOT.get().map(String::as_str)
}

/// The robot of programs and commands that name none.
pub(crate) fn default_robot() -> Result<Robot, Failure> {
    ROBOT.get().map_or_else(|| Ok(Robot::default()), |name| find_robot(name))
}

/// A program's name and text.
pub(crate) struct ProgramText {
    pub(crate) name: String,
    /// As it was read.
    pub(crate) text: String,
    /// With what it includes, if it includes anything.
    merged: Option<String>,
}

impl ProgramText {
    /// A program that is in no file.
    #[cfg(feature = "sunrise")]
    pub(crate) fn made(name: String, text: String) -> Self {
        Self { name, text, merged: None }
    }

    /// The program as it is stored and sent: it needs no other file.
    pub(crate) fn complete(&self) -> &str {
        self.merged.as_deref().unwrap_or(&self.text)
    }
}

/// Reads a program with what it includes, and its robot unless `robot` names another one.
pub(crate) fn program(
    path: &Path,
    robot: Option<&str>,
) -> Result<(ProgramText, Program, Robot), Failure> {
    program_of(path, Text::read(path)?, robot)
}

/// Reads the tools, bases and frames of a program, or of a file that programs include; and the robot.
pub(crate) fn workcell(path: &Path, robot: Option<&str>) -> Result<(Workcell, Robot), Failure> {
    let text = Text::read(path)?;
    match Workcell::from_json(&text.text) {
        Ok(workcell) => {
            return Ok((workcell, robot.map_or_else(default_robot, find_robot)?));
        }
        Err(error) if JsonKind::of(&text.text) != Some(JsonKind::Program) => {
            return Err(Failure::in_text(&error.what(), error.place(), &text.name, &text.text));
        }
        Err(_) => {}
    }
    program_of(path, text, robot).map(|(_, program, robot)| (program.workcell, robot))
}

/// The program that was read from `path`.
fn program_of(
    path: &Path,
    Text { name, text }: Text,
    robot: Option<&str>,
) -> Result<(ProgramText, Program, Robot), Failure> {
    let mut file = None;
    let program = Program::from_json_with(&text, |name| {
        included(path, name).inspect(|text| file = Some(text.clone()))
    });
    let refuse = |error| match error {
        ProgramError::Included { name, text, error, .. } => {
            let file = folder_of(path).join(name).display().to_string();
            Failure::in_text(&error.what(), error.place(), &file, &text)
        }
        error => Failure::in_text(&error.what(), error.place(), &name, &text),
    };
    let program = match program {
        Ok(program) => program,
        Err(error) => {
            return Err(other_kind(&name, &text, JsonKind::Program, "program")
                .unwrap_or_else(|| refuse(error)));
        }
    };
    let merged = file.map(|file| Program::merged_json(&text, &file)).transpose().map_err(refuse)?;
    let robot = match (robot, &program.robot) {
        // A profile says all of a robot, a name of a model nothing about its flange.
        (Some(name), _) if Robot::built_in(name).is_none() => find_robot(name)?,
        (Some(name), _) => program.with_flange(find_robot(name)?),
        (None, None) => program.with_flange(default_robot()?),
        (None, Some(robot)) => program.with_flange(
            Robot::built_in(robot).map_or_else(|| named(path, [&name, &text], robot), Ok)?,
        ),
    };
    Ok((ProgramText { name, text, merged }, program, robot))
}

/// The failure of a file that is of another kind than the one that it was given as, if that can be told.
fn other_kind(name: &str, text: &str, own: JsonKind, wanted: &str) -> Option<Failure> {
    let kind = JsonKind::of(text).filter(|kind| *kind != own)?;
    Some(Failure::input(format!("{name} {}", kind.hint(wanted))))
}

/// The robot of the profile that a program, read from `path` with this name and text, names.
fn named(path: &Path, [program, text]: [&str; 2], name: &str) -> Result<Robot, Failure> {
    let profile = beside(path, name, &["json"]).map_err(|reason| {
        let what = match reason {
            NotBeside::Elsewhere => format!(
                "no robot is called `{name}`: {} are built in, and a profile is a file *.json beside the \
                 program or in a folder below it; --robot takes any other",
                Robot::BUILT_IN.join(" and ")
            ),
            NotBeside::Missing(path) => unknown_robot(name, &path),
            NotBeside::LeadsOut(path) => {
                format!("{} leads out of the program's folder; --robot takes it", path.display())
            }
        };
        Failure::in_text(&what, &locate(text, &[Step::Key("robot")]), program, text)
    })?;
    let profile = Text::read(&profile)?;
    if is_object(&profile) {
        robot_of(&profile)
    } else {
        Err(Failure::input(format!("{} is no robot profile: no JSON object", profile.name)))
    }
}

/// Reads the file that the program at `path` includes; the error says why it cannot be read.
fn included(path: &Path, name: &str) -> Result<String, String> {
    let file = beside(path, name, &["json"]).map_err(|reason| {
        let elsewhere = "it has to be a file *.json beside the program or in a folder below it";
        not_beside(reason, elsewhere, "program")
    })?;
    let file = Text::read(&file).map_err(|failure| failure.what())?;
    if is_object(&file) { Ok(file.text) } else { Err("it holds no JSON object".to_owned()) }
}

/// Errors show lines of a file that a program names, which must not be those of any other kind of file.
fn is_object(file: &Text) -> bool {
    file.text.trim_start().starts_with('{')
}

/// Why a file is not read that a file of this kind names; `elsewhere` explains which ones may be named.
fn not_beside(reason: NotBeside, elsewhere: &str, kind: &str) -> String {
    match reason {
        NotBeside::Elsewhere => elsewhere.to_owned(),
        NotBeside::Missing(path) => format!("there is no file {}", path.display()),
        NotBeside::LeadsOut(path) => format!("{} leads out of the {kind}'s folder", path.display()),
    }
}

/// Reads a scene with the meshes that it names.
pub(crate) fn scene(path: &Path) -> Result<Scene, Failure> {
    let Text { name, text } = Text::read(path)?;
    Scene::from_json_with(&text, |name| mesh(path, name)).map_err(|error| {
        other_kind(&name, &text, JsonKind::Scene, "scene")
            .unwrap_or_else(|| Failure::in_text(&error.what(), error.place(), &name, &text))
    })
}

/// Reads the file of a mesh that the scene at `path` names; the error says why it cannot be read.
fn mesh(path: &Path, name: &str) -> Result<Vec<u8>, String> {
    let file = beside(path, name, &["stl", "obj"]).map_err(|reason| {
        let elsewhere =
            "it has to be a file *.stl or *.obj beside the scene or in a folder below it";
        not_beside(reason, elsewhere, "scene")
    })?;
    fs::read(&file).map_err(|error| format!("cannot read {}: {error}", file.display()))
}

/// Opens a file.
pub(crate) fn open(path: &Path) -> Result<File, Failure> {
    let refuse = |error| Failure::input(format!("cannot read {}: {error}", path.display()));
    let file = File::open(path).map_err(refuse)?;
    if file.metadata().is_ok_and(|kind| kind.is_dir()) {
        return Err(refuse(io::Error::from(io::ErrorKind::IsADirectory)));
    }
    Ok(file)
}

/// Reads a recording in any format that holds joint positions.
pub(crate) fn recording(
    path: &Path,
    reading: LogReading,
    default: Positions,
) -> Result<JointLog, Failure> {
    JointLog::read_with(open(path)?, reading.options(default))
        .and_then(|log| log.check_rate().map(|()| log))
        .map_err(|error| {
            let hint = match path.extension() {
                Some(extension) if extension == "json" => "; a program has to be planned first",
                _ => "",
            };
            Failure::input(format!("{}: {}{hint}", path.display(), with_causes(&error)))
        })
}

/// The built-in model called `name`, or the robot of the profile at this path.
pub(crate) fn find_robot(name: &str) -> Result<Robot, Failure> {
    let path = Path::new(name);
    match Robot::built_in(name) {
        Some(robot) => Ok(robot),
        None if path.is_file() => robot_of(&Text::read(path)?),
        None => Err(Failure::input(unknown_robot(name, path))),
    }
}

/// The robot of a profile.
fn robot_of(Text { name, text }: &Text) -> Result<Robot, Failure> {
    Robot::from_profile(text).map_err(|error| {
        other_kind(name, text, JsonKind::Profile, "robot profile")
            .unwrap_or_else(|| Failure::in_text(&error.what(), error.place(), name, text))
    })
}

fn unknown_robot(name: &str, path: &Path) -> String {
    format!(
        "no robot is called `{name}`: {} are built in, and there is no profile file {}",
        Robot::BUILT_IN.join(" and "),
        path.display()
    )
}
