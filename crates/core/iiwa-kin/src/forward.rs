//! Forward kinematics (Larsen 2019, Eq. 5 and 9).
//!
//! All link lengths `a` of the LBR iiwa are zero and all twists are quarter turns, so that a link's
//! transform is a rotation in a plane, an exchange of two axes and a shift along one.

#![expect(
    clippy::inline_always,
    reason = "kernels must be inlined into the function that enables vector instructions"
)]

use nalgebra::SMatrix;

use crate::rotation::Vec3;
use crate::{Joints, Pose, Robot, robot::TWIST_QUARTERS, trig::sin_cos};

/// The axes of a frame and where it is: columns of a homogeneous transform.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    pub(crate) x: Vec3<f64>,
    pub(crate) y: Vec3<f64>,
    pub(crate) z: Vec3<f64>,
    pub(crate) p: Vec3<f64>,
}

impl Frame {
    pub(crate) const BASE: Self =
        Self { x: [1.0, 0.0, 0.0], y: [0.0, 1.0, 0.0], z: [0.0, 0.0, 1.0], p: [0.0; 3] };

    /// Turns the frame about its own z axis.
    #[inline(always)]
    pub(crate) fn turn(&mut self, sin: f64, cos: f64) {
        for i in 0..3 {
            let (x, y) = (self.x[i], self.y[i]);
            self.x[i] = cos * x + sin * y;
            self.y[i] = cos * y - sin * x;
        }
    }

    /// Moves the frame along its own z axis.
    #[inline(always)]
    pub(crate) fn advance(&mut self, d: f64) {
        for i in 0..3 {
            self.p[i] += d * self.z[i];
        }
    }

    /// Turns the frame about its own x axis by quarter turns (-1, 0 or 1).
    #[inline(always)]
    pub(crate) fn twist(&mut self, quarters: i8) {
        let (y, z) = (self.y, self.z);
        match quarters {
            1 => (self.y, self.z) = (z, y.map(|v| -v)),
            -1 => (self.y, self.z) = (z.map(|v| -v), y),
            _ => {}
        }
    }

    /// From link `j` + 1, turned, to the frame of the next one before its turn.
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

/// The flange's frame from the sines and cosines of the seven joints.
///
/// The first two links are written out: they start from the base's axes, which are zeros and ones.
#[inline(always)]
pub(crate) fn chain(d: &[f64; 4], s: &Joints, c: &Joints) -> Frame {
    let mut frame = Frame {
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

/// One link backwards: a vector in the frame after joint `j`, given in the frame before it.
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
    /// The lengths d1, d3, d5, d7 in m.
    #[inline]
    pub(crate) fn offsets(&self) -> [f64; 4] {
        let l = &self.lengths;
        [l.base_m, l.upper_arm_m, l.forearm_m, l.flange_m]
    }

    /// Pose of the TCP in the base frame, at `joints_rad` (Larsen 2019, Eq. 9). There is no tool: the
    /// TCP is the flange's face.
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

    /// Position of the TCP in the base frame, in m. Joint 7 has no part in it.
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

    /// Position (m) and velocity (m per unit of `rate`) of the TCP when the joints change at
    /// `rate`, in rad per unit of whatever it is counted in (seconds, or the path parameter s).
    ///
    /// ```
    /// let robot = iiwa_kin::Robot::lbr_iiwa_7_r800();
    /// // Stretched out to the side, joint 1 at 1 rad/s moves the flange at its distance from the axis.
    /// let q = [0.0, std::f64::consts::FRAC_PI_2, 0.0, 0.0, 0.0, 0.0, 0.0];
    /// let (position_m, velocity_m_s) = robot.flange_motion(&q, &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    /// assert!((velocity_m_s[1] - position_m[0]).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn flange_motion(&self, joints_rad: &Joints, rate: &Joints) -> ([f64; 3], [f64; 3]) {
        let (s, c) = sin_cos_of_joints(joints_rad);
        let d = self.offsets();
        motion_in_base(&d, [&s, &c], rate, [0.0, 0.0, d[3]], [0.0; 3])
    }

    /// The same of a TCP, whose position is given in the flange's frame, in m.
    ///
    /// ```
    /// // A TCP 0.1 m beside the flange, which turns about its own axis.
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
    /// Link j turns with joint j about its own z axis, as in the URDF of [`Robot::to_urdf`]: it is
    /// frame j of the Denavit-Hartenberg table before the shift `d_j` and the twist `alpha_j`.
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
        let mut frame = Frame::BASE;
        for j in 0..7 {
            frame.turn(s[j], c[j]);
            poses[j + 1] = frame.pose();
            frame.step(j, &d);
        }
        poses[8] = frame.pose();
        poses
    }

    /// Geometric Jacobian of the TCP in the base frame: three rows of linear velocity (m/rad) over
    /// three of angular velocity (rad/rad), one column a joint.
    ///
    /// ```
    /// let robot = iiwa_kin::Robot::lbr_iiwa_7_r800();
    /// let jacobian = robot.jacobian(&[0.0, 0.5, 0.0, -1.0, 0.0, 0.7, 0.0]);
    /// // Joint 1 turns everything about the base's z axis.
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

    /// How fast a TCP goes, in m/s, that is given in the flange's frame, at joint positions in rad and velocities in
    /// rad/s.
    ///
    /// ```
    /// use iiwa_kin::{Pose, Robot};
    ///
    /// // A TCP 0.1 m beside the flange, which turns about its own axis.
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

/// Position and velocity in the base frame of a point that is given, with what joint 7 makes it move, beyond that joint.
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

/// Sines and cosines of seven joints, computed as eight: an even number fills vector registers.
#[inline(always)]
pub(crate) fn sin_cos_of_joints(q: &Joints) -> (Joints, Joints) {
    let (s, c) = sin_cos(&[q[0], q[1], q[2], q[3], q[4], q[5], q[6], 0.0]);
    ([s[0], s[1], s[2], s[3], s[4], s[5], s[6]], [c[0], c[1], c[2], c[3], c[4], c[5], c[6]])
}
