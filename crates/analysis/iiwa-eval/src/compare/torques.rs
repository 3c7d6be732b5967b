//! Recorded torques beside those of the plan.

use std::ops::Range;

use iiwa_kin::{Dynamics, Joints};
use iiwa_log::JointLog;
use iiwa_program::MotionIndex;

use super::plan::Plan;
use crate::exerted::exerted;

/// Recorded torques less those that the plan needs at the same place, in Nm. Both are what joints exert.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct TorqueDifference {
    /// Root mean square over the samples of the motion.
    pub rms_nm: Joints,
    /// The largest one, with its sign.
    pub largest_nm: Joints,
    /// When it is the largest, in s of the recording.
    pub largest_at_s: Joints,
    /// The largest that the plan needs at these samples, with its sign, in Nm.
    pub planned_peak_nm: Joints,
    /// Samples that have torques.
    pub samples: usize,
    /// Whether the recording has the sign of plans already, and not that of KUKA's controller.
    pub turned: bool,
}

/// The differences over some samples, each at its place in the plan; none if none of them has torques.
pub(super) fn differences(
    plan: &Plan,
    log: &JointLog,
    samples: Range<usize>,
    place_s: &[f64],
) -> Option<TorqueDifference> {
    let floor = plan.dynamics(MotionIndex::default());
    let (torques, turned) = exerted(log, &floor)?;
    let zero = [0.0; 7];
    let mut found = TorqueDifference {
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
        found.samples += 1;
        for j in 0..7 {
            let difference = measured[j] - planned[j];
            found.rms_nm[j] += difference * difference;
            if difference.abs() > found.largest_nm[j].abs() {
                (found.largest_nm[j], found.largest_at_s[j]) = (difference, log.t_s[i]);
            }
            if planned[j].abs() > found.planned_peak_nm[j].abs() {
                found.planned_peak_nm[j] = planned[j];
            }
        }
    }
    let count = found.samples as f64;
    found.rms_nm = found.rms_nm.map(|squares| (squares / count).sqrt());
    (found.samples > 0).then_some(found)
}
