//! Continuity of velocity and acceleration between pieces and intervals.

use iiwa_kin::Joints;
use iiwa_path::Derivatives;
use iiwa_program::{LimitKind, MotionLimits};
use iiwa_traj::{Section, Timing, Trajectory};

use crate::differences::largest;

/// Velocity and acceleration of all joints at the end of an interval, with the limits there.
#[derive(Clone, Copy)]
struct Side<'a> {
    dq: Joints,
    ddq: Joints,
    limits: &'a MotionLimits,
}

/// Returns the largest jumps of velocity and, for jerk-limited stamps, of acceleration in a
/// section.
pub(crate) fn jumps(trajectory: &Trajectory, section: &Section, timing: Timing) -> [f64; 2] {
    let mut worst = [0.0_f64; 2];
    let is_jerk_limited = matches!(timing, Timing::Jerk(_));
    let mut jump = |a: &Side<'_>, b: &Side<'_>| {
        let limits = [a.limits, b.limits];
        let [velocity, acceleration] = [LimitKind::Velocity, LimitKind::Acceleration]
            .map(|kind| largest(limits.into_iter(), kind));
        for j in 0..7 {
            let by = [(a.dq[j] - b.dq[j]) / velocity[j], (a.ddq[j] - b.ddq[j]) / acceleration[j]];
            for (worst, by) in worst.iter_mut().zip(by).take(1 + usize::from(is_jerk_limited)) {
                let by = if by.is_nan() { f64::INFINITY } else { by.abs() };
                *worst = worst.max(by);
            }
        }
    };
    let mut before: Option<Side<'_>> = None;
    for piece in section.pieces() {
        let limits = trajectory.path().limits_of(piece.step);
        let rest = Side { dq: [0.0; 7], ddq: [0.0; 7], limits };
        let Some(segment) = section.segment(piece) else {
            jump(&before.unwrap_or(rest), &rest);
            before = Some(rest);
            continue;
        };
        let side = |d: &Derivatives, rate: f64, u: f64| Side {
            dq: d.dq.map(|v| v * rate),
            ddq: std::array::from_fn(|j| d.dq[j] * u + d.ddq[j] * rate * rate),
            limits,
        };
        for pair in section.nodes(piece).windows(2) {
            let [from, to] = [&pair[0], &pair[1]];
            let [start, end] = [from.p, to.p].map(|p| segment.at_share(p));
            jump(&before.unwrap_or(rest), &side(&start, from.rate, from.u[0]));
            before = Some(side(&end, to.rate, from.u[1]));
        }
    }
    // The arm is at rest after the section.
    if let Some(last) = before {
        jump(&last, &Side { dq: [0.0; 7], ddq: [0.0; 7], ..last });
    }
    worst
}
