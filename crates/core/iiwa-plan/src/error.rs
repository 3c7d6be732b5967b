//! Reasons why a program cannot be read or planned.

use std::{collections::BTreeSet, slice};

use iiwa_json::{JsonPlace, JsonStep, excerpt, further_errors, locate};
use iiwa_kin::{ProfileError, Robot};
use iiwa_program::{Fault, MAX_ERRORS, MotionIndex, Program, ProgramError, Sources, motion_path};
use iiwa_traj::{PlanError, TimingError};

/// Error: a program cannot be read or planned. The message of [`Display`](std::fmt::Display) ends
/// with the place in the program's text, if known.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file cannot be read.
    #[error("cannot read {file}: {reason}")]
    File {
        /// Path of the file.
        file: String,
        /// Reason reported by the operating system.
        reason: String,
    },
    /// The text is not a valid program.
    #[error(transparent)]
    Program(#[from] ProgramError),
    /// The program names a robot that is neither built in nor a readable profile.
    #[error("{}, at {place}", unknown_robot(.name, .reason))]
    UnknownRobot {
        /// Robot name in the program.
        name: String,
        /// Reason why the name is not read as a profile.
        reason: String,
        /// Place of the robot name in the program.
        place: JsonPlace,
    },
    /// The profile of the robot named by the program is not valid.
    #[error("the robot's profile {file}: {error}")]
    Profile {
        /// Path of the profile.
        file: String,
        /// Text of the profile.
        text: String,
        /// Error, with its place in the profile's text.
        error: Box<ProfileError>,
    },
    /// The program is valid but cannot be planned for the robot.
    #[error("{message}{}", .place.as_ref().map_or(String::new(), |place| format!(", at {place}")))]
    Plan {
        /// Message, with the sources of the motions that it names.
        message: String,
        /// Place in the text of the program; `None` if no motion is at fault.
        place: Option<JsonPlace>,
        /// Motion at fault.
        motion: Option<MotionIndex>,
        /// Planner error.
        error: Box<PlanError>,
    },
    /// Several errors that are independent of each other, in the order of their places; at most
    /// [`MAX_ERRORS`].
    #[error("{}{}", .0[0], further_errors(.0.len() - 1))]
    Several(Vec<Self>),
}

impl Error {
    /// Error of a program, read from `text`, that names an unknown robot.
    pub(crate) fn unknown_robot(name: &str, reason: impl Into<String>, text: &str) -> Self {
        let place = locate(text, &[JsonStep::Key("robot")]);
        Self::UnknownRobot { name: name.to_owned(), reason: reason.into(), place }
    }

    /// Error of a program, read from `text`, that cannot be planned.
    #[must_use]
    pub fn plan(error: PlanError, sources: &Sources, text: &str) -> Self {
        let message = sources.in_message(&error.to_string());
        let motion = error.motion();
        let place = match &error {
            PlanError::Fault(fault) => Some(fault.place_in(text)),
            _ => motion.map(|motion| locate(text, &motion_path(text, motion))),
        };
        Self::Plan { message, place, motion, error: Box::new(error) }
    }

    /// All errors of the program `text`, the first of which is `first`.
    pub(crate) fn of_text(first: ProgramError, text: &str) -> Self {
        Self::several(Program::all_errors(text, first).into_iter().map(Self::Program))
    }

    /// All errors of a program, read from `text`, whose path cannot be built for `robot` because of
    /// the fault `first`.
    pub(crate) fn of_path(first: Fault, program: &Program, robot: &Robot, text: &str) -> Self {
        let mut faults = vec![first];
        faults.extend(program.faults(robot));
        faults.sort_by_key(|fault| fault.motion().map(MotionIndex::index));
        // The first fault is among the others.
        faults.truncate(MAX_ERRORS + 1);
        let plan = |fault: Fault| Self::plan(fault.into(), &program.sources, text);
        let mut errors: Vec<Self> = faults.into_iter().map(plan).collect();
        // An unknown name may be in use several times.
        let mut places = BTreeSet::new();
        errors.retain(|error| error.place().is_none_or(|it| places.insert(it.span.start)));
        errors.truncate(MAX_ERRORS);
        Self::several(errors)
    }

    /// Several errors, or a single one.
    pub(crate) fn several(errors: impl IntoIterator<Item = Self>) -> Self {
        let mut errors = Vec::from_iter(errors);
        if errors.len() == 1 { errors.remove(0) } else { Self::Several(errors) }
    }

    /// The independent errors: this one, or those of [`Several`](Self::Several).
    #[must_use]
    pub fn errors(&self) -> &[Self] {
        match self {
            Self::Several(errors) => errors,
            error => slice::from_ref(error),
        }
    }

    /// Error message without the place.
    #[must_use]
    pub fn message(&self) -> String {
        match self {
            Self::File { .. } | Self::Profile { .. } => self.to_string(),
            Self::Program(error) => error.message(),
            Self::UnknownRobot { name, reason, .. } => unknown_robot(name, reason),
            Self::Plan { message, .. } => message.clone(),
            Self::Several(errors) => {
                format!("{}{}", errors[0].message(), further_errors(errors.len() - 1))
            }
        }
    }

    /// Place in the program's text; `None` for an unreadable file or an error in the robot's
    /// profile.
    #[must_use]
    pub fn place(&self) -> Option<&JsonPlace> {
        match self {
            Self::File { .. } | Self::Profile { .. } => None,
            Self::Program(error) => Some(error.place()),
            Self::UnknownRobot { place, .. } => Some(place),
            Self::Plan { place, .. } => place.as_ref(),
            Self::Several(errors) => errors[0].place(),
        }
    }

    /// Motion at fault, if any.
    #[must_use]
    pub fn motion(&self) -> Option<MotionIndex> {
        match self {
            Self::File { .. } | Self::UnknownRobot { .. } | Self::Profile { .. } => None,
            Self::Program(error) => error.motion(),
            Self::Plan { motion, .. } => *motion,
            Self::Several(errors) => errors[0].motion(),
        }
    }

    /// Returns true if the planning was interrupted.
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
