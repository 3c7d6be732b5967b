//! Location of a program in a recording, and matching of samples to the planned path.

use iiwa_kin::{
    Joints,
    vector::{distance, norm, sub},
};
use iiwa_log::JointLog;

use super::curve::{Curve, CurvePoint};
use super::error::CompareError;
use super::plan::{PlanLeg, PlannedTrajectory};
use crate::noise::RecordingNoise;

/// Largest distance of a rest from the plan's start or end, in rad.
pub(super) const ENDS_RAD: f64 = 0.05;

/// Distance from a rest at which the robot has left it, in rad.
pub(crate) const LEFT_RAD: f64 = 2e-4;

/// Distance from the path at which the recording is of another path, in rad.
const STRAYS_RAD: f64 = 0.5;

/// Mean distance from the path at which the recording is of another program, in rad.
const STRAYS_ON_AVERAGE_RAD: f64 = 0.1;

/// Samples of the program, with the matched position on the planned path for each.
#[derive(Debug)]
pub(crate) struct Followed {
    /// First sample.
    pub(crate) first: usize,
    /// Matched planned time of each sample from the first one, in s.
    pub(crate) place_s: Vec<f64>,
    /// Time at which a second run of the program starts, in s, on the recording's clock.
    pub(crate) again_s: Option<f64>,
}

/// Result of following the robot from one of its visits to the start.
enum FollowAttempt {
    Done(Vec<f64>),
    Failed { arc_rad: f64, error: CompareError },
}

/// Finds the plan in a recording: the first time that the robot leaves its start and follows its
/// path to the end.
pub(crate) fn find(
    plan: &PlannedTrajectory,
    legs: &[PlanLeg],
    log: &JointLog,
    noise: &RecordingNoise,
) -> Result<Followed, CompareError> {
    let curve = &plan.curve;
    let start = curve.at(legs[0].start_s).0;
    let radius = reach(curve, &legs[0], &start);
    let mut followed: Option<Followed> = None;
    let mut best: Option<(f64, CompareError)> = None;
    // Bounds the work for any recording to a few passes over it.
    let mut budget = 20 * log.t_s.len();
    for visit in Visits::new(log, start, radius) {
        if visit.to >= log.t_s.len() || budget == 0 {
            break;
        }
        let from = visit.leaves(log, &start, noise);
        match follow(plan, legs, log, noise, from) {
            FollowAttempt::Done(place_s) => {
                budget = budget.saturating_sub(place_s.len());
                match &mut followed {
                    None => followed = Some(Followed { first: from, place_s, again_s: None }),
                    Some(first) if from >= first.first + first.place_s.len() / 2 => {
                        first.again_s = Some(log.t_s[from]);
                        break;
                    }
                    Some(_) => {}
                }
            }
            FollowAttempt::Failed { arc_rad, error } => {
                budget = budget.saturating_sub(visit.to - from);
                if best.as_ref().is_none_or(|(max_arc_rad, _)| arc_rad > *max_arc_rad) {
                    best = Some((arc_rad, error));
                }
            }
        }
    }
    match (followed, best) {
        (Some(followed), _) => Ok(followed),
        (None, Some((_, error))) => Err(error),
        (None, None) => Err(never_left(log, &start, radius)),
    }
}

/// Returns the distance from an end of a leg within which the robot counts as being there: at most
/// half of the leg's largest distance from that end.
fn reach(curve: &Curve, leg: &PlanLeg, end: &Joints) -> f64 {
    let knots = curve.knots();
    let from = curve.interval_at(leg.start_s);
    let within = knots[from..].iter().take_while(|knot| knot.t_s <= leg.end_s + 1e-9);
    let farthest = within.map(|knot| distance(&knot.q, end)).fold(0.0, f64::max);
    (0.5 * farthest).min(ENDS_RAD)
}

/// Stay of the robot near the start: samples from..to.
struct Visit {
    from: usize,
    to: usize,
}

impl Visit {
    /// Returns the last sample of the stay at almost the smallest distance from the start.
    fn leaves(&self, log: &JointLog, start: &Joints, noise: &RecordingNoise) -> usize {
        let away = |i: &usize| distance(&log.q_rad[*i], start);
        let nearest = (self.from..self.to).map(|i| away(&i)).fold(f64::MAX, f64::min);
        let near = nearest + LEFT_RAD + 10.0 * noise.norm_rad();
        (self.from..self.to).rev().find(|i| away(i) <= near).unwrap_or(self.from)
    }
}

struct Visits<'a> {
    log: &'a JointLog,
    start: Joints,
    radius: f64,
    next: usize,
}

impl<'a> Visits<'a> {
    fn new(log: &'a JointLog, start: Joints, radius: f64) -> Self {
        Self { log, start, radius, next: 0 }
    }
}

impl Iterator for Visits<'_> {
    type Item = Visit;

    fn next(&mut self) -> Option<Visit> {
        let near = |q: &Joints| distance(q, &self.start) <= self.radius;
        let rest = self.log.q_rad.get(self.next..)?;
        let from = self.next + rest.iter().position(near)?;
        let stay = self.log.q_rad[from..].iter().position(|q| !near(q));
        let to = stay.map_or(self.log.q_rad.len(), |stay| from + stay);
        self.next = to;
        Some(Visit { from, to })
    }
}

fn never_left(log: &JointLog, start: &Joints, radius: f64) -> CompareError {
    let nearest = log.q_rad.iter().enumerate().map(|(i, q)| (i, distance(q, start)));
    let (i, distance_rad) =
        nearest.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, f64::INFINITY));
    let t_s = log.t_s.get(i).copied().unwrap_or_default();
    if distance_rad <= radius {
        CompareError::NeverLeaves { t_s }
    } else {
        CompareError::OtherStart { distance_rad, t_s }
    }
}

/// Follows the robot from a sample at the start.
fn follow(
    plan: &PlannedTrajectory,
    legs: &[PlanLeg],
    log: &JointLog,
    noise: &RecordingNoise,
    first: usize,
) -> FollowAttempt {
    let curve = &plan.curve;
    let (leg, last) = (&legs[legs.len() - 1], log.t_s.len() - 1);
    let end = curve.at(leg.end_s).0;
    let radius = reach(curve, leg, &end);
    let mut follower = Follower::new(curve, noise, legs[0].start_s, log, first);
    let mut place_s = Vec::new();
    let mut is_at_end = false;
    let (mut sum, mut way) = (0.0, 0.0);
    for i in first..=last {
        let before = follower.arc_rad;
        let place = follower.step(log.t_s[i], &log.q_rad[i]);
        let off = place.distance_rad;
        let away = distance(&log.q_rad[i], &end);
        if is_at_end && away > 2.0 * radius {
            break;
        }
        if off > STRAYS_RAD {
            let motion = plan.motion_at(place.t_s);
            let error = CompareError::OtherPath { distance_rad: off, t_s: log.t_s[i], motion };
            return FollowAttempt::Failed { arc_rad: follower.arc_rad, error };
        }
        sum += off * (follower.arc_rad - before);
        way += follower.arc_rad - before;
        place_s.push(place.t_s);
        is_at_end |= follower.arc_rad >= curve.length() - radius && away <= 1.5 * radius;
    }
    let arc_rad = follower.arc_rad;
    if !is_at_end {
        let motion = plan.motion_at(place_s.last().copied().unwrap_or_default());
        let left_rad = curve.length() - arc_rad;
        let error = CompareError::EndsEarly { t_s: log.t_s[last], motion, left_rad };
        return FollowAttempt::Failed { arc_rad, error };
    }
    if sum > STRAYS_ON_AVERAGE_RAD * way {
        let error = CompareError::OffAllAlong { mean_rad: sum / way };
        return FollowAttempt::Failed { arc_rad, error };
    }
    FollowAttempt::Done(place_s)
}

/// Matches samples to the curve: the nearest point of each sample is searched from the last
/// position on, and no farther ahead than the robot can have moved. A path that crosses itself or
/// reverses is therefore matched correctly.
struct Follower<'a> {
    curve: &'a Curve,
    /// Largest backward displacement by noise alone, in rad.
    slack_rad: f64,
    gap_s: f64,
    /// Farthest position so far, as a length in rad.
    arc_rad: f64,
    /// Interval at which the search begins.
    interval: usize,
    before: (f64, Joints),
    distance_rad: f64,
}

impl<'a> Follower<'a> {
    fn new(
        curve: &'a Curve,
        noise: &RecordingNoise,
        start_s: f64,
        log: &JointLog,
        first: usize,
    ) -> Self {
        let interval = curve.interval_at(start_s);
        let start = curve.knots()[interval].q;
        Self {
            curve,
            slack_rad: 12.0 * noise.norm_rad() + 1e-9,
            gap_s: noise.gap_s(),
            arc_rad: curve.arc(interval),
            interval,
            before: (log.t_s[first], log.q_rad[first]),
            distance_rad: distance(&log.q_rad[first], &start),
        }
    }

    fn step(&mut self, t_s: f64, q: &Joints) -> CurvePoint {
        let curve = self.curve;
        let moved = norm(&sub(q, &self.before.1));
        let mut ahead = 3.0 * moved + 2.0 * self.distance_rad + self.slack_rad;
        let passed_s = t_s - self.before.0;
        if passed_s > self.gap_s {
            // During a gap the robot may have moved anywhere, even forth and back.
            let plan_s = curve.knots()[curve.interval_at_arc(self.arc_rad)].t_s;
            ahead += curve.arc_at(plan_s + 1.5 * passed_s) - self.arc_rad;
        }
        let (back, limit) = (self.arc_rad - self.slack_rad, self.arc_rad + ahead);
        while self.interval + 1 < curve.intervals() && curve.arc(self.interval + 1) < back {
            self.interval += 1;
        }
        let mut best = (f64::MAX, self.interval, 0.0);
        for interval in self.interval..curve.intervals() {
            if curve.arc(interval) > limit {
                break;
            }
            let (square, along) = curve.to_chord(interval, q, back);
            // Of two points at the same distance up to rounding, the later one is on the way back.
            if square < best.0 - 1e-9 * best.0 - 1e-24 {
                best = (square, interval, along);
            }
        }
        let place = curve.refine(best.1, q, best.2);
        self.arc_rad = self.arc_rad.max(place.arc_rad);
        self.before = (t_s, *q);
        self.distance_rad = place.distance_rad;
        place
    }
}
