//! Forward kinematics (Larsen 2019, Eq. 5 and 9).
//!
//! All link lengths `a` of the LBR iiwa are zero and all twists are quarter turns, so a link
//! transform is a rotation in a plane, an exchange of two axes and a shift along one axis.

#![expect(
    clippy::inline_always,
    reason = "kernels must be inlined into the function that enables vector instructions"
)]

use nalgebra::SMatrix;

use crate::rotation::Vec3;
use crate::{Joints, Pose, Robot, robot::TWIST_QUARTERS, trig::sin_cos};

/// Axes and origin of a frame: the columns of a homogeneous transform.
#[derive(Clone, Copy)]
pub(crate) struct FrameAxes {
    pub(crate) x: Vec3<f64>,
    pub(crate) y: Vec3<f64>,
    pub(crate) z: Vec3<f64>,
    pub(crate) p: Vec3<f64>,
}

impl FrameAxes {
    pub(crate) const BASE: Self =
        Self { x: [1.0, 0.0, 0.0], y: [0.0, 1.0, 0.0], z: [0.0, 0.0, 1.0], p: [0.0; 3] };

    /// Rotates the frame about its own z axis.
    #[inline(always)]
    pub(crate) fn turn(&mut self, sin: f64, cos: f64) {
        for i in 0..3 {
            let (x, y) = (self.x[i], self.y[i]);
            self.x[i] = cos * x + sin * y;
            self.y[i] = cos * y - sin * x;
        }
    }

    /// Translates the frame along its own z axis.
    #[inline(always)]
    pub(crate) fn advance(&mut self, d: f64) {
        for i in 0..3 {
            self.p[i] += d * self.z[i];
        }
    }

    /// Rotates the frame about its own x axis by quarter turns (-1, 0 or 1).
    #[inline(always)]
    pub(crate) fn twist(&mut self, quarters: i8) {
        let (y, z) = (self.y, self.z);
        match quarters {
            1 => (self.y, self.z) = (z, y.map(|v| -v)),
            -1 => (self.y, self.z) = (z.map(|v| -v), y),
            _ => {}
        }
    }

    /// Moves on from the frame of link `j` + 1, after its joint rotation, to the next link's frame
    /// before its joint rotation.
    #[inline(always)]
    pub(crate) fn step(&mut self, j: usize, d: &[f64; 4]) {
        if j.is_multiple_of(2) {
            self.advance(d[j / 2]);
        }
        self.twist(TWIST_QUARTERS[j]);
    }

    #[inline(always)]
    pub(crate) fn pose(&self) -> Pose {
        Pose {
            position_m: self.p,
            rotation: std::array::from_fn(|i| [self.x[i], self.y[i], self.z[i]]),
        }
    }
}

/// Flange frame from the sines and cosines of the seven joints.
///
/// The first two links are written out because they start from the base axes, whose components are
/// zeros and ones.
#[inline(always)]
pub(crate) fn chain(d: &[f64; 4], s: &Joints, c: &Joints) -> FrameAxes {
    let mut frame = FrameAxes {
        x: [c[0] * c[1], s[0] * c[1], -s[1]],
        y: [-s[0], c[0], 0.0],
        z: [c[0] * s[1], s[0] * s[1], c[1]],
        p: [0.0, 0.0, d[0]],
    };
    for j in 2..7 {
        if j % 2 == 0 {
            frame.advance(d[j / 2]);
        }
        frame.turn(s[j], c[j]);
        frame.twist(TWIST_QUARTERS[j]);
    }
    frame
}

#[inline(always)]
pub(crate) fn tcp(d: &[f64; 4], joints_rad: &Joints) -> Pose {
    let (s, c) = sin_cos_of_joints(joints_rad);
    chain(d, &s, &c).pose()
}

/// Rotates `v`, given in the frame after joint `j`, into the frame before that joint.
#[inline(always)]
fn rotate_back(j: usize, v: Vec3<f64>, s: f64, c: f64) -> Vec3<f64> {
    let [x, y, z] = v;
    let (y, z) = match TWIST_QUARTERS[j] {
        1 => (-z, y),
        -1 => (z, -y),
        _ => (y, z),
    };
    [c * x - s * y, s * x + c * y, z]
}

impl Robot {
    /// Lengths d1, d3, d5, d7, in m.
    #[inline]
    pub(crate) fn offsets(&self) -> [f64; 4] {
        let l = &self.lengths;
        [l.base_m, l.upper_arm_m, l.forearm_m, l.flange_m]
    }

    /// Flange pose in the base frame at `joints_rad` (Larsen 2019, Eq. 9). There is no tool: the
    /// TCP is the centre of the flange face.
    ///
    /// ```
    /// let robot = iiwa_kin::Robot::lbr_iiwa_7_r800();
    /// let pose = robot.flange_pose(&[0.0; 7]);
    /// assert!((pose.position_m[2] - 1.292).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn flange_pose(&self, joints_rad: &Joints) -> Pose {
        tcp(&self.offsets(), joints_rad)
    }

    /// Flange position in the base frame, in m. It does not depend on joint 7.
    ///
    /// ```
    /// let robot = iiwa_kin::Robot::lbr_iiwa_7_r800();
    /// let q = [0.1, 0.5, 0.0, -1.0, 0.0, 0.7, 0.3];
    /// let (a, b) = (robot.flange_position(&q), robot.flange_pose(&q).position_m);
    /// assert!((0..3).all(|i| (a[i] - b[i]).abs() < 1e-12));
    /// ```
    #[must_use]
    pub fn flange_position(&self, joints_rad: &Joints) -> [f64; 3] {
        let (s, c) = sin_cos_of_joints(joints_rad);
        let d = self.offsets();
        let mut p = [0.0, 0.0, d[3]];
        for j in (0..6).rev() {
            p = rotate_back(j, p, s[j], c[j]);
            if j % 2 == 0 {
                p[2] += d[j / 2];
            }
        }
        p
    }

    /// Position (m) and velocity (m per unit of `rate`) of the flange when the joints change at
    /// `rate`, in rad per unit of the independent variable (time in s, or the path parameter s).
    ///
    /// ```
    /// let robot = iiwa_kin::Robot::lbr_iiwa_7_r800();
    /// // Stretched sideways: joint 1 at 1 rad/s moves the flange at its distance from the axis.
    /// let q = [0.0, std::f64::consts::FRAC_PI_2, 0.0, 0.0, 0.0, 0.0, 0.0];
    /// let (position_m, velocity_m_s) =
    ///     robot.flange_motion(&q, &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    /// assert!((velocity_m_s[1] - position_m[0]).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn flange_motion(&self, joints_rad: &Joints, rate: &Joints) -> ([f64; 3], [f64; 3]) {
        let (s, c) = sin_cos_of_joints(joints_rad);
        let d = self.offsets();
        motion_in_base(&d, [&s, &c], rate, [0.0, 0.0, d[3]], [0.0; 3])
    }

    /// Position and velocity, as in [`flange_motion`](Self::flange_motion), of a TCP given in the
    /// flange frame, in m.
    ///
    /// ```
    /// // A TCP 0.1 m beside the flange, which rotates about its own axis.
    /// let turns = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0];
    /// let robot = iiwa_kin::Robot::default();
    /// let (_, velocity_m_s) = robot.tcp_motion(&[0.1, 0.0, 0.0], &[0.0; 7], &turns);
    /// assert!((velocity_m_s[1] - 0.2).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn tcp_motion(
        &self,
        tcp_m: &[f64; 3],
        joints_rad: &Joints,
        rate: &Joints,
    ) -> ([f64; 3], [f64; 3]) {
        let (s, c) = sin_cos_of_joints(joints_rad);
        let d = self.offsets();
        let [x, y, z] = *tcp_m;
        let p = [c[6] * x - s[6] * y, s[6] * x + c[6] * y, d[3] + z];
        motion_in_base(&d, [&s, &c], rate, p, [-rate[6] * p[1], rate[6] * p[0], 0.0])
    }

    /// Poses of all links in the base frame: `iiwa_link_0` to `iiwa_link_7`, then the flange
    /// `iiwa_link_ee`.
    ///
    /// Link j rotates with joint j about its own z axis, as in the URDF of [`Robot::to_urdf`]: its
    /// frame is frame j of the Denavit-Hartenberg table before the shift `d_j` and the twist
    /// `alpha_j`.
    ///
    /// ```
    /// let poses = iiwa_kin::Robot::lbr_iiwa_7_r800().link_poses(&[0.0; 7]);
    /// // The shoulder, where the axes of joints 1 and 2 meet.
    /// assert!((poses[2].position_m[2] - 0.34).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn link_poses(&self, joints_rad: &Joints) -> [Pose; 9] {
        let (s, c) = sin_cos_of_joints(joints_rad);
        let d = self.offsets();
        let mut poses = [Pose::IDENTITY; 9];
        let mut frame = FrameAxes::BASE;
        for j in 0..7 {
            frame.turn(s[j], c[j]);
            poses[j + 1] = frame.pose();
            frame.step(j, &d);
        }
        poses[8] = frame.pose();
        poses
    }

    /// Geometric Jacobian of the flange in the base frame, one column per joint: three rows of
    /// linear velocity (m/rad) above three rows of angular velocity (rad/rad).
    ///
    /// ```
    /// let robot = iiwa_kin::Robot::lbr_iiwa_7_r800();
    /// let jacobian = robot.jacobian(&[0.0, 0.5, 0.0, -1.0, 0.0, 0.7, 0.0]);
    /// // Joint 1 rotates everything about the z axis of the base.
    /// assert_eq!(jacobian[(5, 0)], 1.0);
    /// ```
    #[must_use]
    pub fn jacobian(&self, joints_rad: &Joints) -> SMatrix<f64, 6, 7> {
        let poses = self.link_poses(joints_rad);
        let tcp = poses[8].position_m;
        let mut jacobian = SMatrix::<f64, 6, 7>::zeros();
        for j in 0..7 {
            let axis = poses[j + 1].rotation.map(|row| row[2]);
            let arm: Vec3<f64> = std::array::from_fn(|i| tcp[i] - poses[j + 1].position_m[i]);
            let linear = [
                axis[1] * arm[2] - axis[2] * arm[1],
                axis[2] * arm[0] - axis[0] * arm[2],
                axis[0] * arm[1] - axis[1] * arm[0],
            ];
            for i in 0..3 {
                jacobian[(i, j)] = linear[i];
                jacobian[(i + 3, j)] = axis[i];
            }
        }
        jacobian
    }

    /// TCP speed, in m/s, at joint positions in rad and joint velocities in rad/s; `tcp` is the TCP
    /// in the flange frame.
    ///
    /// ```
    /// use iiwa_kin::{Pose, Robot};
    ///
    /// // A TCP 0.1 m beside the flange, which rotates about its own axis.
    /// let tcp = Pose::from_xyz_abc([0.1, 0.0, 0.0], [0.0; 3]);
    /// let turns = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0];
    /// let speed = Robot::default().tcp_speed_m_s(&tcp, &[0.3; 7], &turns);
    /// assert!((speed - 0.2).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn tcp_speed_m_s(&self, tcp: &Pose, joints_rad: &Joints, velocity_rad_s: &Joints) -> f64 {
        let (_, velocity) = self.tcp_motion(&tcp.position_m, joints_rad, velocity_rad_s);
        velocity.iter().map(|v| v * v).sum::<f64>().sqrt()
    }
}

/// Position and velocity in the base frame of a point given beyond joint 7, with the velocity that
/// joint 7 gives it.
#[inline(always)]
fn motion_in_base(
    d: &[f64; 4],
    [s, c]: [&Joints; 2],
    rate: &Joints,
    mut p: [f64; 3],
    mut v: [f64; 3],
) -> ([f64; 3], [f64; 3]) {
    for j in (0..6).rev() {
        p = rotate_back(j, p, s[j], c[j]);
        v = rotate_back(j, v, s[j], c[j]);
        v[0] -= rate[j] * p[1];
        v[1] += rate[j] * p[0];
        if j % 2 == 0 {
            p[2] += d[j / 2];
        }
    }
    (p, v)
}

/// Sines and cosines of seven joints, computed as eight because an even number fills vector
/// registers.
#[inline(always)]
pub(crate) fn sin_cos_of_joints(q: &Joints) -> (Joints, Joints) {
    let (s, c) = sin_cos(&[q[0], q[1], q[2], q[3], q[4], q[5], q[6], 0.0]);
    ([s[0], s[1], s[2], s[3], s[4], s[5], s[6]], [c[0], c[1], c[2], c[3], c[4], c[5], c[6]])
}
