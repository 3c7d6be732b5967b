//! Signs of the joint positions.

use std::fmt;

use crate::Joints;

/// Sunrise's turn: bit i - 1 is set if joint Ai is negative, 0 to 127.
///
/// No joint of the LBR iiwa reaches 180 deg, so the position of A3 and the status are sufficient;
/// the turn serves as a check.
///
/// ```
/// use iiwa_kin::Turn;
///
/// assert_eq!(Turn::of(&[0.1, -0.2, 0.0, -1.0, 0.0, 0.5, 0.0]).bits(), 0b000_1010);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Turn(u8);

impl Turn {
    /// Turn with these bits; `None` above 127.
    #[must_use]
    pub const fn new(bits: u8) -> Option<Self> {
        if bits < 128 { Some(Self(bits)) } else { None }
    }

    /// The bits, 0 to 127.
    #[must_use]
    pub const fn bits(self) -> u8 {
        self.0
    }

    /// Turn at `joints_rad`.
    #[must_use]
    pub fn of(joints_rad: &Joints) -> Self {
        Self(joints_rad.iter().rev().fold(0, |bits, q| bits << 1 | u8::from(*q < 0.0)))
    }

    /// Returns true if the turn matches the signs of `joints_rad`. Joints within 0.0001 rad of zero
    /// match either sign, because the sign then depends on rounding and on how the frame was
    /// taught.
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
