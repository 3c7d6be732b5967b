//! Ramp limits at the ends of a section.

use iiwa_kin::{RampEnd, RampLimits, vector};
use iiwa_path::{JointPath, Step};

use crate::section::Piece;

/// Returns the limits of the ramp at one end of `pieces`, which run from rest to rest. None if they
/// do not move.
///
/// Two assumptions, since no recording has a payload or a reduced jerk limit: the payload counts as
/// part of the arm, and a share of the jerk limits is the same share of the snap limits.
pub(crate) fn ramp_limits(path: &JointPath, pieces: &[Piece], end: RampEnd) -> Option<RampLimits> {
    let (piece, s, sign) = match end {
        RampEnd::Start => (pieces.first()?, 0.0, 1.0),
        RampEnd::Stop => (pieces.last()?, 1.0, -1.0),
    };
    let Step::Move { segment, .. } = &path.steps()[piece.step] else { return None };
    let [direction, ..] = segment.sigma_derivatives(s);
    let rate = vector::norm(&direction);
    let away = direction.map(|d| sign * d / rate);
    let dynamics = path.dynamics(piece.motion);
    let torques = dynamics.path_torques(&segment.at(s).q, &away, &[0.0; 7]).acceleration;
    let shares = path.limits_of(piece.step).jerk_shares(&path.full_limits());
    Some(path.ramp_law().limits(&away, &torques, &shares, end))
}
