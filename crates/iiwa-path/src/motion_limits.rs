//! The limits of one motion.

use iiwa_kin::{Joints, Robot};

use crate::program::Motion;

/// A motion's limits: the robot's, times the motion's shares (Larsen 2019, Eq. 33, and 35 for the
/// share of speed).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionLimits {
    /// In rad/s.
    pub velocity_rad_s: Joints,
    /// In rad/s^2.
    pub acceleration_rad_s2: Joints,
    /// In rad/s^3.
    pub jerk_rad_s3: Joints,
}

impl MotionLimits {
    /// All that `robot` can do.
    #[must_use]
    pub fn full(robot: &Robot) -> Self {
        let limits = robot.limits();
        Self {
            velocity_rad_s: limits.velocity_rad_s,
            acceleration_rad_s2: limits.acceleration_rad_s2,
            jerk_rad_s3: limits.jerk_rad_s3,
        }
    }

    /// Those of `motion` on `robot`.
    pub(crate) fn of(robot: &Robot, motion: &Motion) -> Self {
        let limits = robot.limits();
        let times = |limit: &Joints, share: &Joints| std::array::from_fn(|j| limit[j] * share[j]);
        let [velocity, acceleration, jerk] = match motion {
            Motion::Ptp(ptp) => [ptp.velocity_rel, ptp.acceleration_rel, ptp.jerk_rel],
            Motion::Wait { .. } => [[1.0; 7]; 3],
        };
        Self {
            velocity_rad_s: times(&limits.velocity_rad_s, &velocity),
            acceleration_rad_s2: times(&limits.acceleration_rad_s2, &acceleration),
            jerk_rad_s3: times(&limits.jerk_rad_s3, &jerk),
        }
    }
}
