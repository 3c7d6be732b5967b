//! Curves of a plan, from the nodes of its trajectory.

use iiwa_kin::Joints;
use iiwa_log::PlanNode;

use super::curve::TimeSeries;

/// Longest step between two samples, in s, unless this gives too many samples.
const STEP_S: f64 = 0.004;

/// Maximum number of samples of a plan in addition to its nodes: half an hour. More are not visible
/// on a screen.
const SAMPLES: f64 = 450_000.0;

/// Shortest step between nodes, in s, for which velocities determine the change of the jerk: times
/// are rounded to nanoseconds.
const MIN_S: f64 = 0.002;

/// Position, velocity, acceleration, jerk and snap of a plan.
#[derive(Debug, Default)]
pub(crate) struct PlannedCurves {
    pub(crate) position: TimeSeries,
    pub(crate) velocity: TimeSeries,
    pub(crate) acceleration: TimeSeries,
    /// Jerk; like the snap, without samples if the acceleration jumps.
    pub(crate) jerk: TimeSeries,
    /// Snap, piecewise constant.
    pub(crate) snap: TimeSeries,
}

impl PlannedCurves {
    /// Samples a plan at its nodes, and between distant nodes.
    ///
    /// With jerk limits (`smooth`), velocity is a cubic between nodes, so jerk is linear and snap
    /// constant there: exact on lines, where either jerk or snap is constant between nodes. Without
    /// jerk limits, acceleration is constant between nodes, and jumps at nodes.
    pub(crate) fn new(nodes: &[PlanNode], smooth: bool) -> Self {
        let ends = nodes.first().zip(nodes.last());
        let whole_s = ends.map_or(0.0, |(first, last)| last.t_s - first.t_s);
        let step_s = STEP_S.max(whole_s / SAMPLES);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
        let steps = |span_s: f64| (span_s / step_s).ceil().max(1.0) as u32;
        let spans = nodes.windows(2).map(|pair| pair[1].t_s - pair[0].t_s);
        // Growing lists of this length would temporarily need twice the memory.
        let count = spans.map(|span_s| steps(span_s) as usize).sum::<usize>() + 1;
        let samples = |count| TimeSeries::with_capacity(count);
        let both_ends = 2 * nodes.len();
        let mut planned = Self {
            position: samples(count),
            velocity: samples(count),
            acceleration: samples(if smooth { count } else { count + nodes.len() }),
            jerk: samples(if smooth { both_ends } else { 0 }),
            snap: samples(if smooth { both_ends } else { 0 }),
        };
        for pair in nodes.windows(2) {
            let (from, to) = (&pair[0], &pair[1]);
            let span_s = to.t_s - from.t_s;
            let steps = steps(span_s);
            let jerks: [[f64; 2]; 7] = std::array::from_fn(|j| {
                jerk_at_ends(span_s, [from.dq[j], from.ddq[j]], [to.dq[j], to.ddq[j]])
            });
            for i in 0..steps {
                let share = f64::from(i) / f64::from(steps);
                let t_s = from.t_s + share * span_s;
                let ddq: Joints = std::array::from_fn(|j| {
                    let [a, b] = if smooth { jerks[j] } else { [0.0; 2] };
                    let passed_s = share * span_s;
                    from.ddq[j] + passed_s * (a + 0.5 * share * (b - a))
                });
                planned.position.push(
                    t_s,
                    std::array::from_fn(|j| {
                        hermite(share, span_s, [from.q[j], from.dq[j]], [to.q[j], to.dq[j]])
                    }),
                );
                planned.velocity.push(
                    t_s,
                    std::array::from_fn(|j| {
                        if smooth {
                            hermite(share, span_s, [from.dq[j], from.ddq[j]], [to.dq[j], to.ddq[j]])
                        } else {
                            from.dq[j] + share * (to.dq[j] - from.dq[j])
                        }
                    }),
                );
                planned.acceleration.push(t_s, ddq);
            }
            if smooth {
                let snap = jerks.map(|[a, b]| (b - a) / span_s);
                for (end, t_s) in [from.t_s, to.t_s].into_iter().enumerate() {
                    planned.jerk.push(t_s, jerks.map(|jerk| jerk[end]));
                    planned.snap.push(t_s, snap);
                }
            } else {
                // A step, not a ramp to the next node.
                planned.acceleration.push(to.t_s, from.ddq);
            }
        }
        if let Some(last) = nodes.last() {
            planned.position.push(last.t_s, last.q);
            planned.velocity.push(last.t_s, last.dq);
            planned.acceleration.push(last.t_s, last.ddq);
        }
        planned
    }
}

/// Returns the jerk at both ends of a time span, for the cubic with these velocities and
/// accelerations.
fn jerk_at_ends(span_s: f64, [v, a]: [f64; 2], [v_end, a_end]: [f64; 2]) -> [f64; 2] {
    let mean = (a_end - a) / span_s;
    if span_s < MIN_S {
        return [mean; 2];
    }
    // Excess of the mean acceleration over that of a linear course.
    let above = 6.0 * ((v_end - v) / span_s - 0.5 * (a + a_end)) / span_s;
    [mean + above, mean - above]
}

/// Evaluates the cubic with these values and slopes at both ends of a span.
fn hermite(x: f64, span: f64, [a, da]: [f64; 2], [b, db]: [f64; 2]) -> f64 {
    let (da, db) = (da * span, db * span);
    let rise = b - a;
    a + x * (da + x * (3.0 * rise - 2.0 * da - db + x * (da + db - 2.0 * rise)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tests a plan at a millionth of full speed, with months between two nodes.
    #[test]
    fn long_plans_have_no_more_samples() {
        let node = |t_s: f64| PlanNode { t_s, q: [t_s * 1e-7; 7], dq: [1e-7; 7], ddq: [0.0; 7] };
        let planned = PlannedCurves::new(&[node(0.0), node(0.1), node(1e7)], true);
        let count = planned.position.t_s.len();
        assert!((100_000..=450_100).contains(&count), "{count}");
        assert_eq!(planned.position.t_s.last(), Some(&1e7));
    }

    #[test]
    fn cubics_are_met() {
        // q = t^3 + t: all derivatives are known.
        let node = |t: f64| PlanNode {
            t_s: t,
            q: [t.powi(3) + t; 7],
            dq: [3.0 * t * t + 1.0; 7],
            ddq: [6.0 * t; 7],
        };
        let planned = PlannedCurves::new(&[node(0.0), node(0.5), node(0.501)], true);
        assert_eq!(planned.position.t_s.len(), 127);
        for (i, t) in planned.position.t_s.iter().enumerate() {
            let expected = node(*t);
            assert!((planned.position.rows[i][3] - expected.q[3]).abs() < 1e-12);
            assert!((planned.velocity.rows[i][3] - expected.dq[3]).abs() < 1e-12);
            assert!((planned.acceleration.rows[i][3] - expected.ddq[3]).abs() < 1e-12);
        }
        assert!(planned.jerk.rows.iter().all(|row| (row[0] - 6.0).abs() < 1e-9));
        assert!(planned.snap.rows.iter().all(|row| row[0].abs() < 1e-9));
        let jumps = PlannedCurves::new(&[node(0.0), node(0.5)], false);
        assert!(jumps.jerk.rows.is_empty() && jumps.snap.rows.is_empty());
        assert_eq!(jumps.acceleration.rows[10], [0.0; 7]);
    }

    /// Tests a ramp with constant snap, as Sunrise begins it.
    #[test]
    fn constant_snap_is_met() {
        let node = |t: f64| PlanNode {
            t_s: t,
            q: [t.powi(4) / 24.0; 7],
            dq: [t.powi(3) / 6.0; 7],
            ddq: [0.5 * t * t; 7],
        };
        // The last span is too short to resolve the change of the jerk: only its mean is
        // determined.
        let planned = PlannedCurves::new(&[node(0.0), node(0.06), node(0.061)], true);
        for (t_s, row) in std::iter::zip(&planned.acceleration.t_s, &planned.acceleration.rows) {
            assert!((row[6] - 0.5 * t_s * t_s).abs() < 1e-12, "{t_s} s: {}", row[6]);
        }
        let [jerk, snap] = [&planned.jerk, &planned.snap]
            .map(|samples| samples.rows.iter().map(|row| row[2]).collect::<Vec<_>>());
        for (actual, expected) in std::iter::zip(jerk, [0.0, 0.06, 0.0605, 0.0605]) {
            assert!((actual - expected).abs() < 1e-12, "{actual}");
        }
        for (actual, expected) in std::iter::zip(snap, [1.0, 1.0, 0.0, 0.0]) {
            assert!((actual - expected).abs() < 1e-9, "{actual}");
        }
    }
}
