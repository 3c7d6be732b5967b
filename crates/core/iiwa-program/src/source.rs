//! Where the motions of a program come from.

use std::{
    collections::BTreeMap,
    fmt::{self, Write as _},
};

use crate::motion_index::MotionIndex;

/// The line that a motion was made from, where a program was made from another one, such as a robot application in Java.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The file's name, as people know it.
    pub file: String,
    /// The line, from 1.
    pub line: u32,
}

/// As compilers write it: `Welding.java:84`.
impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, line } = self;
        write!(f, "{file}:{line}")
    }
}

/// The sources of a program's motions, as far as they are known.
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
    /// The source of a motion, if it is known.
    #[must_use]
    pub fn of(&self, motion: MotionIndex) -> Option<&Source> {
        self.0.get(&motion)
    }

    /// Sets the source of a motion.
    pub fn insert(&mut self, motion: MotionIndex, source: Source) {
        self.0.insert(motion, source);
    }

    /// Whether no source is known.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The known sources, in the order of the motions.
    pub fn iter(&self) -> impl Iterator<Item = (MotionIndex, &Source)> {
        self.0.iter().map(|(motion, source)| (*motion, source))
    }

    /// A message with the source behind each motion that it names by its number: `motion 4 (Welding.java:84)`.
    #[must_use]
    pub fn in_message(&self, message: &str) -> String {
        const WORD: &str = "motion ";
        let mut told = String::with_capacity(message.len());
        let mut rest = message;
        while let Some(at) = rest.find(WORD) {
            let number = &rest[at + WORD.len()..];
            let digits =
                number.len() - number.trim_start_matches(|c: char| c.is_ascii_digit()).len();
            let (before, after) = rest.split_at(at + WORD.len() + digits);
            told.push_str(before);
            let motion = number[..digits].parse().ok().and_then(MotionIndex::from_number);
            if let Some(source) = motion.and_then(|motion| self.of(motion)) {
                // A text takes whatever is written to it.
                let _ = write!(told, " ({source})");
            }
            rest = after;
        }
        told.push_str(rest);
        told
    }
}

impl FromIterator<(MotionIndex, Source)> for Sources {
    fn from_iter<I: IntoIterator<Item = (MotionIndex, Source)>>(sources: I) -> Self {
        Self(sources.into_iter().collect())
    }
}
