//! Latest time at which the robot has to know the motion after a blend.
//!
//! KUKA does not publish this time. It is assumed to be the last instant at which the robot can
//! still stop at the start of the blend: the instant at which the plan with a stop there becomes
//! slower than the plan without.

use iiwa_path::{JointPath, Segment};
use iiwa_program::LimitKind;

use crate::{
    path_limits::PathLimits,
    section::{Piece, Section},
};

/// Relative difference between the speeds of two plans up to which both count as equal; under jerk
/// limits, it amounts to some milliseconds.
const SAME_SPEED: f64 = 2e-3;

/// Parts into which the intervals between nodes are divided.
const PARTS: u32 = 8;

/// Factor on the bound of a line for curves, along which the joints' shares of the speed change.
const ON_CURVES: f64 = 4.0;

/// Returns the latest time to decide for `going_on`, in s: the instant at which `stopping`, which
/// starts along the same path, begins to slow down for its end.
pub(crate) fn needed_s(going_on: &Section, stopping: &Section) -> f64 {
    // Backwards from the stop: the first point with equal speeds is the last one before braking.
    for piece in stopping.pieces().iter().rev() {
        let Some(same) = going_on.pieces().iter().find(|other| other.step == piece.step) else {
            continue;
        };
        for pair in stopping.nodes(piece).windows(2).rev() {
            for part in (0..PARTS).rev() {
                let p = pair[0].p + pair[0].dp * f64::from(part) / f64::from(PARTS);
                let [_, slow] = stopping.passing(piece, p);
                let [time_s, fast] = going_on.passing(same, p);
                if slow >= fast * (1.0 - SAME_SPEED) {
                    return time_s;
                }
            }
        }
    }
    going_on.start_s()
}

/// Returns true if at `known_s` so much time is left until `section` reaches its `piece`, a blend,
/// that the robot does not yet have to slow down to stop before it. False if that cannot be decided
/// without a plan.
pub(crate) fn is_early(
    section: &Section,
    piece: usize,
    known_s: f64,
    further: &PathLimits,
) -> bool {
    let (Some(blend), Some(before)) =
        (section.pieces().get(piece), piece.checked_sub(1).and_then(|i| section.pieces().get(i)))
    else {
        return false;
    };
    let Some(braking_s) = braking_bound_s(section.path(), before, further) else { return false };
    let is_line = section.segment(before).is_some_and(Segment::is_straight);
    let bound_s = if is_line { braking_s } else { ON_CURVES * braking_s };
    let latest_s = blend.start_s - bound_s;
    // Pieces before the line may have other limits.
    known_s <= latest_s && before.start_s <= latest_s
}

/// Returns an upper bound of the stopping time on a line, for any initial speed and acceleration,
/// in s. None if TCP acceleration or jerk limits, or `further` limits, apply.
fn braking_bound_s(path: &JointPath, piece: &Piece, further: &PathLimits) -> Option<f64> {
    let limits = path.limits_of(piece.step);
    let tool = limits.tool();
    let is_free = [&tool.way, &tool.turn].iter().all(|limits| {
        limits[LimitKind::Acceleration].is_infinite() && limits[LimitKind::Jerk].is_infinite()
    });
    if !is_free || further.limit_step(path, piece.step) {
        return None;
    }
    let [velocity, acceleration, jerk] = LimitKind::ALL.map(|kind| limits.of(kind));
    // Along the line, each limit is that of one joint: the longest time of any joint is a bound.
    let longest =
        |a: &[f64; 7], b: &[f64; 7]| a.iter().zip(b).map(|(a, b)| a / b).fold(0.0, f64::max);
    Some(longest(velocity, acceleration) + 2.0 * longest(acceleration, jerk))
}
