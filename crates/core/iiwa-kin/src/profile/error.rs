//! Why a text is no robot profile.

use iiwa_json::Place;

use super::bounds::{KAPPA, LINKS, MASSES, MAX_BYTES, MAX_NAME, RANGES, VERSION};
use crate::Robot;

/// Why a text is no robot profile.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProfileError {
    /// The text is not JSON, or not the JSON that is asked for.
    #[error("{problem}, at {at}")]
    Json {
        /// Where.
        at: Place,
        /// What was found, and what was expected.
        problem: String,
    },
    /// The text is too long to be a profile.
    #[error("this is {found} bytes long; a robot profile has at most {MAX_BYTES}, at {at}")]
    TooLong {
        /// Where: the start of the text.
        at: Place,
        /// Its length in bytes.
        found: usize,
    },
    /// The profile is of another version.
    #[error("this is a robot profile of version {found}; write version {VERSION}, at {at}")]
    Version {
        /// Where.
        at: Place,
        /// The version found.
        found: u64,
    },
    /// The profile builds on a model that is not built in.
    #[error("no built-in model is called {found:?}; choose one of {}, at {at}", Robot::BUILT_IN.join(", "))]
    UnknownBase {
        /// Where.
        at: Place,
        /// The name found.
        found: String,
    },
    /// The name is empty, too long or has control characters.
    #[error(
        "the name {found:?} cannot be used; write 1 to {MAX_NAME} characters, none of them a \
         control character, at {at}"
    )]
    Name {
        /// Where.
        at: Place,
        /// The name found.
        found: String,
    },
    /// A list has too many or too few entries.
    #[error(
        "{key} has {found} {}; write {expected}, {}, at {at}",
        if *.key == LINKS { "entries" } else { "numbers" }, owner(.key)
    )]
    Count {
        /// Where.
        at: Place,
        /// The list.
        key: &'static str,
        /// How many numbers it has.
        found: usize,
        /// How many it must have.
        expected: usize,
    },
    /// Two keys say the same thing.
    #[error("both {} and {} are given; keep one of them, at {at}", .keys[0], .keys[1])]
    Both {
        /// Where: the second of them.
        at: Place,
        /// The keys.
        keys: [&'static str; 2],
    },
    /// The inertia of a link is that of no body.
    #[error(
        "{LINKS}: the inertia of link {link} is that of no body: about some axis it is negative, at {at}"
    )]
    Inertia {
        /// Where.
        at: Place,
        /// The link, from 1.
        link: usize,
    },
    /// A mass that is given twice is not the same.
    #[error(
        "{MASSES}: link {link} is {found:?}, and {of_links:?} in {LINKS}; keep one of the keys, at {at}"
    )]
    Masses {
        /// Where.
        at: Place,
        /// The link, from 1.
        link: usize,
        /// Its mass in `link_mass_kg`, in kg.
        found: f64,
        /// Its mass in `links`, in kg.
        of_links: f64,
    },
    /// A number is outside its range.
    #[error("{what} is {found:?}; it must be at least {min:?} and at most {max:?}, at {at}")]
    Range {
        /// Where.
        at: Place,
        /// The key, and the place in a list.
        what: String,
        /// What it is.
        found: f64,
        /// The least that it may be.
        min: f64,
        /// The most that it may be.
        max: f64,
    },
    /// A number is not above 0, or too large.
    #[error("{what} is {found:?}; it must be above 0 and at most {max:?}, at {at}")]
    Number {
        /// Where.
        at: Place,
        /// The key, and the joint (from 1) or the link (from 0).
        what: String,
        /// What it is, in the key's unit.
        found: f64,
        /// What it may be, in the key's unit.
        max: f64,
    },
}

impl ProfileError {
    /// Where in the text.
    #[must_use]
    pub fn place(&self) -> &Place {
        match self {
            Self::Json { at, .. }
            | Self::TooLong { at, .. }
            | Self::Version { at, .. }
            | Self::UnknownBase { at, .. }
            | Self::Name { at, .. }
            | Self::Count { at, .. }
            | Self::Both { at, .. }
            | Self::Inertia { at, .. }
            | Self::Masses { at, .. }
            | Self::Range { at, .. }
            | Self::Number { at, .. } => at,
        }
    }

    /// What is wrong, without the place.
    #[must_use]
    pub fn what(&self) -> String {
        self.place().cut_from(&self.to_string())
    }
}

/// What the numbers of the list `key` belong to.
fn owner(key: &str) -> &'static str {
    match key {
        LINKS => "links 1 to 7",
        MASSES => "one for each link, the base included",
        KAPPA => "the constant first, then the factors of gamma and gamma^2",
        RANGES => "one pair for each joint",
        _ => "one for each joint",
    }
}
