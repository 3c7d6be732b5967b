//! What an export cannot say in Java.

use std::fmt;

use iiwa_program::{Fault, MotionIndex, NameFault};

/// Why a program is not exported.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The program has a fault.
    #[error(transparent)]
    Fault(Box<Fault>),
    /// A tool, a base or a frame is not there.
    #[error("{}`{key}`: {fault}", of(.motion.as_ref()))]
    Name {
        /// The motion that names it; none if it is the program.
        motion: Option<MotionIndex>,
        /// The key.
        key: &'static str,
        /// What is wrong.
        fault: NameFault,
    },
    /// Sunrise has no call for it, or none that is known to mean the same.
    #[error("{}`{key}`: {why}", of(Some(motion)))]
    NotInSunrise {
        /// The motion.
        motion: MotionIndex,
        /// Its key.
        key: &'static str,
        /// Why not.
        why: &'static str,
    },
    /// The name that was chosen for the class is none.
    #[error("{found:?} cannot be the name of a class: {why}")]
    ClassName {
        /// The name.
        found: String,
        /// Why not.
        why: &'static str,
    },
}

fn of(motion: Option<&MotionIndex>) -> String {
    motion.map(|motion| format!("motion {motion}: ")).unwrap_or_default()
}

impl From<Fault> for ExportError {
    fn from(fault: Fault) -> Self {
        Self::Fault(Box::new(fault))
    }
}

/// Something of a program that its Java says otherwise, or not at all, while the arm moves as planned.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExportNotice {
    /// The motion; none if it is of the program as a whole.
    pub motion: Option<MotionIndex>,
    /// The key of the program.
    pub key: &'static str,
    /// What became of it.
    pub what: String,
}

impl fmt::Display for ExportNotice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}`{}`: {}", of(self.motion.as_ref()), self.key, self.what)
    }
}
