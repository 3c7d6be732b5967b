//! When the arm leaves a stop and when it arrives at one.
//!
//! A ramp begins so gently that noise hides it: with a jerk of 180 rad/s^3 and noise of 1e-5 rad the arm
//! is 10 ms on its way before a threshold would notice. So the time is found from where the arm is well
//! seen, just after: the way is set against how the plan goes that way, or, if that does not fit, against
//! ramps of constant jerk and acceleration, and the line through the points is followed back to where the
//! way is zero.

use iiwa_kin::{
    Joints,
    vector::{distance, dot, norm, scale, sub},
};
use iiwa_log::JointLog;

use super::curve::Curve;
use super::noise::Noise;
use crate::quantile::median;

/// The way over which a ramp is looked at, in rad, if noise does not ask for more.
const WAY_RAD: f64 = 3e-3;

/// Farther than this from where it should, the arm does not stand for this stop, in rad.
pub(super) const STANDS_RAD: f64 = 5e-3;

/// The least samples of a ramp.
const SAMPLES: usize = 5;

/// Leaving a stop or arriving at one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Leaves,
    Arrives,
}

/// The instant of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Edge {
    /// In s of the recording.
    pub(crate) t_s: f64,
    /// Standard deviation due to noise, in s.
    pub(crate) deviation_s: f64,
    /// The longest time without a sample around it: from, to.
    pub(crate) gap_s: (f64, f64),
    /// Whether the arm was seen to stand.
    pub(crate) stands: bool,
}

/// A stop in the plan.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stop<'a> {
    pub(crate) curve: &'a Curve,
    /// When the plan leaves it or arrives, in s.
    pub(crate) at_s: f64,
    /// The length of the leg after it or before it, in rad.
    pub(crate) leg_rad: f64,
    /// The leg's mean speed in the plan, in rad/s.
    pub(crate) speed_rad_s: f64,
    /// For how long the plan stands there, in s.
    pub(crate) stand_s: f64,
    pub(crate) side: Side,
}

/// Why an edge was not found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unclear {
    /// The sample that is nearest to the stop, in s of the recording.
    pub(crate) t_s: f64,
    /// How far away it is, in rad.
    pub(crate) distance_rad: f64,
}

impl Stop<'_> {
    /// Finds when the arm leaves or arrives, within some samples about the stop.
    pub(crate) fn find(
        &self,
        log: &JointLog,
        samples: std::ops::Range<usize>,
        noise: &Noise,
    ) -> Result<Edge, Unclear> {
        let knot = self.knot();
        let planned = self.curve.knots()[knot].q;
        let away = |i: &usize| distance(&log.q_rad[*i], &planned);
        let nearest = samples.clone().min_by(|a, b| away(a).total_cmp(&away(b)));
        let Some(nearest) = nearest else {
            return Err(Unclear { t_s: f64::NAN, distance_rad: f64::INFINITY });
        };
        let unclear = Unclear { t_s: log.t_s[nearest], distance_rad: away(&nearest) };
        let near = away(&nearest) + STANDS_RAD + 20.0 * noise.norm_rad();
        let from = samples.clone().find(|i| away(i) <= near).unwrap_or(nearest);
        let to = samples.rev().find(|i| away(i) <= near).unwrap_or(nearest) + 1;
        let (rest, at, stands) = match self.stand(log, from..to, noise, &planned) {
            Some((rest, at)) => (rest, at, true),
            // The recording is cut to the motion.
            None if unclear.distance_rad <= 1e-4 + 20.0 * noise.norm_rad() => {
                (planned, nearest, false)
            }
            None => return Err(unclear),
        };
        self.ramp(log, knot, &rest, at, noise).map(|edge| Edge { stands, ..edge }).ok_or(unclear)
    }

    /// The node of the plan at the stop.
    fn knot(&self) -> usize {
        let knots = self.curve.knots();
        let after = knots.partition_point(|knot| knot.t_s < self.at_s);
        let nearer = |k: &usize| knots.get(*k).map_or(f64::MAX, |k| (k.t_s - self.at_s).abs());
        let before = after.saturating_sub(1);
        if nearer(&before) < nearer(&after) { before } else { after.min(knots.len() - 1) }
    }

    /// Where the arm stands, and the sample of the stand next to the ramp.
    fn stand(
        &self,
        log: &JointLog,
        samples: std::ops::Range<usize>,
        noise: &Noise,
        planned: &Joints,
    ) -> Option<(Joints, usize)> {
        let window_s = (0.8 * self.stand_s).clamp(0.02, 0.5);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 1e6")]
        let half =
            ((0.5 * window_s / noise.step_s).clamp(2.0, 1e6) as usize).min(samples.len() / 2);
        if half < 2 {
            return None;
        }
        let count = 2 * half;
        // By how much the means of the halves of a window differ, while the arm stands.
        let noise_of_mean = noise.norm_rad() / (half as f64).sqrt();
        let still = 3.0 * std::f64::consts::SQRT_2 * noise_of_mean + 2e-6;
        // Creeping is not standing, even at a tenth of the planned speed.
        let still = still.min(0.1 * self.speed_rad_s * half as f64 * noise.step_s);
        let q = |i: usize| &log.q_rad[i];
        let mut differences = HalfMeans::new(log, samples.start, half);
        let mut found = None;
        for at in samples.start..=samples.end - count {
            if differences.norm() <= still {
                found = Some(at);
                if self.side == Side::Arrives {
                    break;
                }
            }
            if at < samples.end - count {
                differences.advance();
            }
        }
        let at = found?;
        let mut rest: Joints = std::array::from_fn(|j| {
            let mut values: Vec<f64> = (at..at + count).map(|i| q(i)[j]).collect();
            median(&mut values)
        });
        if distance(&rest, planned) <= 3.0 * noise_of_mean + 1e-6 {
            rest = *planned;
        }
        Some((rest, if self.side == Side::Leaves { at } else { at + count - 1 }))
    }

    /// Fits the ramp next to a stand; `at` is a sample of the stand.
    fn ramp(
        &self,
        log: &JointLog,
        knot: usize,
        rest: &Joints,
        at: usize,
        noise: &Noise,
    ) -> Option<Edge> {
        let (curve, leaves) = (self.curve, self.side == Side::Leaves);
        let sign = if leaves { 1.0 } else { -1.0 };
        let unit = self.direction(knot)?;
        let sigma = noise.along_rad(&unit);
        let top = WAY_RAD.max(100.0 * sigma).min(0.25 * self.leg_rad);
        let way = |i: usize| sign * dot(&sub(&log.q_rad[i], rest), &unit);
        let step = |i: usize| {
            let next = if leaves { i + 1 } else { i.checked_sub(1)? };
            (next < log.t_s.len()).then_some(next)
        };
        // From the stand up the ramp; then what of it is above the noise.
        let mut ramp = Vec::new();
        let mut last_rest = at;
        let mut i = at;
        while let Some(next) = step(i) {
            i = next;
            let p = way(i);
            if p <= 5.0 * sigma + 1e-12 {
                ramp.clear();
                last_rest = i;
                continue;
            }
            // Coarse samples take what they need of the leg, up to half of it.
            if p > top && (ramp.len() >= SAMPLES || p > 0.5 * self.leg_rad) {
                break;
            }
            ramp.push((i, p));
            if p > top && ramp.len() >= SAMPLES {
                break;
            }
        }
        let plan_time = |p: f64| {
            let t_s = curve.time_along(knot, leaves, &unit, sign * p)?;
            let speed = dot(&curve.at(t_s).1, &unit);
            Some((sign * (t_s - curve.knots()[knot].t_s), speed))
        };
        let fit = |law: &dyn Fn(f64) -> Option<(f64, f64)>| {
            Line::fit(ramp.iter().filter_map(|&(i, p)| {
                let (tau, speed) = law(p)?;
                Some((tau, sign * log.t_s[i], speed * speed))
            }))
        };
        let as_planned = fit(&plan_time);
        let best = |a: Line, b: Line| if b.miss() < a.miss() { b } else { a };
        let any = BENDS_RAD.into_iter().filter_map(|bend| fit(&|p| Some(ramp_law(p, bend))));
        let any = any.filter(|line| line.points >= 4).reduce(best);
        let line = match (as_planned, any) {
            // Other than planned only if the plan's law is clearly not that of the arm: if noise made
            // it fit so much worse once in a thousand times, or less.
            (Some(plan), Some(other)) if plan.misfit(sigma.max(other.miss())) > 12.0 => other,
            (Some(line), _) | (None, Some(line)) => line,
            (None, None) => return None,
        };
        let first = ramp.first()?.0;
        let mut gap = (log.t_s[last_rest.min(first)], log.t_s[last_rest.max(first)]);
        for pair in ramp.windows(2) {
            let (a, b) = (pair[0].0.min(pair[1].0), pair[0].0.max(pair[1].0));
            if log.t_s[b] - log.t_s[a] > gap.1 - gap.0 {
                gap = (log.t_s[a], log.t_s[b]);
            }
        }
        Some(Edge {
            t_s: sign * line.zero,
            deviation_s: line.deviation(sigma),
            gap_s: gap,
            stands: true,
        })
    }

    /// The direction of the leg at the stop.
    fn direction(&self, knot: usize) -> Option<Joints> {
        let curve = self.curve;
        let knots = curve.knots();
        let far = (0.1 * self.leg_rad).min(0.01);
        let arc = curve.arc(knot);
        let mut k = knot;
        // The farthest node that is not beyond, or the next one.
        loop {
            let next = if self.side == Side::Leaves { k + 1 } else { k.checked_sub(1)? };
            if next >= knots.len() {
                break;
            }
            if k != knot && (curve.arc(next) - arc).abs() > far && (curve.arc(k) - arc).abs() > 0.0
            {
                break;
            }
            k = next;
            if (curve.arc(k) - arc).abs() > far {
                break;
            }
        }
        let to = sub(&knots[k].q, &knots[knot].q);
        let length = norm(&to);
        let sign = if self.side == Side::Leaves { 1.0 } else { -1.0 };
        (length > 0.0).then(|| scale(sign / length, &to))
    }
}

/// The ways after which a ramp's acceleration may have stopped to grow, in rad: from one that is at its
/// acceleration from the first sample on to one of constant jerk throughout.
const BENDS_RAD: [f64; 14] =
    [1e-9, 3e-6, 1e-5, 2e-5, 5e-5, 1e-4, 2e-4, 3e-4, 5e-4, 8e-4, 1.3e-3, 2e-3, 3e-3, 1.0];

/// The time for a way `p` from standstill with constant jerk up to the way `bend`, and with constant
/// acceleration from then on, in units of the time to the bend; and the speed there in units of way.
fn ramp_law(p: f64, bend: f64) -> (f64, f64) {
    let y = p / bend;
    if y <= 1.0 {
        // y = tau^3
        let tau = y.cbrt();
        (tau, 3.0 * bend * tau * tau)
    } else {
        // y = tau^3 - (tau - 1)^3
        let tau = 0.5 + (12.0 * y - 3.0).sqrt() / 6.0;
        (tau, 3.0 * bend * (2.0 * tau - 1.0))
    }
}

/// The means of the two halves of a window that moves on.
struct HalfMeans<'a> {
    log: &'a JointLog,
    at: usize,
    half: usize,
    /// Sum of the second half minus sum of the first one.
    difference: Joints,
}

impl<'a> HalfMeans<'a> {
    fn new(log: &'a JointLog, at: usize, half: usize) -> Self {
        let mut means = Self { log, at, half, difference: [0.0; 7] };
        means.sum();
        means
    }

    fn sum(&mut self) {
        let (q, half) = (&self.log.q_rad[self.at..], self.half);
        self.difference =
            std::array::from_fn(|j| (0..half).map(|i| q[i + half][j] - q[i][j]).sum());
    }

    fn advance(&mut self) {
        let (q, half) = (&self.log.q_rad[self.at..], self.half);
        let (first, middle, last) = (&q[0], &q[half], &q[2 * half]);
        for j in 0..7 {
            self.difference[j] += first[j] - 2.0 * middle[j] + last[j];
        }
        self.at += 1;
        // Rounding does not add up.
        if self.at.is_multiple_of(1000) {
            self.sum();
        }
    }

    fn norm(&self) -> f64 {
        norm(&self.difference) / self.half as f64
    }
}

/// A line t = zero + slope tau through weighted points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    /// t where tau is 0.
    pub(crate) zero: f64,
    slope: f64,
    points: usize,
    /// Sum of weighted squares of what is left.
    left: f64,
    /// Sums of w, w tau, w tau^2.
    sums: [f64; 3],
}

impl Line {
    /// Through points (tau, t, weight). A single one is passed with slope 1. None without points, or if
    /// t falls with tau.
    pub(crate) fn fit(points: impl Iterator<Item = (f64, f64, f64)>) -> Option<Self> {
        let points: Vec<_> = points.filter(|point| point.2 > 0.0).collect();
        let [first, .., last] = points[..] else {
            let (tau, t, w) = *points.first()?;
            let sums = [w, w * tau, w * tau * tau];
            return Some(Self { zero: t - tau, slope: 1.0, points: 1, left: 0.0, sums });
        };
        // About the first point: times of a clock are large.
        let (tau0, t0) = (first.0, first.1);
        let mut s = [0.0; 5];
        for &(tau, t, w) in &points {
            let (tau, t) = (tau - tau0, t - t0);
            for (sum, term) in s.iter_mut().zip([w, w * tau, w * tau * tau, w * t, w * tau * t]) {
                *sum += term;
            }
        }
        let determinant = s[0] * s[2] - s[1] * s[1];
        if determinant <= 1e-12 * s[0] * s[2] || last.0 == first.0 {
            return None;
        }
        let slope = (s[0] * s[4] - s[1] * s[3]) / determinant;
        let offset = (s[3] - slope * s[1]) / s[0];
        if slope <= 0.0 {
            return None;
        }
        let miss =
            |&(tau, t, w): &(f64, f64, f64)| w * (t - t0 - offset - slope * (tau - tau0)).powi(2);
        let left = points.iter().map(miss).sum();
        let zero = t0 + offset - slope * tau0;
        let moved = [s[0], s[1] + tau0 * s[0], s[2] + 2.0 * tau0 * s[1] + tau0 * tau0 * s[0]];
        Some(Self { zero, slope, points: points.len(), left, sums: moved })
    }

    /// What is left of the way, root mean square, in rad.
    fn miss(&self) -> f64 {
        (self.left / self.points as f64).sqrt() / self.slope
    }

    /// How much worse it fits than noise would have it: chi squared, less the number of points.
    fn misfit(&self, sigma: f64) -> f64 {
        (self.miss() / sigma.max(1e-12)).powi(2) * self.points as f64 - self.points as f64
    }

    /// Standard deviation of where tau is 0, when the way has that of noise, in s.
    fn deviation(&self, sigma: f64) -> f64 {
        let [w, wt, wtt] = self.sums;
        let sigma = sigma.max(self.miss());
        let determinant = w * wtt - wt * wt;
        if self.points < 2 || determinant <= 0.0 {
            return sigma / w.sqrt();
        }
        sigma * self.slope * (wtt / determinant).sqrt()
    }
}
