//! Recorded torques compared with those of the plan.

use std::ops::Range;

use iiwa_kin::{Dynamics, Joints};
use iiwa_log::JointLog;
use iiwa_program::MotionIndex;

use super::plan::PlannedTrajectory;
use crate::exerted::exerted;

/// Recorded torques minus the torques required by the plan at the same point, in Nm. Both are
/// torques exerted by the joints.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct TorqueDifference {
    /// Root mean square over the samples of the motion.
    pub rms_nm: Joints,
    /// Largest difference, with its sign.
    pub largest_nm: Joints,
    /// Time of the largest difference, in s, on the recording's clock.
    pub largest_at_s: Joints,
    /// Largest torque required by the plan at these samples, with its sign, in Nm.
    pub planned_peak_nm: Joints,
    /// Number of samples with torques.
    pub samples: usize,
    /// `true` if the sign of the recorded torques is not that of their format, and was inverted.
    pub turned: bool,
}

/// Computes the differences over a range of samples with their matched planned times; `None` if the
/// recording has no torques.
pub(super) fn differences(
    plan: &PlannedTrajectory,
    log: &JointLog,
    samples: Range<usize>,
    place_s: &[f64],
) -> Option<TorqueDifference> {
    let floor = plan.dynamics(MotionIndex::default());
    let (torques, turned) = exerted(log, &floor)?;
    let zero = [0.0; 7];
    let mut total = TorqueDifference {
        rms_nm: zero,
        largest_nm: zero,
        largest_at_s: zero,
        planned_peak_nm: zero,
        samples: 0,
        turned,
    };
    let mut arm: Option<(MotionIndex, Dynamics)> = None;
    for (i, plan_s) in samples.zip(place_s) {
        let Some(Some(measured)) = torques.get(i) else { continue };
        let motion = plan.motion_at(*plan_s);
        let (_, dynamics) = match arm {
            Some(known) if known.0 == motion => known,
            _ => *arm.insert((motion, plan.dynamics(motion))),
        };
        let planned = plan.torques_at(*plan_s, &dynamics);
        total.samples += 1;
        for j in 0..7 {
            let difference = measured[j] - planned[j];
            total.rms_nm[j] += difference * difference;
            if difference.abs() > total.largest_nm[j].abs() {
                (total.largest_nm[j], total.largest_at_s[j]) = (difference, log.t_s[i]);
            }
            if planned[j].abs() > total.planned_peak_nm[j].abs() {
                total.planned_peak_nm[j] = planned[j];
            }
        }
    }
    let count = total.samples as f64;
    total.rms_nm = total.rms_nm.map(|squares| (squares / count).sqrt());
    (total.samples > 0).then_some(total)
}
