//! Documents with a version.

use serde::Deserialize;

use crate::{
    locate::{Step, locate},
    object::Object,
    place::Place,
};

/// Why a text of a format with versions was not read.
#[derive(Debug)]
pub enum Unread {
    /// It is of another version.
    Version {
        /// The version found.
        found: u64,
        /// Where.
        place: Place,
    },
    /// It is not JSON, or not the JSON that is asked for.
    Json(serde_json::Error),
}

/// Reads an object that has to be of a `version`, which is the value of its key `version`; `of` gets it from
/// what was read. Another version may have other keys: that is then the thing to say.
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
        Some(Unread::Version { found, place: locate(text, &[Step::Key("version")]) })
    };
    match serde_json::from_str::<Object<T>>(text) {
        Ok(Object(read)) => other(Some(of(&read))).map_or(Ok(read), Err),
        Err(error) => {
            let only = serde_json::from_str::<Object<VersionOnly>>(text).ok();
            Err(only.and_then(|only| other(only.0.version)).unwrap_or(Unread::Json(error)))
        }
    }
}
