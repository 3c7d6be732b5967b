//! Reasons why a program cannot be read or planned.

use iiwa_json::{Place, Step, excerpt, locate};
use iiwa_kin::{ProfileError, Robot};
use iiwa_program::{MotionIndex, ProgramError, Sources};
use iiwa_traj::{PlanError, TimingError};

/// Reason why a program cannot be read or planned. The message of [`Display`](std::fmt::Display) ends with the place in the
/// program's text, where there is one.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file cannot be read.
    #[error("cannot read {file}: {reason}")]
    File {
        /// The path of the file.
        file: String,
        /// The reason, as the system reports it.
        reason: String,
    },
    /// The text is not a valid program.
    #[error(transparent)]
    Program(#[from] ProgramError),
    /// The program names a robot that is neither built in nor a profile that can be read.
    #[error("{}, at {place}", unknown_robot(.name, .reason))]
    UnknownRobot {
        /// The name in the program.
        name: String,
        /// The reason why it is not read as a profile.
        reason: String,
        /// The place at which the program names it.
        place: Place,
    },
    /// The profile of the robot that the program names is not valid.
    #[error("the robot's profile {file}: {error}")]
    Profile {
        /// The path of the profile.
        file: String,
        /// Its text.
        text: String,
        /// The fault, with its place in that text.
        error: Box<ProfileError>,
    },
    /// The program is valid, and has no plan for the robot.
    #[error("{message}{}", .place.as_ref().map_or(String::new(), |place| format!(", at {place}")))]
    Plan {
        /// The fault, with the sources of the motions that it names.
        message: String,
        /// The place in the text of the program; none if no motion of it is at fault.
        place: Option<Place>,
        /// The motion at fault.
        motion: Option<MotionIndex>,
        /// The error of the planner.
        error: Box<PlanError>,
    },
}

impl Error {
    /// The error of a robot that a program, read from `text`, names in vain.
    pub(crate) fn unknown_robot(name: &str, reason: impl Into<String>, text: &str) -> Self {
        let place = locate(text, &[Step::Key("robot")]);
        Self::UnknownRobot { name: name.to_owned(), reason: reason.into(), place }
    }

    /// The error of a program that was read from `text` and cannot be planned.
    #[must_use]
    pub fn plan(error: PlanError, sources: &Sources, text: &str) -> Self {
        let message = sources.in_message(&error.to_string());
        let motion = error.motion();
        let place = match &error {
            PlanError::Fault(fault) => Some(fault.place_in(text)),
            _ => motion
                .map(|motion| locate(text, &[Step::Key("motions"), Step::Index(motion.index())])),
        };
        Self::Plan { message, place, motion, error: Box::new(error) }
    }

    /// The message without the place.
    #[must_use]
    pub fn what(&self) -> String {
        match self {
            Self::File { .. } | Self::Profile { .. } => self.to_string(),
            Self::Program(error) => error.what(),
            Self::UnknownRobot { name, reason, .. } => unknown_robot(name, reason),
            Self::Plan { message, .. } => message.clone(),
        }
    }

    /// The place in the program's text; none of a file that cannot be read, and of a fault in the profile of the robot.
    #[must_use]
    pub fn place(&self) -> Option<&Place> {
        match self {
            Self::File { .. } | Self::Profile { .. } => None,
            Self::Program(error) => Some(error.place()),
            Self::UnknownRobot { place, .. } => Some(place),
            Self::Plan { place, .. } => place.as_ref(),
        }
    }

    /// The motion at fault, if it is one.
    #[must_use]
    pub fn motion(&self) -> Option<MotionIndex> {
        match self {
            Self::File { .. } | Self::UnknownRobot { .. } | Self::Profile { .. } => None,
            Self::Program(error) => error.motion(),
            Self::Plan { motion, .. } => *motion,
        }
    }

    /// True if the planning was interrupted.
    #[must_use]
    pub fn is_interrupt(&self) -> bool {
        let Self::Plan { error, .. } = self else { return false };
        matches!(**error, PlanError::Timing(TimingError::Interrupted))
    }
}

fn unknown_robot(name: &str, reason: &str) -> String {
    let (name, built_in) = (excerpt(name), Robot::BUILT_IN.join(" and "));
    format!("no robot is called `{name}`: {built_in} are built in, and as a profile, {reason}")
}
