//! Redundancy parameters of a pose.

use crate::{Joints, Robot, status::Status, turn::Turn};

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
