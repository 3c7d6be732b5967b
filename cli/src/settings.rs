//! Default option values: the file `iiwasim.toml`, and the environment.

use std::{
    env,
    path::{Path, PathBuf},
};

use clap::{Arg, Command, ValueEnum};
use iiwa_json::JsonPlace;
use iiwa_kin::{Robot, RosPrefix};
use serde::{Deserialize, Deserializer, de::Error};

use crate::{args::ros::RosPackage, failure::Failure};

/// Name of the file.
const FILE: &str = "iiwasim.toml";

/// Variable with the path of another file; an empty value disables the file.
const FILE_VARIABLE: &str = "IIWASIM_CONFIG";

/// Variable with the robot, like the key `robot` of the file.
const ROBOT_VARIABLE: &str = "IIWASIM_ROBOT";

/// Help text on settings.
pub(crate) const HELP: &str = "\
Defaults:
  iiwasim.toml in this folder, or in the nearest one above, may set robot,
  scene, drive, stream, key, server_key, ros_names and ros_prefix; paths are
  relative to it. IIWASIM_CONFIG names another file. IIWASIM_ROBOT,
  IIWASIM_SCENE, IIWASIM_DRIVE, IIWASIM_STREAM, IIWASIM_KEY,
  IIWASIM_SERVER_KEY, IIWASIM_ROS_NAMES and IIWASIM_ROS_PREFIX take precedence
  over the file, and options over variables. `robot` applies only to programs
  and commands that name no robot.";

/// Content of the file.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SettingsFile {
    robot: Option<String>,
    scene: Option<PathBuf>,
    drive: Option<String>,
    stream: Option<String>,
    key: Option<PathBuf>,
    server_key: Option<PathBuf>,
    ros_names: Option<RosPackage>,
    #[serde(default, deserialize_with = "ros_prefix")]
    ros_prefix: Option<RosPrefix>,
}

fn ros_prefix<'de, D: Deserializer<'de>>(text: D) -> Result<Option<RosPrefix>, D::Error> {
    String::deserialize(text)?.parse().map(Some).map_err(Error::custom)
}

impl SettingsFile {
    /// Reads the file of this folder or of the nearest one above, and the environment.
    pub(crate) fn read() -> Result<Self, Failure> {
        let path = match env::var_os(FILE_VARIABLE) {
            Some(path) if path.is_empty() => None,
            Some(path) => Some(PathBuf::from(path)),
            None => nearest(),
        };
        let mut settings = path.as_deref().map(Self::read_file).transpose()?.unwrap_or_default();
        if let Ok(robot) = env::var(ROBOT_VARIABLE)
            && !robot.is_empty()
        {
            settings.robot = Some(robot);
        }
        Ok(settings)
    }

    fn read_file(path: &Path) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let text = iiwa_files::read_text(path)
            .map_err(|error| Failure::input(format!("cannot read {name}: {error}")))?;
        let settings: Self = toml::from_str(&text).map_err(|error| {
            let place = JsonPlace::of_span(&text, error.span().unwrap_or_default());
            Failure::in_text(error.message(), &place, &name, &text)
        })?;
        if settings.key.is_some() != settings.server_key.is_some() {
            return Err(Failure::input(format!("{name}: key and server_key belong together")));
        }
        Ok(settings.relative_to(path.parent().unwrap_or(Path::new(""))))
    }

    /// Makes all paths relative to `folder`.
    fn relative_to(self, folder: &Path) -> Self {
        let below = |path: PathBuf| folder.join(path);
        // A name other than that of a built-in robot is a file.
        let robot = self.robot.map(|name| match Robot::built_in(&name) {
            Some(_) => name,
            None => folder.join(name).to_string_lossy().into_owned(),
        });
        Self {
            robot,
            scene: self.scene.map(below),
            key: self.key.map(below),
            server_key: self.server_key.map(below),
            ..self
        }
    }

    /// Makes the settings the defaults of a subcommand's options.
    pub(crate) fn apply(&self, command: Command) -> Command {
        let path = |path: &Option<PathBuf>| Some(path.as_ref()?.to_string_lossy().into_owned());
        // The key of a server has the same name as that of a client.
        let is_client = command.get_arguments().any(|arg| arg.get_id() == "server_key");
        command.mut_args(|arg| {
            let value = match arg.get_id().as_str() {
                "robot" if has_default(&arg) => self.robot.clone(),
                "drive" if has_default(&arg) => self.drive.clone(),
                "stream" if is_client => self.stream.clone(),
                "key" if is_client => path(&self.key),
                "server_key" => path(&self.server_key),
                "scene" => path(&self.scene),
                "ros_names" => self.ros_names.as_ref().and_then(value_of),
                "ros_prefix" => self.ros_prefix.as_ref().map(ToString::to_string),
                _ => None,
            };
            match value {
                Some(value) => arg.default_value(value),
                None => arg,
            }
        })
    }

    /// Returns the robot of programs and commands that name none, if set.
    pub(crate) fn into_robot(self) -> Option<String> {
        self.robot
    }
}

/// Returns the command-line name of a choice.
fn value_of(choice: &impl ValueEnum) -> Option<String> {
    Some(choice.to_possible_value()?.get_name().to_owned())
}

fn has_default(arg: &Arg) -> bool {
    !arg.get_default_values().is_empty()
}

/// Returns the file in this folder, or in the nearest folder above that has one.
fn nearest() -> Option<PathBuf> {
    let folder = env::current_dir().ok()?;
    let file = folder.ancestors().map(|folder| folder.join(FILE)).find(|file| file.is_file())?;
    // Messages name a file in this folder without its path.
    Some(file.strip_prefix(&folder).map_or_else(|_| file.clone(), Path::to_owned))
}
