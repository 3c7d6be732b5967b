//! Errors of program texts.

use iiwa_json::{JsonPlace, Unread, element_at, excerpt, problem, repeated_key};

use crate::{fault::Fault, motion_index::MotionIndex, source::Sources};

/// Version of the program format that this library reads.
pub(super) const VERSION: u64 = 1;

/// Error: a text cannot be read as a motion program.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ProgramError {
    /// The text is not JSON, or does not have the structure of a program.
    #[error("{}{message}, at {place}", motion_prefix(*.motion, .sources))]
    Json {
        /// Description of the found and the expected text.
        message: String,
        /// Motion index, if the error is in a motion.
        motion: Option<MotionIndex>,
        /// Known source and name of the motion.
        sources: Sources,
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
        /// Known sources and names of the motions.
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
            Self::Json { message, motion, sources, .. } => {
                format!("{}{message}", motion_prefix(*motion, sources))
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

    /// Adds source and name of the motion.
    pub(super) fn with_sources(self, sources: Sources) -> Self {
        match self {
            Self::Json { message, motion, place, .. } => {
                Self::Json { message, motion, sources, place }
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

fn motion_prefix(motion: Option<MotionIndex>, sources: &Sources) -> String {
    let prefix = |motion| format!("motion {motion}{}: ", sources.suffix(motion));
    motion.map(prefix).unwrap_or_default()
}

/// Error of a part of a text that cannot be read.
pub(super) fn json_error(
    text: &str,
    part: &str,
    motion: Option<MotionIndex>,
    error: &serde_json::Error,
) -> ProgramError {
    let mut place = JsonPlace::of_error(text, part, error);
    // A JSON syntax error is found before the text is split into motions. In or after a repeat
    // block, the motion number is unknown.
    let before = &text[..place.span.start];
    let element = || element_at(text, "motions", place.span.start).map(MotionIndex::new);
    let motion = motion.or_else(|| element().filter(|_| !before.contains("\"repeat\"")));
    let at_place = &text[place.span.start..];
    let message = match problem(error) {
        _ if error.is_syntax() && ["//", "/*", "#"].iter().any(|it| at_place.starts_with(it)) => {
            "comments are not part of JSON; remove the comment".to_owned()
        }
        // A tool has its mass within its load.
        message if message.starts_with("unknown key `mass") && message.contains("`load`") => {
            let (unknown, _) = message.split_once(", ").unwrap_or((&message, ""));
            format!("{unknown}; did you mean `load.mass_kg`?")
        }
        message if message.ends_with(" appears twice") => {
            match repeated_key(text, place.span.start) {
                Some([first, second]) => {
                    place = second;
                    format!("{message}, first at {first}")
                }
                None => message,
            }
        }
        message => message,
    };
    ProgramError::Json { message, motion, sources: Sources::default(), place }
}
