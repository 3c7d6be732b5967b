//! A motion's place in a program.

use std::fmt;

/// The place of a motion in a program's list.
///
/// Lists count from 0 and people count from 1; this type keeps the two apart. It is displayed as people count.
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
    /// The motion at a place that counts from 0.
    #[must_use]
    pub const fn new(index: usize) -> Self {
        Self(index)
    }

    /// The motion of a number that counts from 1; `None` for 0.
    #[must_use]
    pub fn from_number(number: usize) -> Option<Self> {
        number.checked_sub(1).map(Self)
    }

    /// Its place in a list, from 0.
    #[must_use]
    pub fn index(self) -> usize {
        self.0
    }

    /// Its number, from 1.
    #[must_use]
    pub fn number(self) -> usize {
        self.0 + 1
    }

    /// The motion after it.
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
