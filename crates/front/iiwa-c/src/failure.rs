//! Why a call failed.

use iiwa_kin::ProfileError;
use iiwa_plan::Error;
use iiwa_program::MotionIndex;

/// What kind of failure it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FailureKind {
    /// An argument is missing or out of range.
    Argument,
    /// A file cannot be read.
    File,
    /// The program or the robot's profile is not valid.
    Program,
    /// The robot cannot do what the program asks for.
    Plan,
    /// A fault of this library.
    Internal,
}

/// Why a call failed, with its place in the program's text where that is known.
#[derive(Clone, Debug)]
pub(crate) struct Failure {
    pub(crate) kind: FailureKind,
    pub(crate) message: String,
    /// Line and column, from 1.
    pub(crate) place: Option<(usize, usize)>,
    pub(crate) motion: Option<MotionIndex>,
}

impl Failure {
    pub(crate) fn new(kind: FailureKind, message: impl Into<String>) -> Self {
        Self { kind, message: message.into(), place: None, motion: None }
    }

    pub(crate) fn argument(message: impl Into<String>) -> Self {
        Self::new(FailureKind::Argument, message)
    }

    /// A text that is no profile; the place is one in that text.
    pub(crate) fn profile(error: &ProfileError) -> Self {
        let place = error.place();
        let failure = Self::new(FailureKind::Program, format!("the robot's profile: {error}"));
        Self { place: Some((place.line, place.column)), ..failure }
    }
}

/// A program that cannot be read or planned.
impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let kind = match &error {
            Error::File { .. } => FailureKind::File,
            Error::Plan { .. } => FailureKind::Plan,
            // The place is one in the profile, as where the profile is given.
            Error::Profile { error, .. } => return Self::profile(error),
            _ => FailureKind::Program,
        };
        let place = error.place().map(|place| (place.line, place.column));
        Self { place, motion: error.motion(), ..Self::new(kind, error.to_string()) }
    }
}
