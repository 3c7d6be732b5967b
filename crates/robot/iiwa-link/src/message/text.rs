//! JSON and text for messages.

use std::fmt;

use iiwa_json::{JsonObject, JsonPlace, problem};
use serde::{Serialize, de::DeserializeOwned};

use crate::message::refusal::Refusal;

/// Returns a value as JSON; empty if it has map keys that are not strings, which do not occur in
/// messages.
#[must_use]
pub fn to_json(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

/// Parses a message of another iiwasim program; `None` if it is malformed.
#[must_use]
pub fn from_json<T: DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    serde_json::from_slice::<JsonObject<T>>(bytes).ok().map(|JsonObject(message)| message)
}

/// Creates a refusal of a malformed request, with the fault and its position.
#[must_use]
pub fn bad_json(text: &str, error: &serde_json::Error) -> Refusal {
    Refusal::bad(format!("{}, at {}", problem(error), JsonPlace::of_error(text, text, error)))
}

/// Returns the beginning of an external text, for messages; characters other than printable ASCII
/// are escaped.
#[must_use]
pub fn shortened(text: &str) -> String {
    const MAX_CHARS: usize = 60;
    let mut shown = String::new();
    for letter in text.chars() {
        // Escaped text is ASCII: its bytes are its characters.
        if shown.len() >= MAX_CHARS {
            shown.push_str("...");
            break;
        }
        shown.extend(letter.escape_default());
    }
    shown
}

/// A number in messages, with the given number of decimals; large numbers in scientific notation.
pub struct Figures(pub f64, pub usize);

impl fmt::Display for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value, decimals) = self;
        if value.abs() < 1e9 { write!(f, "{value:.decimals$}") } else { write!(f, "{value:.3e}") }
    }
}
