//! A LIN as its definition says: made here, to be held against the planner's path.

use iiwa_kin::{Joints, Pose, Robot, Status};
use iiwasim_benches::Result;
use nalgebra::{Rotation3, UnitQuaternion, Vector3};

/// The TCP goes straight and turns about one axis, both evenly in s; A3 goes evenly, too.
#[derive(Debug)]
pub(crate) struct Straight<'a> {
    robot: &'a Robot,
    /// The flange, seen from the TCP.
    flange: Pose,
    from_m: Vector3<f64>,
    way_m: Vector3<f64>,
    from: UnitQuaternion<f64>,
    /// Axis times angle, in the TCP's frame at the start.
    turn_rad: Vector3<f64>,
    e1_rad: [f64; 2],
    status: Status,
}

impl<'a> Straight<'a> {
    /// From joints to joints, in rad, of a TCP given in the flange's frame.
    pub(crate) fn new(robot: &'a Robot, tcp: &Pose, from_rad: &Joints, to_rad: &Joints) -> Self {
        let ends = [from_rad, to_rad].map(|joints| robot.flange_pose(joints).then(tcp));
        let [from_m, to_m] = ends.map(|pose| Vector3::from(pose.position_m));
        // Next to no turn, an angle from a matrix has half of the digits.
        let [from, to] = ends.map(|pose| pose.to_isometry().rotation);
        Self {
            robot,
            flange: tcp.inverse(),
            from_m,
            way_m: to_m - from_m,
            from,
            turn_rad: (from.inverse() * to).scaled_axis(),
            e1_rad: [from_rad[2], to_rad[2] - from_rad[2]],
            status: robot.redundancy(from_rad).status,
        }
    }

    /// How far the TCP goes, in m, and turns, in rad.
    pub(crate) fn way(&self) -> [f64; 2] {
        [self.way_m.norm(), self.turn_rad.norm()]
    }

    /// The joints at s, by inverse kinematics.
    pub(crate) fn joints(&self, s: f64) -> Result<Joints> {
        let turned =
            (self.from.to_rotation_matrix() * Rotation3::new(s * self.turn_rad)).into_inner();
        let tcp = Pose {
            position_m: (self.from_m + s * self.way_m).into(),
            rotation: std::array::from_fn(|i| std::array::from_fn(|j| turned[(i, j)])),
        };
        let [start, by] = self.e1_rad;
        Ok(self.robot.inverse(&tcp.then(&self.flange), start + s * by, self.status)?)
    }
}
