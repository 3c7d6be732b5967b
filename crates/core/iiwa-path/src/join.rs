//! Check that the steps of a path join.

use iiwa_kin::{Joints, vector};

use crate::step::Step;
use iiwa_program::MotionIndex;

/// Largest distance between the end of a segment and the start of the next, in rad.
const GAP_RAD: f64 = 1e-9;

/// Largest difference between the directions of two segments where they meet, as the distance of
/// unit vectors.
const KINK: f64 = 1e-6;

/// An error in the steps of a path.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JoinError {
    /// A step refers to a motion for which the path has no limits.
    #[error("step {step} names motion {motion}, for which the path has no limits")]
    NoLimits {
        /// Index of the step, from 0.
        step: usize,
        /// The motion.
        motion: MotionIndex,
    },
    /// A segment does not start at the end of the step before.
    #[error("step {step} starts {gap_rad} rad from the end of the step before")]
    Gap {
        /// Index of the step, from 0.
        step: usize,
        /// The distance in joint space, in rad.
        gap_rad: f64,
    },
    /// A segment starts in another direction than that at the end of the segment before, without a
    /// stop in between.
    #[error(
        "step {step} does not start in the direction in which the step before ends; add a stop"
    )]
    Kink {
        /// Index of the step, from 0.
        step: usize,
    },
}

/// Checks that `steps` join, from `start_rad` on, and that their motion indices are below
/// `motions`, the number of motions.
pub(crate) fn check_joins(
    start_rad: &Joints,
    steps: &[Step],
    motions: usize,
) -> Result<(), JoinError> {
    let mut pose_rad = *start_rad;
    // Direction of motion; `None` at rest.
    let mut direction: Option<Joints> = None;
    for (step, entry) in steps.iter().enumerate() {
        let Step::Move { motion, segment, .. } = entry else {
            direction = None;
            continue;
        };
        if motion.index() >= motions {
            return Err(JoinError::NoLimits { step, motion: *motion });
        }
        let [from, to] = [segment.at(0.0), segment.at(1.0)];
        let gap_rad = vector::norm(&vector::sub(&from.q, &pose_rad));
        // NaN joins nothing, and fails all comparisons.
        if gap_rad.is_nan() || gap_rad > GAP_RAD {
            return Err(JoinError::Gap { step, gap_rad });
        }
        let unit = |v: &Joints| vector::scale(1.0 / vector::norm(v), v);
        // A tangent of zero length has no direction: NaN does not count as a kink.
        if let Some(before) = direction
            && vector::norm(&vector::sub(&unit(&from.dq), &before)) > KINK
        {
            return Err(JoinError::Kink { step });
        }
        (pose_rad, direction) = (to.q, Some(unit(&to.dq)));
    }
    Ok(())
}
