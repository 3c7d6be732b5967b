//! Errors of reading a scene.

use iiwa_json::{JsonPlace, element_at, problem};

use crate::fault::SceneFault;

/// Supported version of the scene format.
pub(super) const VERSION: u64 = 1;

/// Error of reading a scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The text is not JSON, or not the expected JSON.
    #[error("{}{message}, at {place}", prefix(*.obstacle))]
    Json {
        /// Found and expected contents.
        message: String,
        /// Index of the obstacle, from 0, if the fault is in one.
        obstacle: Option<usize>,
        /// Place in the text.
        place: JsonPlace,
    },
    /// The scene has another version.
    #[error("this is a scene of version {found}; version {VERSION} is understood, at {place}")]
    Version {
        /// Version of the scene.
        found: u64,
        /// Place in the text.
        place: JsonPlace,
    },
    /// The scene is well-formed but invalid.
    #[error("{fault}, at {place}")]
    Fault {
        /// Fault.
        fault: SceneFault,
        /// Place in the text.
        place: JsonPlace,
    },
}

impl SceneError {
    /// Returns the place in the text.
    #[must_use]
    pub fn place(&self) -> &JsonPlace {
        match self {
            Self::Json { place, .. } | Self::Version { place, .. } | Self::Fault { place, .. } => {
                place
            }
        }
    }

    /// Returns the message without the place.
    #[must_use]
    pub fn message(&self) -> String {
        match self {
            Self::Json { message, obstacle, .. } => format!("{}{message}", prefix(*obstacle)),
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

/// Creates the error of a JSON fault in a part of the text.
pub(super) fn json_error(
    text: &str,
    part: &str,
    obstacle: Option<usize>,
    error: &serde_json::Error,
) -> SceneError {
    let place = JsonPlace::of_error(text, part, error);
    // Text that is not JSON at all is detected before it is divided into parts.
    let obstacle = obstacle.or_else(|| element_at(text, "obstacles", place.span.start));
    SceneError::Json { message: problem(error), obstacle, place }
}
