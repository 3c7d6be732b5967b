//! The signs of the joints.

use std::fmt;

use crate::Joints;

/// Sunrise's turn: bit i - 1 is set where joint Ai is negative, 0 to 127.
///
/// No joint of the LBR iiwa turns as far as 180 deg, so that position of A3 and status say all; the turn
/// is a check of them.
///
/// ```
/// use iiwa_kin::Turn;
///
/// assert_eq!(Turn::of(&[0.1, -0.2, 0.0, -1.0, 0.0, 0.5, 0.0]).bits(), 0b000_1010);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Turn(u8);

impl Turn {
    /// The turn of seven bits; `None` above 127.
    #[must_use]
    pub const fn new(bits: u8) -> Option<Self> {
        if bits < 128 { Some(Self(bits)) } else { None }
    }

    /// The bits, 0 to 127.
    #[must_use]
    pub const fn bits(self) -> u8 {
        self.0
    }

    /// The turn of the arm at `joints_rad`.
    #[must_use]
    pub fn of(joints_rad: &Joints) -> Self {
        Self(joints_rad.iter().rev().fold(0, |bits, q| bits << 1 | u8::from(*q < 0.0)))
    }

    /// Whether it matches the signs of `joints_rad`. Joints within 0.0001 rad of zero match either sign: theirs depends on
    /// rounding and on how the frame was taught.
    ///
    /// ```
    /// use iiwa_kin::Turn;
    ///
    /// let turn = Turn::of(&[0.0, 0.5, -1e-7, -1.0, 0.0, 1.5, 0.0]);
    /// assert!(turn.agrees_with(&[0.0, 0.5, 1e-7, -1.0, 0.0, 1.5, 0.0]));
    /// assert!(!turn.agrees_with(&[0.0, 0.5, 1e-7, 1.0, 0.0, 1.5, 0.0]));
    /// ```
    #[must_use]
    pub fn agrees_with(self, joints_rad: &Joints) -> bool {
        const NEAR_ZERO_RAD: f64 = 1e-4;
        joints_rad
            .iter()
            .enumerate()
            .all(|(joint, q)| q.abs() <= NEAR_ZERO_RAD || (*q < 0.0) == (self.0 >> joint & 1 == 1))
    }
}

impl fmt::Display for Turn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}
