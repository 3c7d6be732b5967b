//! Errors of program texts.

use iiwa_json::{JsonPlace, Unread, element_at, excerpt, problem};

use crate::{
    fault::Fault,
    motion_index::MotionIndex,
    source::{Source, Sources},
};

/// Version of the program format that this library reads.
pub(super) const VERSION: u64 = 1;

/// Error: a text cannot be read as a motion program.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ProgramError {
    /// The text is not JSON, or does not have the structure of a program.
    #[error("{}{message}, at {place}", motion_prefix(*.motion, .made_from.as_ref()))]
    Json {
        /// Description of the found and the expected text.
        message: String,
        /// Motion index, if the error is in a motion.
        motion: Option<MotionIndex>,
        /// Source of the motion, if known.
        made_from: Option<Source>,
        /// Place in the text.
        place: JsonPlace,
    },
    /// The program has another format version.
    #[error("this is a program of version {found}; version {VERSION} is understood, at {place}")]
    Version {
        /// Version found.
        found: u64,
        /// Place in the text.
        place: JsonPlace,
    },
    /// The included file cannot be read.
    #[error("cannot include `{}`: {reason}, at {place}", excerpt(.name))]
    Include {
        /// File name.
        name: String,
        /// Reason.
        reason: String,
        /// Place of the file name in the program.
        place: JsonPlace,
    },
    /// The included file has an error.
    #[error("`{}`, included at {place}: {error}", excerpt(.name))]
    Included {
        /// File name.
        name: String,
        /// Text of the file.
        text: String,
        /// Error, with its place in that text.
        error: Box<ProgramError>,
        /// Place of the file name in the program.
        place: JsonPlace,
    },
    /// The program is well-formed but cannot be planned.
    #[error("{}, at {place}", .sources.in_message(&.fault.to_string()))]
    Fault {
        /// Fault of the program.
        fault: Fault,
        /// Known sources of the motions.
        sources: Sources,
        /// Place in the text.
        place: JsonPlace,
    },
}

impl ProgramError {
    /// Place of the error in the program text.
    #[must_use]
    pub fn place(&self) -> &JsonPlace {
        match self {
            Self::Json { place, .. }
            | Self::Version { place, .. }
            | Self::Include { place, .. }
            | Self::Included { place, .. }
            | Self::Fault { place, .. } => place,
        }
    }

    /// Motion at fault, if any.
    #[must_use]
    pub fn motion(&self) -> Option<MotionIndex> {
        match self {
            Self::Json { motion, .. } => *motion,
            Self::Fault { fault, .. } => fault.motion(),
            Self::Version { .. } | Self::Include { .. } | Self::Included { .. } => None,
        }
    }

    /// Error message without the place.
    #[must_use]
    pub fn message(&self) -> String {
        match self {
            Self::Json { message, motion, made_from, .. } => {
                format!("{}{message}", motion_prefix(*motion, made_from.as_ref()))
            }
            Self::Version { found, .. } => {
                format!("this is a program of version {found}; version {VERSION} is understood")
            }
            Self::Include { name, reason, .. } => {
                format!("cannot include `{}`: {reason}", excerpt(name))
            }
            Self::Included { name, error, .. } => format!("`{}`: {error}", excerpt(name)),
            Self::Fault { fault, sources, .. } => sources.in_message(&fault.to_string()),
        }
    }

    /// Adds the source of the motion.
    pub(super) fn with_source(self, made_from: Option<Source>) -> Self {
        match self {
            Self::Json { message, motion, place, .. } => {
                Self::Json { message, motion, made_from, place }
            }
            other => other,
        }
    }

    /// Error of a text that is not a readable document.
    pub(super) fn unread(text: &str, error: Unread) -> Self {
        match error {
            Unread::Version { found, place } => Self::Version { found, place },
            Unread::Json(error) => json_error(text, text, None, &error),
        }
    }
}

fn motion_prefix(motion: Option<MotionIndex>, source: Option<&Source>) -> String {
    match (motion, source) {
        (None, _) => String::new(),
        (Some(motion), None) => format!("motion {motion}: "),
        (Some(motion), Some(source)) => format!("motion {motion} ({source}): "),
    }
}

/// Error of a part of a text that cannot be read.
pub(super) fn json_error(
    text: &str,
    part: &str,
    motion: Option<MotionIndex>,
    error: &serde_json::Error,
) -> ProgramError {
    let place = JsonPlace::of_error(text, part, error);
    // A JSON syntax error is found before the text is split into motions.
    let motion =
        motion.or_else(|| element_at(text, "motions", place.span.start).map(MotionIndex::new));
    ProgramError::Json { message: problem(error), motion, made_from: None, place }
}
