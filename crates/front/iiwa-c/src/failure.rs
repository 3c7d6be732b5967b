//! Failures of calls.

use iiwa_kin::ProfileError;
use iiwa_plan::Error;
use iiwa_program::MotionIndex;

/// Kind of failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FailureKind {
    /// An argument is missing or out of range.
    Argument,
    /// A file cannot be read.
    File,
    /// The program or the robot's profile is invalid.
    Program,
    /// The robot cannot perform the program.
    Plan,
    /// A fault of this library.
    Internal,
}

/// Reason for a failed call, with its place in the program's text if known.
#[derive(Clone, Debug)]
pub(crate) struct CallFailure {
    pub(crate) kind: FailureKind,
    pub(crate) message: String,
    /// Line and column, from 1.
    pub(crate) place: Option<(usize, usize)>,
    pub(crate) motion: Option<MotionIndex>,
}

impl CallFailure {
    pub(crate) fn new(kind: FailureKind, message: impl Into<String>) -> Self {
        Self { kind, message: message.into(), place: None, motion: None }
    }

    pub(crate) fn argument(message: impl Into<String>) -> Self {
        Self::new(FailureKind::Argument, message)
    }

    /// Creates the failure of an invalid profile; the place refers to the profile's text.
    pub(crate) fn profile(error: &ProfileError) -> Self {
        let place = error.place();
        let failure = Self::new(FailureKind::Program, format!("the robot's profile: {error}"));
        Self { place: Some((place.line, place.column)), ..failure }
    }
}

/// Failure of a program that cannot be read or planned.
impl From<Error> for CallFailure {
    fn from(error: Error) -> Self {
        let kind = match &error {
            Error::File { .. } => FailureKind::File,
            Error::Plan { .. } => FailureKind::Plan,
            // The place refers to the profile, as for a profile given directly.
            Error::Profile { error, .. } => return Self::profile(error),
            _ => FailureKind::Program,
        };
        let place = error.place().map(|place| (place.line, place.column));
        Self { place, motion: error.motion(), ..Self::new(kind, error.to_string()) }
    }
}
