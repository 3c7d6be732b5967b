//! JSON, and pieces of text in messages.

use std::fmt;

use iiwa_json::{Object, Place, problem};
use serde::{Serialize, de::DeserializeOwned};

use super::Refusal;

/// A value as JSON. Only a map with keys that are no strings could fail.
pub fn to_json(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

/// A message that was sent by another program of ours; none if it is not what it should be.
pub fn from_json<T: DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    serde_json::from_slice::<Object<T>>(bytes).ok().map(|Object(message)| message)
}

/// Why a text is not the JSON that is asked for, and where.
pub fn bad_json(text: &str, error: &serde_json::Error) -> Refusal {
    Refusal::bad(format!("{}, at {}", problem(error), Place::of_error(text, text, error)))
}

/// The beginning of somebody's text, for messages; what is not ASCII is escaped.
pub fn shortened(text: &str) -> String {
    const MOST: usize = 60;
    let mut shown = String::new();
    for letter in text.chars() {
        if shown.len() >= MOST {
            shown.push_str("...");
            break;
        }
        shown.extend(letter.escape_default());
    }
    shown
}

/// A number in messages, with so many decimals; one of many digits with a power of ten.
pub struct Figures(pub f64, pub usize);

impl fmt::Display for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value, decimals) = self;
        if value.abs() < 1e9 { write!(f, "{value:.decimals$}") } else { write!(f, "{value:.3e}") }
    }
}
