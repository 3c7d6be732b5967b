//! Robot of a recording.

use iiwa_kin::Robot;

/// Name of the attachment with the robot profile.
pub(crate) const PROFILE: &str = "robot.json";

/// Reason why the robot of a file is unknown.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordedRobotError {
    /// The file names a robot that is not built in, and lacks its profile.
    #[error("the robot `{name}` is not built in, and the file has no profile of it")]
    Unknown {
        /// Name of the robot in the file.
        name: String,
    },
    /// The attachment `robot.json` is not a robot profile.
    #[error("the attachment `{PROFILE}` is not a robot profile: {message}")]
    Profile {
        /// Error found in the profile.
        message: String,
    },
}

/// Returns the robot of the `profile` in a file, or the built-in one that the file names; `None` if
/// the file has neither.
pub(crate) fn recorded_robot(
    name: Option<&str>,
    profile: Option<&str>,
) -> Result<Option<Robot>, RecordedRobotError> {
    if let Some(profile) = profile {
        return Robot::from_profile(profile)
            .map(Some)
            .map_err(|error| RecordedRobotError::Profile { message: error.message() });
    }
    let Some(name) = name else { return Ok(None) };
    Robot::built_in(name)
        .map(Some)
        .ok_or_else(|| RecordedRobotError::Unknown { name: name.to_owned() })
}
