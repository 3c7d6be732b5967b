//! Point-to-point motions below full speed.

use iiwa_program::{LimitKind, Motion, MotionIndex, Program};

use crate::change::{Change, ChangeKind};

/// Returns the changes to full speed.
pub(crate) fn full_speeds(program: &Program) -> Vec<Change> {
    let change = |(motion, entry): (MotionIndex, &Motion)| {
        let shares = match entry {
            Motion::Ptp(ptp) => &ptp.velocity_rel,
            Motion::Cartesian(cartesian) if cartesian.is_ptp() => {
                &cartesian.shares[LimitKind::Velocity]
            }
            _ => return None,
        };
        let from_rel = shares.iter().copied().fold(1.0, f64::min);
        let kind = ChangeKind::FullSpeed { from_rel };
        (from_rel < 1.0).then_some(Change { motion, kind })
    };
    program.entries().filter_map(change).collect()
}
