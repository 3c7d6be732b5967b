//! Sources of a program's motions.

use std::{
    collections::BTreeMap,
    fmt::{self, Write as _},
};

use crate::motion_index::MotionIndex;

/// Source line of a motion, for a program generated from another program such as a Java robot
/// application.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// File name, as shown to the user.
    pub file: String,
    /// Line number, from 1.
    pub line: u32,
}

/// Writes `Welding.java:84`, as compilers do.
impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, line } = self;
        write!(f, "{file}:{line}")
    }
}

/// Known sources of a program's motions.
///
/// ```
/// use iiwa_program::{MotionIndex, Source, Sources};
///
/// let mut sources = Sources::default();
/// let fourth = MotionIndex::new(3);
/// sources.insert(fourth, Source { file: "Welding.java".to_owned(), line: 84 });
/// assert_eq!(sources.of(fourth).map(ToString::to_string).as_deref(), Some("Welding.java:84"));
/// let message = sources.in_message("motion 4: joint A4 is at 130 deg");
/// assert_eq!(message, "motion 4 (Welding.java:84): joint A4 is at 130 deg");
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sources(BTreeMap<MotionIndex, Source>);

impl Sources {
    /// Source of a motion, if known.
    #[must_use]
    pub fn of(&self, motion: MotionIndex) -> Option<&Source> {
        self.0.get(&motion)
    }

    /// Sets the source of a motion.
    pub fn insert(&mut self, motion: MotionIndex, source: Source) {
        self.0.insert(motion, source);
    }

    /// Returns true if no source is known.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Known sources, in the order of the motions.
    pub fn iter(&self) -> impl Iterator<Item = (MotionIndex, &Source)> {
        self.0.iter().map(|(motion, source)| (*motion, source))
    }

    /// Adds the source after each motion number in a message: `motion 4 (Welding.java:84)`.
    #[must_use]
    pub fn in_message(&self, message: &str) -> String {
        const WORD: &str = "motion ";
        let mut text = String::with_capacity(message.len());
        let mut rest = message;
        while let Some(offset) = rest.find(WORD) {
            let number = &rest[offset + WORD.len()..];
            let digits =
                number.len() - number.trim_start_matches(|c: char| c.is_ascii_digit()).len();
            let (before, after) = rest.split_at(offset + WORD.len() + digits);
            text.push_str(before);
            let motion = number[..digits].parse().ok().and_then(MotionIndex::from_number);
            if let Some(source) = motion.and_then(|motion| self.of(motion)) {
                // Writing to a string does not fail.
                let _ = write!(text, " ({source})");
            }
            rest = after;
        }
        text.push_str(rest);
        text
    }
}

impl FromIterator<(MotionIndex, Source)> for Sources {
    fn from_iter<I: IntoIterator<Item = (MotionIndex, Source)>>(sources: I) -> Self {
        Self(sources.into_iter().collect())
    }
}
