//! Forward kinematics of many poses at once.

use crate::{
    Joints, Pose, Robot,
    forward::{chain, tcp},
    trig::{reduced, reducible},
};

/// Poses computed side by side: two vector registers of four, or one of eight.
const LANES: usize = 8;

impl Robot {
    /// Poses of the TCP for each of `joints_rad`, written to `poses`; the same numbers as
    /// [`Robot::tcp`], bit for bit, at a fraction of its time. Uses the widest vector instructions
    /// that the machine has.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn tcp_batch(&self, joints_rad: &[Joints], poses: &mut [Pose]) {
        assert_eq!(joints_rad.len(), poses.len(), "one pose for each set of joints");
        pulp::Arch::new().dispatch(Batch { d: self.offsets(), joints: joints_rad, poses });
    }
}

/// Not a closure: those reach the function with vector instructions by way of a shim that is not
/// inlined into it, and so stays without them.
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
        for (block, out) in blocks.iter().zip(pose_blocks) {
            if reducible(block.as_flattened()) {
                lanes(&self.d, block, out);
            } else {
                one_by_one(&self.d, block, out);
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

/// [`tcp`] of angles that are [`reducible`]: the loops over lanes become vector code.
#[inline(always)]
fn lanes(d: &[f64; 4], block: &[Joints; LANES], out: &mut [Pose; LANES]) {
    for l in 0..LANES {
        let (mut s, mut c) = ([0.0; 7], [0.0; 7]);
        for j in 0..7 {
            (s[j], c[j]) = reduced(block[l][j]);
        }
        out[l] = chain(d, &s, &c).pose();
    }
}
