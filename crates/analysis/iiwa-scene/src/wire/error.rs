//! What can be wrong with a text that should be a scene.

use iiwa_json::{Place, element_at, problem};

use crate::fault::Fault;

/// The version of the scene format that this library reads.
pub(super) const VERSION: u64 = 1;

/// Why a text is no scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The text is not JSON, or not the JSON that is asked for.
    #[error("{}{what}, at {place}", prefix(*.obstacle))]
    Json {
        /// What was found, and what was expected.
        what: String,
        /// The obstacle, from 0, if it is in one.
        obstacle: Option<usize>,
        /// Where.
        place: Place,
    },
    /// The scene is of another version.
    #[error("this is a scene of version {found}; version {VERSION} is understood, at {place}")]
    Version {
        /// The version found.
        found: u64,
        /// Where.
        place: Place,
    },
    /// The scene is well-formed and cannot be.
    #[error("{fault}, at {place}")]
    Fault {
        /// What is wrong.
        fault: Fault,
        /// Where.
        place: Place,
    },
}

impl SceneError {
    /// Where in the text.
    #[must_use]
    pub fn place(&self) -> &Place {
        match self {
            Self::Json { place, .. } | Self::Version { place, .. } | Self::Fault { place, .. } => {
                place
            }
        }
    }

    /// What is wrong, without the place.
    #[must_use]
    pub fn what(&self) -> String {
        match self {
            Self::Json { what, obstacle, .. } => format!("{}{what}", prefix(*obstacle)),
            Self::Version { found, .. } => {
                format!("this is a scene of version {found}; version {VERSION} is understood")
            }
            Self::Fault { fault, .. } => fault.to_string(),
        }
    }
}

fn prefix(obstacle: Option<usize>) -> String {
    obstacle.map_or_else(String::new, |index| format!("obstacle {}: ", index + 1))
}

/// A fault of the JSON in a part of the text.
pub(super) fn json_error(
    text: &str,
    part: &str,
    obstacle: Option<usize>,
    error: &serde_json::Error,
) -> SceneError {
    let place = Place::of_error(text, part, error);
    // What is no JSON at all is found before the text is taken apart.
    let obstacle = obstacle.or_else(|| element_at(text, "obstacles", place.span.start));
    SceneError::Json { what: problem(error), obstacle, place }
}
