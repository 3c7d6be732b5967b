//! Forward kinematics of many poses at once.

#![expect(
    clippy::inline_always,
    reason = "kernels must be inlined into the function that enables vector instructions"
)]

use std::array::from_fn;

use crate::{
    Joints, Pose, Robot,
    forward::{chain, tcp},
    trig::{reduced, reducible},
};

/// Poses computed side by side: two vector registers of four numbers.
const LANES: usize = 8;

impl Robot {
    /// Computes the flange pose for each of `joints_rad` into `poses`: bit-identical to
    /// [`Robot::flange_pose`], in a fraction of its time. Uses AVX-512 or AVX2 where available.
    ///
    /// ```
    /// use iiwa_kin::{Pose, Robot};
    ///
    /// let robot = Robot::lbr_iiwa_7_r800();
    /// let joints: Vec<_> = (0..100).map(|i| [0.01 * f64::from(i); 7]).collect();
    /// let mut poses = vec![Pose::IDENTITY; joints.len()];
    /// robot.flange_pose_batch(&joints, &mut poses);
    /// assert_eq!(poses[42], robot.flange_pose(&joints[42]));
    /// ```
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn flange_pose_batch(&self, joints_rad: &[Joints], poses: &mut [Pose]) {
        assert_eq!(joints_rad.len(), poses.len(), "one pose for each set of joints");
        pulp::Arch::new().dispatch(Batch { d: self.offsets(), joints: joints_rad, poses });
    }
}

/// Kernel as a struct instead of a closure: a closure reaches the vectorised function through a
/// shim that is not inlined, and so is compiled without vector instructions.
struct Batch<'a> {
    d: [f64; 4],
    joints: &'a [Joints],
    poses: &'a mut [Pose],
}

impl pulp::NullaryFnOnce for Batch<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let (blocks, rest) = self.joints.as_chunks::<LANES>();
        let (pose_blocks, pose_rest) = self.poses.as_chunks_mut::<LANES>();
        // The loops over lanes become vector code. The arrays are declared outside the loop so that
        // they are cleared only once.
        let (mut s, mut c) = ([[0.0; LANES]; 7], [[0.0; LANES]; 7]);
        let mut frames = [[0.0; LANES]; 12];
        for (block, poses) in blocks.iter().zip(pose_blocks) {
            if !reducible(block.as_flattened()) {
                one_by_one(&self.d, block, poses);
                continue;
            }
            for j in 0..7 {
                for l in 0..LANES {
                    (s[j][l], c[j][l]) = reduced(block[l][j]);
                }
            }
            for l in 0..LANES {
                let frame = chain(&self.d, &from_fn(|j| s[j][l]), &from_fn(|j| c[j][l]));
                for i in 0..3 {
                    frames[i][l] = frame.x[i];
                    frames[3 + i][l] = frame.y[i];
                    frames[6 + i][l] = frame.z[i];
                    frames[9 + i][l] = frame.p[i];
                }
            }
            for l in 0..LANES {
                poses[l] = Pose {
                    position_m: from_fn(|i| frames[9 + i][l]),
                    rotation: from_fn(|i| from_fn(|axis| frames[3 * axis + i][l])),
                };
            }
        }
        one_by_one(&self.d, rest, pose_rest);
    }
}

#[inline(never)]
fn one_by_one(d: &[f64; 4], joints: &[Joints], poses: &mut [Pose]) {
    for (joints, pose) in joints.iter().zip(poses) {
        *pose = tcp(d, joints);
    }
}
