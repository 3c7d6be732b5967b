//! Reading programs, robot profiles, scenes and recordings.

use std::{
    ffi::OsStr,
    fs::{self, File},
    io::{self, Read},
    path::{Component, Path, PathBuf},
};

use iiwa_json::{Step, locate};
use iiwa_kin::Robot;
use iiwa_log::JointLog;
use iiwa_path::Program;
use iiwa_scene::Scene;
use iiwa_view::with_causes;

use crate::failure::Failure;

/// A file's name and text.
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
            Err(_) => Err(Failure::input(format!("{name} is not text in UTF-8"))),
        }
    }
}

/// Reads a program, and its robot unless `robot` names another one.
pub(crate) fn program(path: &Path, robot: Option<&str>) -> Result<(Text, Program, Robot), Failure> {
    let text = Text::read(path)?;
    let program = Program::from_json(&text.text)
        .map_err(|error| Failure::in_text(&error.what(), error.place(), &text.name, &text.text))?;
    let robot = match (robot, &program.robot) {
        (Some(name), _) => find_robot(name)?,
        (None, None) => Robot::default(),
        (None, Some(name)) => Robot::built_in(name).map_or_else(|| named(path, &text, name), Ok)?,
    };
    Ok((text, program, robot))
}

/// The robot of the profile that a program, read from `path`, names.
fn named(path: &Path, program: &Text, name: &str) -> Result<Robot, Failure> {
    let profile = beside(path, name).map_err(|what| {
        let place = locate(&program.text, &[Step::Key("robot")]);
        Failure::in_text(&what, &place, &program.name, &program.text)
    })?;
    let profile = Text::read(&profile)?;
    // Errors show lines of the file, which must not be those of any other kind of file.
    if profile.text.trim_start().starts_with('{') {
        robot_of(&profile)
    } else {
        Err(Failure::input(format!("{} is no robot profile: no JSON object", profile.name)))
    }
}

/// The path of the profile that a program names, in the program's folder or below. A program from elsewhere must
/// not make this process read, and show in errors, any other file.
fn beside(program: &Path, name: &str) -> Result<PathBuf, String> {
    let folder = program.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    let path = folder.join(name);
    let below = |part: Component<'_>| matches!(part, Component::Normal(_) | Component::CurDir);
    let name_path = Path::new(name);
    if !name_path.components().all(below) || name_path.extension() != Some(OsStr::new("json")) {
        return Err(format!(
            "no robot is called `{name}`: {} are built in, and a profile is a file *.json beside the program \
             or in a folder below it; --robot takes any other",
            Robot::BUILT_IN.join(" and ")
        ));
    }
    if !path.is_file() {
        return Err(unknown_robot(name, &path));
    }
    let leads_out = match (path.canonicalize(), folder.canonicalize()) {
        (Ok(file), Ok(folder)) => !file.starts_with(folder),
        _ => true,
    };
    if leads_out {
        return Err(format!(
            "{} leads out of the program's folder; --robot takes it",
            path.display()
        ));
    }
    Ok(path)
}

/// Reads a scene.
pub(crate) fn scene(path: &Path) -> Result<Scene, Failure> {
    let Text { name, text } = Text::read(path)?;
    Scene::from_json(&text)
        .map_err(|error| Failure::in_text(&error.what(), error.place(), &name, &text))
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
pub(crate) fn recording(path: &Path) -> Result<JointLog, Failure> {
    JointLog::read(open(path)?).and_then(|log| log.check_rate().map(|()| log)).map_err(|error| {
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
    Robot::from_profile(text)
        .map_err(|error| Failure::in_text(&error.what(), error.place(), name, text))
}

fn unknown_robot(name: &str, path: &Path) -> String {
    format!(
        "no robot is called `{name}`: {} are built in, and there is no profile file {}",
        Robot::BUILT_IN.join(" and "),
        path.display()
    )
}
