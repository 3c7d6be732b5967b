//! Forward kinematics of many poses at once.

use crate::{Joints, Pose, Robot, forward::chain, trig::sin_cos};

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
        let d = self.offsets();
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || batch(&d, joints_rad, poses),
        );
    }
}

#[inline(always)]
fn batch(d: &[f64; 4], joints: &[Joints], poses: &mut [Pose]) {
    let (blocks, rest) = joints.as_chunks::<LANES>();
    let (pose_blocks, pose_rest) = poses.as_chunks_mut::<LANES>();
    for (block, out) in blocks.iter().zip(pose_blocks) {
        *out = lanes(d, block);
    }
    if !rest.is_empty() {
        let mut block = [[0.0; 7]; LANES];
        block[..rest.len()].copy_from_slice(rest);
        pose_rest.copy_from_slice(&lanes(d, &block)[..rest.len()]);
    }
}

#[inline(always)]
fn lanes(d: &[f64; 4], block: &[Joints; LANES]) -> [Pose; LANES] {
    let mut s = [[0.0; LANES]; 7];
    let mut c = [[0.0; LANES]; 7];
    for j in 0..7 {
        let angles: [f64; LANES] = std::array::from_fn(|l| block[l][j]);
        (s[j], c[j]) = sin_cos(&angles);
    }
    // Twelve numbers a pose, one row of lanes each: the loop over lanes becomes vector code.
    let mut rows = [[0.0; LANES]; 12];
    for l in 0..LANES {
        let frame = chain(d, &std::array::from_fn(|j| s[j][l]), &std::array::from_fn(|j| c[j][l]));
        for i in 0..3 {
            rows[i][l] = frame.x[i];
            rows[3 + i][l] = frame.y[i];
            rows[6 + i][l] = frame.z[i];
            rows[9 + i][l] = frame.p[i];
        }
    }
    std::array::from_fn(|l| Pose {
        position_m: std::array::from_fn(|i| rows[9 + i][l]),
        rotation: std::array::from_fn(|i| [rows[i][l], rows[3 + i][l], rows[6 + i][l]]),
    })
}
