//! What can be wrong with a program's text.

use iiwa_json::{Place, Unread, element_at, excerpt, problem};

use crate::{fault::Fault, motion_index::MotionIndex};

/// The version of the program format that this library reads.
pub(super) const VERSION: u64 = 1;

/// Why a text cannot be read as a motion program.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ProgramError {
    /// The text is not JSON, or not the JSON that is asked for.
    #[error("{}{what}, at {place}", motion_prefix(*.motion))]
    Json {
        /// What was found, and what was expected.
        what: String,
        /// The motion, if it is in one.
        motion: Option<MotionIndex>,
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
    #[error("{fault}, at {place}")]
    Fault {
        /// What is wrong.
        fault: Fault,
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

    /// What is wrong, without the place.
    #[must_use]
    pub fn what(&self) -> String {
        match self {
            Self::Json { what, motion, .. } => format!("{}{what}", motion_prefix(*motion)),
            Self::Version { found, .. } => {
                format!("this is a program of version {found}; version {VERSION} is understood")
            }
            Self::Include { name, what, .. } => {
                format!("cannot include `{}`: {what}", excerpt(name))
            }
            Self::Included { name, error, .. } => format!("`{}`: {error}", excerpt(name)),
            Self::Fault { fault, .. } => fault.to_string(),
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

fn motion_prefix(motion: Option<MotionIndex>) -> String {
    motion.map_or_else(String::new, |motion| format!("motion {motion}: "))
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
    ProgramError::Json { what: problem(error), motion, place }
}
