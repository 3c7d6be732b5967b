//! Errors and notices of an export.

use std::{fmt, slice};

use iiwa_json::further_errors;
use iiwa_program::{Fault, MotionIndex, NameFault};

/// Error of exporting a program.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The program has a fault.
    #[error(transparent)]
    Fault(Box<Fault>),
    /// The tool, base or frame does not exist.
    #[error("{}`{key}`: {fault}", motion_prefix(.motion.as_ref()))]
    Name {
        /// Motion that uses the name; `None` for the whole program.
        motion: Option<MotionIndex>,
        /// Key.
        key: &'static str,
        /// Fault of the name.
        fault: NameFault,
    },
    /// Sunrise has no equivalent call, or none with known equivalent behaviour.
    #[error("{}`{key}`: {why}", motion_prefix(Some(motion)))]
    NotInSunrise {
        /// Motion.
        motion: MotionIndex,
        /// Key of the motion.
        key: &'static str,
        /// Reason.
        why: &'static str,
    },
    /// The class name is not valid.
    #[error("{name:?} cannot be the name of a class: {why}")]
    ClassName {
        /// Class name.
        name: String,
        /// Reason.
        why: &'static str,
    },
    /// Several errors that are independent of each other, in the order of the motions; at most
    /// [`MAX_ERRORS`](iiwa_program::MAX_ERRORS).
    #[error("{}{}", .0[0], further_errors(.0.len() - 1))]
    Several(Vec<Self>),
}

impl ExportError {
    /// The independent errors: this one, or those of [`Several`](Self::Several).
    #[must_use]
    pub fn errors(&self) -> &[Self] {
        match self {
            Self::Several(errors) => errors,
            error => slice::from_ref(error),
        }
    }

    /// Error of a list with at least one error.
    pub(super) fn several(mut errors: Vec<Self>) -> Self {
        if errors.len() == 1 { errors.remove(0) } else { Self::Several(errors) }
    }
}

fn motion_prefix(motion: Option<&MotionIndex>) -> String {
    motion.map(|motion| format!("motion {motion}: ")).unwrap_or_default()
}

impl From<Fault> for ExportError {
    fn from(fault: Fault) -> Self {
        Self::Fault(Box::new(fault))
    }
}

/// Difference between a program and its Java code, while the robot moves as planned.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExportNotice {
    /// Motion; `None` for the whole program.
    pub motion: Option<MotionIndex>,
    /// Key of the program.
    pub key: &'static str,
    /// Description of the difference.
    pub message: String,
}

impl fmt::Display for ExportNotice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}`{}`: {}", motion_prefix(self.motion.as_ref()), self.key, self.message)
    }
}
