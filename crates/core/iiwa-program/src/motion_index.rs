//! Index of a motion in a program.

use std::fmt;

/// Index of a motion in a program's motion list.
///
/// Indices start at 0 and motion numbers at 1; this type keeps the two apart. It is displayed as a
/// number.
///
/// ```
/// use iiwa_program::MotionIndex;
///
/// let first = MotionIndex::new(0);
/// assert_eq!(format!("motion {first}"), "motion 1");
/// assert_eq!(first.next().index(), 1);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MotionIndex(usize);

impl MotionIndex {
    /// Index from a number that starts at 0.
    #[must_use]
    pub const fn new(index: usize) -> Self {
        Self(index)
    }

    /// Index from a motion number that starts at 1; `None` for 0.
    #[must_use]
    pub fn from_number(number: usize) -> Option<Self> {
        number.checked_sub(1).map(Self)
    }

    /// Index in a list, from 0.
    #[must_use]
    pub fn index(self) -> usize {
        self.0
    }

    /// Motion number, from 1.
    #[must_use]
    pub fn number(self) -> usize {
        self.0 + 1
    }

    /// Index of the following motion.
    #[must_use]
    pub fn next(self) -> Self {
        Self(self.0 + 1)
    }
}

impl fmt::Display for MotionIndex {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.number().fmt(f)
    }
}
