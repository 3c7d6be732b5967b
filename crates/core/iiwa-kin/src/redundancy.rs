//! Redundancy parameters of a pose: E1, status and turn.

use std::fmt;

use crate::{Joints, Robot};

/// Redundancy parameters that Sunrise stores with the pose of a taught frame (`LBRE1Redundancy`),
/// so that a unique set of joint positions reaches the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Redundancy {
    /// E1: position of joint A3, in rad.
    pub e1_rad: f64,
    /// Arm configuration, one of eight.
    pub status: Status,
    /// Signs of the joint positions.
    pub turn: Turn,
}

impl Robot {
    /// E1, status and turn at `joints_rad`.
    ///
    /// ```
    /// let robot = iiwa_kin::Robot::lbr_iiwa_7_r800();
    /// let redundancy = robot.redundancy(&[0.0, 0.5, 0.2, -1.0, 0.0, 0.7, 0.0]);
    /// assert_eq!(
    ///     (redundancy.e1_rad, redundancy.status.bits(), redundancy.turn.bits()),
    ///     (0.2, 2, 8)
    /// );
    /// ```
    #[must_use]
    pub fn redundancy(&self, joints_rad: &Joints) -> Redundancy {
        Redundancy {
            e1_rad: joints_rad[2],
            status: Status::of(self, joints_rad),
            turn: Turn::of(joints_rad),
        }
    }
}

/// Sunrise's status: selects one of the up to eight sets of joint positions that reach a pose with
/// a given position of joint A3. Three bits, 0 to 7; zero counts as not negative.
///
/// | bit | set where |
/// |---|---|
/// | 0 | the wrist is behind joint A1: its x in the frame that A1 turns is negative (the arm reaches over its head) |
/// | 1 | A4 is negative |
/// | 2 | A6 is negative |
///
/// The rule for bit 0 is published for KUKA's robots. Its use in Sunrise is inferred: the rule
/// holds for all 1472 taught frames of Sunrise projects that agree with the other rules of this
/// model.
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
