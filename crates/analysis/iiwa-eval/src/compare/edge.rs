//! Times of departure from and arrival at a stop.
//!
//! A ramp begins so gently that noise hides it: with a jerk of 180 rad/s^3 and noise of 1e-5 rad, a
//! threshold would notice the motion 10 ms late. Therefore the time is extrapolated from the
//! clearly visible samples just after: their way is compared with the planned one or, if that does
//! not fit, with ramps of constant jerk and acceleration, and the fitted line is followed back to
//! zero way.

use iiwa_kin::{
    Joints,
    vector::{add_scaled, distance, dot, norm, scale, sub},
};
use iiwa_log::JointLog;

use super::curve::Curve;
use super::start_fit::StartFit;
use crate::noise::RecordingNoise;
use crate::quantile::median;

/// Evaluated length of a ramp, in rad, unless noise requires more.
const WAY_RAD: f64 = 3e-3;

/// Distance from the planned position up to which a rest belongs to the stop, in rad.
pub(super) const REST_RAD: f64 = 5e-3;

/// Largest constant offset of a recording at a stop, in rad: the largest distance from the plan's
/// start at which a program is found in a recording.
const OFFSET_RAD: f64 = super::follow::ENDS_RAD;

/// Distance from the path, in rad, above which (if also above the noise) the robot does not track
/// its set-points exactly.
const TRACKS_RAD: f64 = 5e-6;

/// Allowed differences between the means of the halves of a window at rest, in rad. A robot that
/// has just braked sways; the larger values are tried only if it is never as still as the first one
/// requires.
const SWAYS_RAD: [f64; 3] = [2e-6, 1e-5, 5e-5];

/// Minimum number of samples of a ramp.
const SAMPLES: usize = 5;

/// Departure or arrival.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Leaves,
    Arrives,
}

/// Instant of departure or arrival.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Edge {
    /// Time, in s, on the recording's clock.
    pub(crate) t_s: f64,
    /// Standard deviation due to noise, in s.
    pub(crate) deviation_s: f64,
    /// Longest time without a sample around the instant: from, to.
    pub(crate) gap_s: (f64, f64),
    /// `true` if a rest was recorded.
    pub(crate) stands: bool,
    /// Distance of the recorded rest from the planned position, in rad.
    pub(crate) offset_rad: f64,
}

/// Stop in the plan.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlannedStop<'a> {
    pub(crate) curve: &'a Curve,
    /// Planned time of departure or arrival, in s.
    pub(crate) at_s: f64,
    /// Length of the leg after or before the stop, in rad.
    pub(crate) leg_rad: f64,
    /// Mean planned speed of the leg, in rad/s.
    pub(crate) speed_rad_s: f64,
    /// Planned duration of the rest, in s.
    pub(crate) stand_s: f64,
    pub(crate) side: Side,
}

/// Failure to find an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unclear {
    /// Time of the sample nearest to the stop, in s, on the recording's clock.
    pub(crate) t_s: f64,
    /// Distance of that sample, in rad.
    pub(crate) distance_rad: f64,
    /// Rest far from the planned position: its time, in s, on the recording's clock, and its
    /// distance, in rad.
    pub(crate) rest_elsewhere: Option<(f64, f64)>,
}

impl PlannedStop<'_> {
    /// Finds the time of departure or arrival, within a range of samples around the stop.
    pub(crate) fn find(
        &self,
        log: &JointLog,
        samples: std::ops::Range<usize>,
        noise: &RecordingNoise,
    ) -> Result<Edge, Unclear> {
        let knot = self.knot();
        let planned = self.curve.knots()[knot].q;
        let away = |i: &usize| distance(&log.q_rad[*i], &planned);
        let nearest = samples.clone().min_by(|a, b| away(a).total_cmp(&away(b)));
        let Some(nearest) = nearest else {
            let (t_s, distance_rad) = (f64::NAN, f64::INFINITY);
            return Err(Unclear { t_s, distance_rad, rest_elsewhere: None });
        };
        let near = away(&nearest) + REST_RAD + 20.0 * noise.norm_rad();
        let from = samples.clone().find(|i| away(i) <= near).unwrap_or(nearest);
        let to = samples.clone().rev().find(|i| away(i) <= near).unwrap_or(nearest) + 1;
        let stand = |range, sway_rad| self.stand(log, range, noise, &planned, sway_rad);
        let [still, swaying @ ..] = SWAYS_RAD;
        let at_stop = stand(from..to, still);
        // With a constant offset of the recording, the robot may pass the planned position in
        // motion: its rest is then farther away than the nearest samples.
        let beside = if at_stop.is_none() { stand(samples, still) } else { None };
        let is_offset = |rest: &Joints| distance(rest, &planned) <= OFFSET_RAD;
        let unclear = Unclear {
            t_s: log.t_s[nearest],
            distance_rad: away(&nearest),
            rest_elsewhere: beside
                .filter(|(rest, _)| !is_offset(rest))
                .map(|(rest, index)| (log.t_s[index], distance(&rest, &planned))),
        };
        let rests = |found: (Joints, usize)| (found.0, found.1, true);
        // The recording may be cut to the motion.
        let is_cut = unclear.distance_rad <= 1e-4 + 20.0 * noise.norm_rad();
        let place = at_stop
            .or_else(|| beside.filter(|(rest, _)| is_offset(rest)))
            .map(rests)
            .or_else(|| is_cut.then_some((planned, nearest, false)))
            .or_else(|| swaying.into_iter().find_map(|sway| stand(from..to, sway)).map(rests));
        let (rest, index, stands) = place.ok_or(unclear)?;
        let offset_rad = distance(&rest, &planned);
        self.ramp(log, knot, &rest, index, noise)
            .map(|edge| Edge { stands, offset_rad, ..edge })
            .ok_or(unclear)
    }

    /// Returns the node of the plan at the stop.
    fn knot(&self) -> usize {
        let knots = self.curve.knots();
        let after = knots.partition_point(|knot| knot.t_s < self.at_s);
        let nearer = |k: &usize| knots.get(*k).map_or(f64::MAX, |k| (k.t_s - self.at_s).abs());
        let before = after.saturating_sub(1);
        if nearer(&before) < nearer(&after) { before } else { after.min(knots.len() - 1) }
    }

    /// Returns the joint positions at rest, and the sample of the rest next to the ramp.
    fn stand(
        &self,
        log: &JointLog,
        samples: std::ops::Range<usize>,
        noise: &RecordingNoise,
        planned: &Joints,
        sway_rad: f64,
    ) -> Option<(Joints, usize)> {
        let window_s = (0.8 * self.stand_s).clamp(0.02, 0.5);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 1e6")]
        let half =
            ((0.5 * window_s / noise.step_s).clamp(2.0, 1e6) as usize).min(samples.len() / 2);
        if half < 2 {
            return None;
        }
        let count = 2 * half;
        // Expected difference between the means of the halves of a window at rest.
        let noise_of_mean = noise.norm_rad() / (half as f64).sqrt();
        let noise_still = 3.0 * std::f64::consts::SQRT_2 * noise_of_mean;
        // Creeping does not count as rest, even at a tenth of the planned speed.
        let creeps = 0.1 * self.speed_rad_s * half as f64 * noise.step_s;
        let q = |i: usize| &log.q_rad[i];
        let find = |still: f64| {
            let mut differences = HalfMeans::new(log, samples.start, half);
            let mut index = None;
            for start in samples.start..=samples.end - count {
                if differences.norm() <= still {
                    index = Some(start);
                    if self.side == Side::Arrives {
                        break;
                    }
                }
                if start < samples.end - count {
                    differences.advance();
                }
            }
            index
        };
        let start = find((noise_still + sway_rad).min(creeps))?;
        // The window next to the ramp contains its gentle start; those further away do not.
        let still = (noise_still + sway_rad).min(creeps);
        let beyond = |k: usize| match self.side {
            Side::Leaves => start.checked_sub(k * count).filter(|start| *start >= samples.start),
            Side::Arrives => Some(start + k * count).filter(|start| start + count <= samples.end),
        };
        let is_still = |start: &usize| HalfMeans::new(log, *start, half).norm() <= still;
        let still_ones = (1..=10).map_while(beyond).take_while(is_still);
        let windows: Vec<_> = std::iter::once(start).chain(still_ones).collect();
        let windows = &windows[windows.len() / 2..];
        let mut rest: Joints = std::array::from_fn(|j| {
            let values = windows.iter().flat_map(|start| (*start..start + count).map(|i| q(i)[j]));
            median(&mut values.collect::<Vec<_>>())
        });
        if distance(&rest, planned) <= 3.0 * noise_of_mean + 1e-6 {
            rest = *planned;
        }
        Some((rest, if self.side == Side::Leaves { start } else { start + count - 1 }))
    }

    /// Fits the ramp next to a rest; `index` is a sample of the rest.
    fn ramp(
        &self,
        log: &JointLog,
        knot: usize,
        rest: &Joints,
        index: usize,
        noise: &RecordingNoise,
    ) -> Option<Edge> {
        let (curve, leaves) = (self.curve, self.side == Side::Leaves);
        let sign = if leaves { 1.0 } else { -1.0 };
        let unit = self.direction(knot)?;
        let mut sigma = noise.along_rad(&unit);
        let (mut last_rest, mut ramp) = self.samples_of_ramp(log, &unit, rest, index, sigma);
        let plan_at = |p: f64| curve.time_along(knot, leaves, &unit, sign * p);
        // Friction, elasticity and vibration displace a real robot across its path as much as along
        // it, and are correlated from sample to sample.
        let off = off_path(ramp.iter().filter_map(|&(i, p)| {
            let planned = sub(&curve.at(plan_at(p)?).0, &curve.knots()[knot].q);
            let off = sub(&sub(&log.q_rad[i], rest), &planned);
            Some(add_scaled(&off, -dot(&off, &unit), &unit))
        }));
        let tracks = off > TRACKS_RAD.max(2.0 * sigma);
        if tracks {
            sigma = 5.0 * off;
            (last_rest, ramp) = self.samples_of_ramp(log, &unit, rest, index, sigma);
        }
        let plan_time = |p: f64| {
            let t_s = plan_at(p)?;
            let speed = dot(&curve.at(t_s).1, &unit);
            Some((sign * (t_s - curve.knots()[knot].t_s), speed))
        };
        let points: Vec<_> = ramp.iter().map(|&(i, p)| (p, sign * log.t_s[i])).collect();
        let line = StartFit { points: &points, sigma, tracks }.best(&plan_time)?;
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
            offset_rad: 0.0,
        })
    }

    /// Returns the last sample at rest, and the samples of the adjacent ramp above the noise, each
    /// with its way.
    fn samples_of_ramp(
        &self,
        log: &JointLog,
        unit: &Joints,
        rest: &Joints,
        index: usize,
        sigma: f64,
    ) -> (usize, Vec<(usize, f64)>) {
        let leaves = self.side == Side::Leaves;
        let sign = if leaves { 1.0 } else { -1.0 };
        let top = WAY_RAD.max(100.0 * sigma).min(0.25 * self.leg_rad);
        let step = |i: usize| {
            let next = if leaves { i + 1 } else { i.checked_sub(1)? };
            (next < log.t_s.len()).then_some(next)
        };
        let (mut last_rest, mut ramp) = (index, Vec::new());
        let mut i = index;
        while let Some(next) = step(i) {
            i = next;
            let p = sign * dot(&sub(&log.q_rad[i], rest), unit);
            if p <= 5.0 * sigma + 1e-12 {
                ramp.clear();
                last_rest = i;
                continue;
            }
            // Coarse samples require more of the leg, up to half of it.
            if p > top && (ramp.len() >= SAMPLES || p > 0.5 * self.leg_rad) {
                break;
            }
            ramp.push((i, p));
            if p > top && ramp.len() >= SAMPLES {
                break;
            }
        }
        (last_rest, ramp)
    }

    /// Returns the direction of the leg at the stop.
    fn direction(&self, knot: usize) -> Option<Joints> {
        let curve = self.curve;
        let knots = curve.knots();
        let far = (0.1 * self.leg_rad).min(0.01);
        let arc = curve.arc(knot);
        let mut k = knot;
        // Advances to the farthest node within the distance, or to the next one.
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

/// Returns the root mean square distance of samples from the path in each of the six directions
/// across it, in rad.
fn off_path(off: impl Iterator<Item = Joints>) -> f64 {
    let (count, squares) = off.fold((0, 0.0), |sum, off| (sum.0 + 1, sum.1 + dot(&off, &off)));
    (squares / (6.0 * f64::from(count.max(1)))).sqrt()
}

/// Difference between the two half-means of a moving window.
struct HalfMeans<'a> {
    log: &'a JointLog,
    at: usize,
    half: usize,
    /// Sum of the second half minus sum of the first half.
    difference: Joints,
}

impl<'a> HalfMeans<'a> {
    fn new(log: &'a JointLog, index: usize, half: usize) -> Self {
        let mut means = Self { log, at: index, half, difference: [0.0; 7] };
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
        // Recomputed at times, so that rounding errors do not accumulate.
        if self.at.is_multiple_of(1000) {
            self.sum();
        }
    }

    fn norm(&self) -> f64 {
        norm(&self.difference) / self.half as f64
    }
}
