//! Why a call failed.

use iiwa_json::{Place, Step, element_at, locate};
use iiwa_kin::ProfileError;
use iiwa_program::{MotionIndex, Program, ProgramError};
use iiwa_traj::{PlanError, TimingError};

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

    /// What is wrong at a place of a program's text.
    pub(crate) fn in_program(
        kind: FailureKind,
        message: String,
        place: &Place,
        text: &str,
    ) -> Self {
        Self {
            kind,
            message,
            place: Some((place.line, place.column)),
            motion: element_at(text, "motions", place.span.start).map(MotionIndex::new),
        }
    }

    /// A text that is no program.
    pub(crate) fn program(error: &ProgramError, text: &str) -> Self {
        Self::in_program(FailureKind::Program, error.to_string(), error.place(), text)
    }

    /// A text that is no profile; the place is one in that text.
    pub(crate) fn profile(error: &ProfileError) -> Self {
        let place = error.place();
        let failure = Self::new(FailureKind::Program, format!("the robot's profile: {error}"));
        Self { place: Some((place.line, place.column)), ..failure }
    }

    /// A program that cannot be planned.
    pub(crate) fn plan(error: &PlanError, program: &Program, text: &str) -> Self {
        let what = program.sources.in_message(&error.to_string());
        let place = match error {
            PlanError::Fault(fault) => fault.place_in(text),
            PlanError::Timing(
                TimingError::LimitExceeded { motion, .. }
                | TimingError::CannotHold { motion, .. }
                | TimingError::CurvatureJumps { motion }
                | TimingError::NotConverged { motion }
                | TimingError::Stuck { motion },
            ) => locate(text, &[Step::Key("motions"), Step::Index(motion.index())]),
            _ => return Self::new(FailureKind::Plan, what),
        };
        Self::in_program(FailureKind::Plan, format!("{what}, at {place}"), &place, text)
    }
}
