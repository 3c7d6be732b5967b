//! Reading programs, profiles and robots.

use std::{
    fs::{self, File},
    io::{self, Read},
    path::{Path, PathBuf},
};

use iiwa_kin::{
    Robot,
    json::{Step, locate},
};
use iiwa_log::JointLog;
use iiwa_path::Program;
use iiwa_scene::Scene;

use crate::failure::{Failure, chain};

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
        (Some(name), _) => find_robot(name, Path::new("."))?,
        (None, None) => Robot::default(),
        (None, Some(name)) => {
            // A profile's name is meant from where the program is.
            let folder = path.parent().unwrap_or(Path::new("."));
            if Robot::built_in(name).is_none() && !folder.join(name).is_file() {
                let place = locate(&text.text, &[Step::Key("robot")]);
                let what = unknown_robot(name, &folder.join(name));
                return Err(Failure::in_text(&what, &place, &text.name, &text.text));
            }
            find_robot(name, folder)?
        }
    };
    Ok((text, program, robot))
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

/// Reads what a robot did from any file that holds joint positions.
pub(crate) fn recording(path: &Path) -> Result<JointLog, Failure> {
    JointLog::read(open(path)?).and_then(|log| log.check_rate().map(|()| log)).map_err(|error| {
        let hint = match path.extension() {
            Some(extension) if extension == "json" => "; a program has to be planned first",
            _ => "",
        };
        Failure::input(format!("{}: {}{hint}", path.display(), chain(&error)))
    })
}

/// The built-in model or the profile file called `name`, looked for in `folder`.
pub(crate) fn find_robot(name: &str, folder: &Path) -> Result<Robot, Failure> {
    if let Some(robot) = Robot::built_in(name) {
        return Ok(robot);
    }
    let path: PathBuf = folder.join(name);
    if !path.is_file() {
        return Err(Failure::input(unknown_robot(name, &path)));
    }
    let Text { name, text } = Text::read(&path)?;
    Robot::from_profile(&text)
        .map_err(|error| Failure::in_text(&error.what(), error.place(), &name, &text))
}

fn unknown_robot(name: &str, path: &Path) -> String {
    format!(
        "no robot is called `{name}`: {} are built in, and there is no profile file {}",
        Robot::BUILT_IN.join(" and "),
        path.display()
    )
}
