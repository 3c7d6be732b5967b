//! The curves of a recording: its positions, and estimates of their derivatives.

use iiwa_eval::local_cubic;
use iiwa_kin::Joints;
use iiwa_log::{JointLog, Loss};
use rayon::prelude::*;

use super::curve::Samples;

/// Derivatives are those of a cubic over at least this long before and after, in s: short next to the
/// 0.05 s for which an LBR iiwa's acceleration builds up, long enough for an encoder's noise.
const HALF_S: f64 = 0.02;

/// The cubic has at least so many samples before and after.
const HALF_SAMPLES: f64 = 4.0;

/// Cubics at most: of an hour. No screen shows more of them.
const CUBICS: f64 = 900_000.0;

/// Position, velocity, acceleration and jerk of a recording.
#[derive(Debug)]
pub(crate) struct Measured {
    pub(crate) position: Samples,
    pub(crate) velocity: Samples,
    pub(crate) acceleration: Samples,
    pub(crate) jerk: Samples,
    /// Half of the window of the cubics, in s.
    pub(crate) half_s: f64,
}

impl Measured {
    pub(crate) fn new(log: &JointLog) -> Self {
        let gaps = gaps(log);
        let half_s = HALF_S.max(HALF_SAMPLES * log.period_s().unwrap_or(0.0));
        let mut measured = Self {
            position: with_gaps(&log.t_s, log.q_rad.iter().copied(), &gaps),
            velocity: Samples::default(),
            acceleration: Samples::default(),
            jerk: Samples::default(),
            half_s,
        };
        let (Some(first), Some(last)) = (log.t_s.first(), log.t_s.last()) else { return measured };
        // No cubic is whole.
        if last - first < 2.0 * half_s {
            return measured;
        }
        let joints: Vec<Vec<f64>> =
            (0..7).map(|j| log.q_rad.iter().map(|q| q[j]).collect()).collect();
        // A cubic changes little in a fifth of its window: no peak is between two of them.
        let step_s = (0.2 * half_s).max(log.period_s().unwrap_or(half_s));
        // Where samples are days apart, there is nothing in between.
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

/// Velocities, accelerations and jerks at a time; not numbers where a gap is in the window.
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

/// From where to where there are no samples, in s.
fn gaps(log: &JointLog) -> Vec<(f64, f64)> {
    let gap = |loss: &Loss| match loss {
        Loss::Gap { from_s, to_s, .. } => Some((*from_s, *to_s)),
        _ => None,
    };
    log.losses.iter().filter_map(gap).collect()
}

/// What the joints of a plan or a recording exert, in Nm, as far as the file has it.
pub(crate) fn torques(log: &JointLog) -> Samples {
    let known = |torque_nm: Option<Joints>| torque_nm.unwrap_or([f64::NAN; 7]);
    with_gaps(&log.t_s, log.exerted_nm().map(known), &gaps(log))
}

/// The samples, and in each gap one that is not a number.
fn with_gaps(t_s: &[f64], rows: impl Iterator<Item = Joints>, gaps: &[(f64, f64)]) -> Samples {
    let mut samples = Samples::default();
    let mut gaps = gaps.iter().peekable();
    for (t_s, row) in t_s.iter().zip(rows) {
        samples.push(*t_s, row);
        if let Some((from_s, to_s)) = gaps.next_if(|(from_s, _)| from_s <= t_s) {
            samples.push(f64::midpoint(*from_s, *to_s), [f64::NAN; 7]);
        }
    }
    samples
}
