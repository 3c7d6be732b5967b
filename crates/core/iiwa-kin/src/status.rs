//! Arm configuration among the eight that reach one pose.

use std::fmt;

use crate::{Joints, Robot};

/// Sunrise's status: selects one of the up to eight sets of joint positions that reach a pose with
/// a given position of joint A3. Three bits, 0 to 7; zero counts as not negative.
///
/// | bit | set where |
/// |---|---|
/// | 0 | the wrist is behind joint A1: its x in the frame that A1 turns is negative (the arm reaches over its head) |
/// | 1 | A4 is negative |
/// | 2 | A6 is negative |
///
/// Bit 0 is KUKA's rule for its robots. That it applies to Sunrise, too, is inferred from 1472
/// frames taught on Sunrise controllers, for all of which it holds.
///
/// ```
/// use iiwa_kin::{Robot, Status};
///
/// let degrees = [0.0, 30.0, 0.0, -60.0, 0.0, 90.0, 0.0];
/// let status = Status::of(&Robot::lbr_iiwa_7_r800(), &degrees.map(f64::to_radians));
/// assert_eq!(Some(status), Status::new(0b010));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Status(u8);

impl Status {
    /// Status with these bits; `None` above 7.
    #[must_use]
    pub const fn new(bits: u8) -> Option<Self> {
        if bits < 8 { Some(Self(bits)) } else { None }
    }

    /// All eight statuses.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..8).map(Self)
    }

    /// The bits, 0 to 7.
    #[must_use]
    pub const fn bits(self) -> u8 {
        self.0
    }

    /// Status at `joints_rad`.
    #[must_use]
    pub fn of(robot: &Robot, joints_rad: &Joints) -> Self {
        let behind = robot.wrist_ahead_m(joints_rad) < 0.0;
        let [.., a4, _, a6, _] = *joints_rad;
        Self(u8::from(behind) | u8::from(a4 < 0.0) << 1 | u8::from(a6 < 0.0) << 2)
    }

    /// Signs, 1 or -1, of the wrist's x coordinate, of A4 and of A6.
    #[inline]
    pub(crate) fn signs(self) -> [f64; 3] {
        [0, 1, 2].map(|bit| f64::from(1 - 2 * i8::from(self.0 >> bit & 1 == 1)))
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}
