//! LIN by its definition: an independent implementation, for comparison with the planner's path.

use iiwa_kin::{Joints, Pose, Robot, Status};
use iiwasim_benches::Result;
use nalgebra::{Rotation3, UnitQuaternion, Vector3};

/// Straight path: the TCP moves on a line and rotates about one axis, both linearly in s; A3 is
/// linear, too.
#[derive(Debug)]
pub(crate) struct Straight<'a> {
    robot: &'a Robot,
    /// Flange pose in the TCP frame.
    flange: Pose,
    from_m: Vector3<f64>,
    way_m: Vector3<f64>,
    from: UnitQuaternion<f64>,
    /// Axis times angle, in the TCP frame at the start.
    turn_rad: Vector3<f64>,
    e1_rad: [f64; 2],
    status: Status,
}

impl<'a> Straight<'a> {
    /// Creates the path between joint positions, in rad, for a TCP given in the flange frame.
    pub(crate) fn new(robot: &'a Robot, tcp: &Pose, from_rad: &Joints, to_rad: &Joints) -> Self {
        let ends = [from_rad, to_rad].map(|joints| robot.flange_pose(joints).then(tcp));
        let [from_m, to_m] = ends.map(|pose| Vector3::from(pose.position_m));
        // For small rotations, an angle computed from a matrix has half of the digits.
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

    /// Returns the TCP distance, in m, and the rotation angle, in rad.
    pub(crate) fn way(&self) -> [f64; 2] {
        [self.way_m.norm(), self.turn_rad.norm()]
    }

    /// Returns the joint positions at s, by inverse kinematics.
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
