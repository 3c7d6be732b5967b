//! Curves of a recording: its positions, and estimates of their derivatives.

use iiwa_eval::local_cubic;
use iiwa_kin::Joints;
use iiwa_log::{JointLog, Loss};
use rayon::prelude::*;

use super::curve::TimeSeries;

/// Smallest half-width of the window in which a cubic is fitted to compute derivatives, in s: short
/// compared to the 0.05 s in which the acceleration of an LBR iiwa builds up, long enough to
/// average encoder noise.
const HALF_S: f64 = 0.02;

/// Smallest number of samples on each side of the cubic's centre.
const HALF_SAMPLES: f64 = 4.0;

/// Maximum number of cubics: an hour. More are not visible on a screen.
const CUBICS: f64 = 900_000.0;

/// Position, velocity, acceleration and jerk of a recording.
#[derive(Debug)]
pub(crate) struct MeasuredCurves {
    pub(crate) position: TimeSeries,
    pub(crate) velocity: TimeSeries,
    pub(crate) acceleration: TimeSeries,
    pub(crate) jerk: TimeSeries,
    /// Half-width of the window of the cubics, in s.
    pub(crate) half_s: f64,
}

impl MeasuredCurves {
    pub(crate) fn new(log: &JointLog) -> Self {
        let gaps = gaps(log);
        let half_s = HALF_S.max(HALF_SAMPLES * log.period_s().unwrap_or(0.0));
        let mut measured = Self {
            position: with_gaps(&log.t_s, log.q_rad.iter().copied(), &gaps),
            velocity: TimeSeries::default(),
            acceleration: TimeSeries::default(),
            jerk: TimeSeries::default(),
            half_s,
        };
        let (Some(first), Some(last)) = (log.t_s.first(), log.t_s.last()) else { return measured };
        // Too short for a complete window.
        if last - first < 2.0 * half_s {
            return measured;
        }
        let joints: Vec<Vec<f64>> =
            (0..7).map(|j| log.q_rad.iter().map(|q| q[j]).collect()).collect();
        // A cubic changes little in a fifth of its window: no peak is missed in between.
        let step_s = (0.2 * half_s).max(log.period_s().unwrap_or(half_s));
        // Samples may be days apart: bounds the number of cubics.
        let step_s = step_s.max((last - first) / CUBICS);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
        let steps = ((last - first - 2.0 * half_s) / step_s) as usize;
        let rows: Vec<(f64, [Joints; 3])> = (0..=steps)
            .into_par_iter()
            .map(|i| {
                let at_s = first + half_s + i as f64 * step_s;
                (at_s, derivatives(&log.t_s, &joints, &gaps, at_s, half_s))
            })
            .collect();
        for (t_s, [dq, ddq, dddq]) in rows {
            measured.velocity.push(t_s, dq);
            measured.acceleration.push(t_s, ddq);
            measured.jerk.push(t_s, dddq);
        }
        measured
    }
}

/// Returns velocities, accelerations and jerks at a time; NaN if the window contains a gap.
fn derivatives(
    t_s: &[f64],
    joints: &[Vec<f64>],
    gaps: &[(f64, f64)],
    at_s: f64,
    half_s: f64,
) -> [Joints; 3] {
    let mut rows = [[f64::NAN; 7]; 3];
    let after = gaps.partition_point(|(_, to_s)| *to_s <= at_s - half_s);
    if gaps.get(after).is_some_and(|(from_s, _)| *from_s < at_s + half_s) {
        return rows;
    }
    for (j, values) in joints.iter().enumerate() {
        if let Some([_, dq, ddq, dddq]) = local_cubic(t_s, values, at_s, half_s) {
            (rows[0][j], rows[1][j], rows[2][j]) = (dq, ddq, dddq);
        }
    }
    rows
}

/// Returns the intervals without samples, in s.
fn gaps(log: &JointLog) -> Vec<(f64, f64)> {
    let gap = |loss: &Loss| match loss {
        Loss::Gap { from_s, to_s, .. } => Some((*from_s, *to_s)),
        _ => None,
    };
    log.losses.iter().filter_map(gap).collect()
}

/// Returns the torques that the joints of a plan or a recording exert, in Nm, as far as known.
pub(crate) fn torques(log: &JointLog) -> TimeSeries {
    let known = |torque_nm: Option<Joints>| torque_nm.unwrap_or([f64::NAN; 7]);
    with_gaps(&log.t_s, log.exerted_nm().map(known), &gaps(log))
}

/// Returns the samples, with a NaN sample in each gap.
fn with_gaps(t_s: &[f64], rows: impl Iterator<Item = Joints>, gaps: &[(f64, f64)]) -> TimeSeries {
    let mut samples = TimeSeries::default();
    let mut gaps = gaps.iter().peekable();
    for (t_s, row) in t_s.iter().zip(rows) {
        samples.push(*t_s, row);
        if let Some((from_s, to_s)) = gaps.next_if(|(from_s, _)| from_s <= t_s) {
            samples.push(f64::midpoint(*from_s, *to_s), [f64::NAN; 7]);
        }
    }
    samples
}
