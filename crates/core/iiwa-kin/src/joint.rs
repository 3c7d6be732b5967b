//! Joint names.

use std::fmt;

/// One of the seven joints, named as on the robot: A1 at the base to A7 at the flange.
///
/// Array indices start at 0 and joint numbers at 1; this type keeps the two apart.
///
/// ```
/// use iiwa_kin::Joint;
///
/// let degrees = [0.0, 0.0, 0.0, -90.0, 0.0, 0.0, 0.0];
/// assert_eq!(degrees[Joint::A4.index()], -90.0);
/// assert_eq!(Joint::A4.number(), 4);
/// assert_eq!(Joint::A4.to_string(), "A4");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Joint {
    /// First joint: rotates the arm about the vertical axis of its base.
    A1,
    /// Second joint.
    A2,
    /// Third joint.
    A3,
    /// Fourth joint, the elbow.
    A4,
    /// Fifth joint.
    A5,
    /// Sixth joint.
    A6,
    /// Seventh joint: rotates the flange.
    A7,
}

impl Joint {
    /// All joints, from the base to the flange.
    pub const ALL: [Self; 7] =
        [Self::A1, Self::A2, Self::A3, Self::A4, Self::A5, Self::A6, Self::A7];

    /// Index in an array of joints, 0 to 6.
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }

    /// Number, 1 to 7.
    #[must_use]
    pub fn number(self) -> usize {
        self.index() + 1
    }

    /// Joint at an array index; `None` from 7 on.
    #[must_use]
    pub fn from_index(index: usize) -> Option<Self> {
        Self::ALL.get(index).copied()
    }

    /// Joint with a number from 1 to 7; `None` for any other number.
    #[must_use]
    pub fn from_number(number: usize) -> Option<Self> {
        Self::from_index(number.checked_sub(1)?)
    }
}

impl fmt::Display for Joint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "A{}", self.number())
    }
}
