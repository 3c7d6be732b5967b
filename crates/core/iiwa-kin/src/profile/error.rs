//! Errors of robot profiles.

use iiwa_json::JsonPlace;

use super::bounds::{KAPPA, LINKS, MASSES, MAX_BYTES, MAX_NAME, RANGES, VERSION};
use crate::Robot;

/// Error: a text is not a valid robot profile.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProfileError {
    /// The text is not JSON, or does not have the structure of a profile.
    #[error("{problem}, at {place}")]
    Json {
        /// Place in the text.
        place: JsonPlace,
        /// Description of the found and the expected text.
        problem: String,
    },
    /// The text is too long to be a profile.
    #[error("this is {found} bytes long; a robot profile has at most {MAX_BYTES}, at {place}")]
    TooLong {
        /// Place in the text: its start.
        place: JsonPlace,
        /// Length found, in bytes.
        found: usize,
    },
    /// The profile has another format version.
    #[error("this is a robot profile of version {found}; write version {VERSION}, at {place}")]
    Version {
        /// Place in the text.
        place: JsonPlace,
        /// Version found.
        found: u64,
    },
    /// The base model is not a built-in model.
    #[error(
        "no built-in model is called {found:?}; choose one of {}, at {place}",
        Robot::BUILT_IN.join(", ")
    )]
    UnknownBase {
        /// Place in the text.
        place: JsonPlace,
        /// Name found.
        found: String,
    },
    /// The name is empty, too long or contains control characters.
    #[error(
        "the name {found:?} cannot be used; write 1 to {MAX_NAME} characters, none of them a \
         control character, at {place}"
    )]
    Name {
        /// Place in the text.
        place: JsonPlace,
        /// Name found.
        found: String,
    },
    /// A list has too many or too few entries.
    #[error(
        "{key} has {found} {}; write {expected}, {}, at {place}",
        if *.key == LINKS { "entries" } else { "numbers" }, owner(.key)
    )]
    Count {
        /// Place in the text.
        place: JsonPlace,
        /// Key of the list.
        key: &'static str,
        /// Number of entries found.
        found: usize,
        /// Number of entries expected.
        expected: usize,
    },
    /// Two mutually exclusive keys are given.
    #[error("both {} and {} are given; keep one of them, at {place}", .keys[0], .keys[1])]
    Both {
        /// Place in the text: the second key.
        place: JsonPlace,
        /// The two keys.
        keys: [&'static str; 2],
    },
    /// The inertia tensor of a link is not physically possible.
    #[error(
        "{LINKS}: the inertia tensor of link {link} is not physically possible: the moment of \
         inertia about some axis is negative, at {place}"
    )]
    Inertia {
        /// Place in the text.
        place: JsonPlace,
        /// Link number, from 1.
        link: usize,
    },
    /// The masses of a link in two keys differ.
    #[error(
        "{MASSES}: link {link} is {found:?}, and {of_links:?} in {LINKS}; keep one of the keys, at \
         {place}"
    )]
    Masses {
        /// Place in the text.
        place: JsonPlace,
        /// Link number, from 1.
        link: usize,
        /// Mass in `link_mass_kg`, in kg.
        found: f64,
        /// Mass in `links`, in kg.
        of_links: f64,
    },
    /// A number is outside its range.
    #[error("{quantity} is {found:?}; it must be at least {min:?} and at most {max:?}, at {place}")]
    Range {
        /// Place in the text.
        place: JsonPlace,
        /// Key, with the place in a list.
        quantity: String,
        /// Number found.
        found: f64,
        /// Smallest accepted number.
        min: f64,
        /// Largest accepted number.
        max: f64,
    },
    /// A number is not above 0, or too large.
    #[error("{quantity} is {found:?}; it must be above 0 and at most {max:?}, at {place}")]
    Number {
        /// Place in the text.
        place: JsonPlace,
        /// Key, with the joint (from 1) or the link (from 0).
        quantity: String,
        /// Number found, in the key's unit.
        found: f64,
        /// Largest accepted number, in the key's unit.
        max: f64,
    },
}

impl ProfileError {
    /// Place of the error in the text.
    #[must_use]
    pub fn place(&self) -> &JsonPlace {
        match self {
            Self::Json { place, .. }
            | Self::TooLong { place, .. }
            | Self::Version { place, .. }
            | Self::UnknownBase { place, .. }
            | Self::Name { place, .. }
            | Self::Count { place, .. }
            | Self::Both { place, .. }
            | Self::Inertia { place, .. }
            | Self::Masses { place, .. }
            | Self::Range { place, .. }
            | Self::Number { place, .. } => place,
        }
    }

    /// Error message without the place.
    #[must_use]
    pub fn message(&self) -> String {
        self.place().cut_from(&self.to_string())
    }
}

/// Description of the entries of the list `key`.
fn owner(key: &str) -> &'static str {
    match key {
        LINKS => "links 1 to 7",
        MASSES => "one for each link, the base included",
        KAPPA => "the constant first, then the factors of gamma and gamma^2",
        RANGES => "one pair for each joint",
        _ => "one for each joint",
    }
}
