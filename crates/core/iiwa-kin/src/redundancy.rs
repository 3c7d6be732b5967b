//! What a pose leaves open.

use crate::{Joints, Robot, status::Status, turn::Turn};

/// What Sunrise keeps of a taught frame beside its pose (`LBRE1Redundancy`), so that there is one set of
/// joints that reaches it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Redundancy {
    /// E1: the position of joint A3, in rad.
    pub e1_rad: f64,
    /// Which of the eight ways of the arm.
    pub status: Status,
    /// The signs of the joints.
    pub turn: Turn,
}

impl Robot {
    /// E1, status and turn of the arm at `joints_rad`.
    ///
    /// ```
    /// let robot = iiwa_kin::Robot::lbr_iiwa_7_r800();
    /// let redundancy = robot.redundancy(&[0.0, 0.5, 0.2, -1.0, 0.0, 0.7, 0.0]);
    /// assert_eq!((redundancy.e1_rad, redundancy.status.bits(), redundancy.turn.bits()), (0.2, 2, 8));
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
