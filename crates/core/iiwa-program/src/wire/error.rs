//! What can be wrong with a program's text.

use iiwa_json::{Place, Unread, element_at, excerpt, problem};

use crate::{
    fault::Fault,
    motion_index::MotionIndex,
    source::{Source, Sources},
};

/// The version of the program format that this library reads.
pub(super) const VERSION: u64 = 1;

/// Why a text cannot be read as a motion program.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ProgramError {
    /// The text is not JSON, or not the JSON that is asked for.
    #[error("{}{what}, at {place}", motion_prefix(*.motion, .made_from.as_ref()))]
    Json {
        /// What was found, and what was expected.
        what: String,
        /// The motion, if it is in one.
        motion: Option<MotionIndex>,
        /// What the motion was made from, if that is known.
        made_from: Option<Source>,
        /// Where.
        place: Place,
    },
    /// The program is of another version.
    #[error("this is a program of version {found}; version {VERSION} is understood, at {place}")]
    Version {
        /// The version found.
        found: u64,
        /// Where.
        place: Place,
    },
    /// The file that it includes cannot be read.
    #[error("cannot include `{}`: {what}, at {place}", excerpt(.name))]
    Include {
        /// The file.
        name: String,
        /// Why.
        what: String,
        /// Where the program names it.
        place: Place,
    },
    /// Something is wrong within the file that it includes.
    #[error("`{}`, included at {place}: {error}", excerpt(.name))]
    Included {
        /// The file.
        name: String,
        /// Its text.
        text: String,
        /// What is wrong, with its place in that text.
        error: Box<ProgramError>,
        /// Where the program names the file.
        place: Place,
    },
    /// The program is well-formed and asks for something impossible.
    #[error("{}, at {place}", .sources.in_message(&.fault.to_string()))]
    Fault {
        /// What is wrong.
        fault: Fault,
        /// What the motions were made from, as far as that is known.
        sources: Sources,
        /// Where.
        place: Place,
    },
}

impl ProgramError {
    /// Where in the program's text.
    #[must_use]
    pub fn place(&self) -> &Place {
        match self {
            Self::Json { place, .. }
            | Self::Version { place, .. }
            | Self::Include { place, .. }
            | Self::Included { place, .. }
            | Self::Fault { place, .. } => place,
        }
    }

    /// The motion at fault, if it is one.
    #[must_use]
    pub fn motion(&self) -> Option<MotionIndex> {
        match self {
            Self::Json { motion, .. } => *motion,
            Self::Fault { fault, .. } => fault.motion(),
            Self::Version { .. } | Self::Include { .. } | Self::Included { .. } => None,
        }
    }

    /// What is wrong, without the place.
    #[must_use]
    pub fn what(&self) -> String {
        match self {
            Self::Json { what, motion, made_from, .. } => {
                format!("{}{what}", motion_prefix(*motion, made_from.as_ref()))
            }
            Self::Version { found, .. } => {
                format!("this is a program of version {found}; version {VERSION} is understood")
            }
            Self::Include { name, what, .. } => {
                format!("cannot include `{}`: {what}", excerpt(name))
            }
            Self::Included { name, error, .. } => format!("`{}`: {error}", excerpt(name)),
            Self::Fault { fault, sources, .. } => sources.in_message(&fault.to_string()),
        }
    }

    /// The same of a motion that was made from this.
    pub(super) fn with_source(self, made_from: Option<Source>) -> Self {
        match self {
            Self::Json { what, motion, place, .. } => Self::Json { what, motion, made_from, place },
            other => other,
        }
    }

    /// The error of a text that was not read as a document.
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

/// What is wrong with a part of a text that is not read.
pub(super) fn json_error(
    text: &str,
    part: &str,
    motion: Option<MotionIndex>,
    error: &serde_json::Error,
) -> ProgramError {
    let place = Place::of_error(text, part, error);
    // What is no JSON at all is found before the text is taken apart.
    let motion =
        motion.or_else(|| element_at(text, "motions", place.span.start).map(MotionIndex::new));
    ProgramError::Json { what: problem(error), motion, made_from: None, place }
}
