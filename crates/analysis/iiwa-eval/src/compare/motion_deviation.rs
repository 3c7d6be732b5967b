//! Largest deviations from the planned path of each motion.

use iiwa_kin::{Joint, Joints};
use iiwa_program::MotionIndex;

/// Largest deviations of a motion from its planned path, regardless of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionDeviation {
    /// Motion.
    pub motion: MotionIndex,
    /// Joint with the largest deviation from the nearest point of the path.
    pub joint: Joint,
    /// Deviation of that joint, in rad.
    pub joint_rad: f64,
    /// Distance of the flange from its path, in m.
    pub flange_m: f64,
}

/// Collects samples in the order of motions.
#[derive(Debug, Default)]
pub(super) struct MotionDeviations(Vec<MotionDeviation>);

impl MotionDeviations {
    /// Adds a sample of a motion: the deviations of the joints and of the flange.
    pub(super) fn add(&mut self, motion: MotionIndex, off_rad: &Joints, off_m: f64) {
        let mut worst = (Joint::A1, 0.0);
        for (joint, off) in Joint::ALL.into_iter().zip(off_rad) {
            if off.abs() > worst.1 {
                worst = (joint, off.abs());
            }
        }
        let (joint, joint_rad) = worst;
        let Some(last) = self.0.last_mut().filter(|last| last.motion == motion) else {
            self.0.push(MotionDeviation { motion, joint, joint_rad, flange_m: off_m });
            return;
        };
        if joint_rad > last.joint_rad {
            (last.joint, last.joint_rad) = (joint, joint_rad);
        }
        last.flange_m = last.flange_m.max(off_m);
    }

    pub(super) fn all(self) -> Vec<MotionDeviation> {
        self.0
    }
}
