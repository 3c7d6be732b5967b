//! The name of a joint.

use std::fmt;

/// One of the seven joints, named as on the robot: A1 at the base to A7 at the flange.
///
/// Arrays of joints count from 0 and people count from 1; this type keeps the two apart.
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
    /// The first joint: turns the arm about the vertical axis of its base.
    A1,
    /// The second joint.
    A2,
    /// The third joint.
    A3,
    /// The fourth joint, the elbow.
    A4,
    /// The fifth joint.
    A5,
    /// The sixth joint.
    A6,
    /// The seventh joint: turns the flange.
    A7,
}

impl Joint {
    /// All joints, from the base to the flange.
    pub const ALL: [Self; 7] =
        [Self::A1, Self::A2, Self::A3, Self::A4, Self::A5, Self::A6, Self::A7];

    /// Its place in an array of joints, 0 to 6.
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }

    /// Its number, 1 to 7.
    #[must_use]
    pub fn number(self) -> usize {
        self.index() + 1
    }

    /// The joint at a place in an array of joints; `None` from 7 on.
    #[must_use]
    pub fn from_index(index: usize) -> Option<Self> {
        Self::ALL.get(index).copied()
    }

    /// The joint of a number from 1 to 7; `None` for any other.
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
