//! Check of the velocity, acceleration and jerk limits, from rest to rest, by divided differences.
//!
//! A divided difference is a mean of the derivative: if a motion satisfies its limits, so do all
//! differences of its points, for any stamps. From each point, differences are computed over
//! several time spans, which are chosen so that neither dense nor uneven stamps conceal an excess.

use iiwa_kin::{Joints, Limits};

use super::points::TimedJoints;
use crate::message::{
    refusal::{Code, Refusal},
    text::Figures,
};

/// Permitted excess over the velocity, acceleration and jerk limits, as a share of the limits.
///
/// Planners satisfy limits exactly at sampling points and approximately in between; an excess
/// beyond these margins is not a rounding error.
pub const MARGINS: [f64; 3] = [0.02, 0.05, 0.10];

/// Time spans between the points of a difference, in s. A third-order difference covers three
/// spans, and the jerk is seldom at its limit for longer than 30 to 60 ms, the time in which the
/// joints of an LBR iiwa reach their acceleration limits. Over shorter spans, rounding has more
/// effect.
const SPANS_S: [f64; 6] = [0.001, 0.003, 0.006, 0.009, 0.012, 0.024];

/// Tolerated rounding error of positions with six decimals, in rad.
const ROUNDING_RAD: f64 = 0.5e-6;

/// Tolerated rounding error of stamps with six decimals, in s.
const ROUNDING_S: f64 = 0.5e-6;

/// Derivative names and units in messages.
const KINDS: [(&str, &str); 3] =
    [("velocity", "deg/s"), ("acceleration", "deg/s^2"), ("jerk", "deg/s^3")];

/// Refuses the first velocity excess, otherwise the first acceleration excess, otherwise the first
/// jerk excess. Requires at least two points with increasing stamps.
pub(super) fn check(trajectory: &TimedJoints, limits: &Limits) -> Result<(), Refusal> {
    let points = Points::new(trajectory);
    let mut excesses = [None; 3];
    let limits = [limits.velocity_rad_s, limits.acceleration_rad_s2, limits.jerk_rad_s3];
    for span_s in SPANS_S {
        points.find_excesses(span_s, &limits, &mut excesses);
    }
    let first = excesses.iter().enumerate().find_map(|(order, excess)| Some((order, (*excess)?)));
    match first {
        None => Ok(()),
        Some((order, excess)) => Err(points.refusal(order, excess, limits[order][excess.joint])),
    }
}

#[derive(Clone, Copy)]
struct Excess {
    /// The first and the last point of the difference.
    ends: [usize; 2],
    joint: usize,
    found: f64,
}

/// The points, extended by points at rest before and after.
struct Points {
    /// Time from the start, in s.
    t_s: Vec<f64>,
    joints_rad: Vec<Joints>,
    /// Number of added points before the first one.
    before: usize,
    /// Number of added points after the last one.
    after: usize,
}

impl Points {
    fn new(trajectory: &TimedJoints) -> Self {
        let TimedJoints { t_s: stamps, joints_rad } = trajectory;
        let (count, start_s) = (stamps.len(), stamps[0]);
        let (first, last) = (joints_rad[0], joints_rad[count - 1]);
        let end_s = trajectory.duration_s();
        let [before, after] =
            [stamps[1] - start_s, stamps[count - 1] - stamps[count - 2]].map(rest);
        let whole = before.len() + count + after.len();
        let mut points = Self {
            t_s: Vec::with_capacity(whole),
            joints_rad: Vec::with_capacity(whole),
            before: before.len(),
            after: after.len(),
        };
        // Relative to the start: short times added to large stamps would lose digits.
        points.t_s.extend(before.iter().rev().map(|t_s| -t_s));
        points.t_s.extend(stamps.iter().map(|stamp| stamp - start_s));
        points.t_s.extend(after.iter().map(|t_s| end_s + t_s));
        points.joints_rad.resize(before.len(), first);
        points.joints_rad.extend_from_slice(joints_rad);
        points.joints_rad.resize(whole, last);
        points
    }

    /// Computes the differences over `span_s` from each point, and stores the first excess of each
    /// order.
    fn find_excesses(&self, span_s: f64, limits: &[Joints; 3], excesses: &mut [Option<Excess>; 3]) {
        // Stamps are sums: a step of 1 ms may be slightly shorter.
        let at_least_s = 0.999 * span_s;
        let maxima: [Joints; 3] =
            std::array::from_fn(|order| limits[order].map(|limit| limit * (1.0 + MARGINS[order])));
        let rounding_rad = limits[0].map(|speed| ROUNDING_RAD + speed * ROUNDING_S);
        let mut place = [0; 4];
        for start in 0..self.t_s.len() {
            place[0] = start;
            for k in 1..4 {
                // Places only move forward, so that a long trajectory is checked in linear time.
                place[k] = place[k].max(place[k - 1] + 1);
                let from_s = self.t_s[place[k - 1]];
                while self.t_s.get(place[k]).is_some_and(|t_s| t_s - from_s < at_least_s) {
                    place[k] += 1;
                }
                if place[k] >= self.t_s.len() {
                    // All further points are at rest.
                    return;
                }
            }
            let t = place.map(|i| self.t_s[i]);
            let q = place.map(|i| &self.joints_rad[i]);
            // The largest effect of a rounding error of 1 on each order.
            let (h, g) = ([t[1] - t[0], t[2] - t[1], t[3] - t[2]], [t[2] - t[0], t[3] - t[1]]);
            let e1 = h.map(|h| 2.0 / h);
            let e2 = [2.0 * (e1[0] + e1[1]) / g[0], 2.0 * (e1[1] + e1[2]) / g[1]];
            let errors = [e1[0], e2[0], 3.0 * (e2[0] + e2[1]) / (t[3] - t[0])];
            let differences: [Joints; 3] = {
                let d1: [Joints; 3] = std::array::from_fn(|k| divided(q[k], q[k + 1], 1.0 / h[k]));
                let d2: [Joints; 2] =
                    std::array::from_fn(|k| divided(&d1[k], &d1[k + 1], 2.0 / g[k]));
                [d1[0], d2[0], divided(&d2[0], &d2[1], 3.0 / (t[3] - t[0]))]
            };
            for order in 0..3 {
                let (difference, limit, error) =
                    (&differences[order], &maxima[order], errors[order]);
                // Not `>`: a NaN difference is an excess.
                let fits = |j: usize| difference[j].abs() <= limit[j] + rounding_rad[j] * error;
                if excesses[order].is_none() && !(0..7).all(fits) {
                    let joint = (0..7).find(|j| !fits(*j)).unwrap_or_default();
                    let found = difference[joint].abs();
                    let ends = [start, place[order + 1]];
                    excesses[order] = Some(Excess { ends, joint, found });
                }
            }
        }
    }

    fn refusal(&self, order: usize, excess: Excess, limit: f64) -> Refusal {
        let Excess { ends: [from, to], joint, found } = excess;
        let last = self.t_s.len() - 1 - self.after;
        let hint = if from < self.before {
            "; a trajectory has to start at rest"
        } else if to > last {
            "; a trajectory has to end at rest"
        } else {
            ""
        };
        let place = from.clamp(self.before, last);
        let (kind, unit) = KINDS[order];
        Refusal::new(
            Code::Limit,
            format!(
                "point {}, at {:.4} s: the {kind} of joint A{} is {} {unit}, its limit is {:.1} \
                 {unit} and the margin {} %{hint}",
                place - self.before + 1,
                self.t_s[place],
                joint + 1,
                Figures(found.to_degrees(), 1),
                limit.to_degrees(),
                (MARGINS[order] * 100.0).round(),
            ),
        )
    }
}

/// Returns the times of the points at rest after a last step, in s: enough for all differences from
/// the last point.
fn rest(step_s: f64) -> Vec<f64> {
    let [shortest_s, .., longest_s] = SPANS_S;
    // The lower bound limits the number of points after a tiny step.
    let step_s = step_s.clamp(shortest_s, longest_s);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 75")]
    let count = (3.0 * longest_s / step_s).ceil() as u32 + 3;
    (1..=count).map(|i| f64::from(i) * step_s).collect()
}

fn divided(from: &Joints, to: &Joints, by: f64) -> Joints {
    std::array::from_fn(|j| (to[j] - from[j]) * by)
}
