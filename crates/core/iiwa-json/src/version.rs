//! Documents with a version.

use serde::Deserialize;

use crate::{
    locate::{JsonStep, locate},
    object::JsonObject,
    place::JsonPlace,
};

/// Error: a text of a versioned format was not read.
#[derive(Debug)]
pub enum Unread {
    /// The text has another version.
    Version {
        /// Version found.
        found: u64,
        /// Place in the text.
        place: JsonPlace,
    },
    /// The text is not JSON, or not the expected JSON.
    Json(serde_json::Error),
}

/// Reads an object of a `version`, given by its key `version`; `of` gets the version from the
/// result. Because another version may have other keys, a wrong version takes precedence over other
/// errors.
///
/// # Errors
///
/// [`Unread`].
pub fn read_version<'a, T: Deserialize<'a>>(
    text: &'a str,
    version: u64,
    of: impl FnOnce(&T) -> u64,
) -> Result<T, Unread> {
    #[derive(Deserialize)]
    struct VersionOnly {
        version: Option<u64>,
    }
    let other = |found: Option<u64>| {
        let found = found.filter(|found| *found != version)?;
        Some(Unread::Version { found, place: locate(text, &[JsonStep::Key("version")]) })
    };
    match serde_json::from_str::<JsonObject<T>>(text) {
        Ok(JsonObject(read)) => other(Some(of(&read))).map_or(Ok(read), Err),
        Err(error) => {
            let only = serde_json::from_str::<JsonObject<VersionOnly>>(text).ok();
            Err(only.and_then(|only| other(only.0.version)).unwrap_or(Unread::Json(error)))
        }
    }
}
