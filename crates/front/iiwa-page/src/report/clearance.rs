//! Clearance of the arm to the obstacles of a scene, or to itself, over time.

use iiwa_kin::Joints;
use iiwa_program::MotionIndex;
use iiwa_scene::{ArmInScene, Clearance};
use rayon::prelude::*;
use serde::Serialize;

use crate::nearest::Nearest;

use super::{
    body_times::BodyTimes,
    curve::{CurveColumns, TimeSeries},
};

/// Maximum number of poses of the curve. Poses in between are computed only if they may be nearer
/// than all others.
const POSES: usize = 36_000;

/// Maximum number of changes of the nearest pair: more are indistinguishable.
const PAIRS: usize = 5000;

/// Tolerance of the smallest clearance, in m.
const TOLERANCE_M: f64 = 2e-5;

/// Difference below which distances are equal, in m: rounding errors of an arm at rest.
const SAME_M: f64 = 1e-9;

/// Clearance of an arm over time.
#[derive(Debug, Serialize)]
pub(crate) struct Clearances {
    /// Distance, in m.
    distance: CurveColumns,
    /// Nearest pairs, each from its time on.
    pairs: Vec<PairFrom>,
    /// Smallest clearance, with its time.
    nearest: Nearest,
}

#[derive(Debug, Serialize)]
struct PairFrom {
    from_s: f64,
    link: usize,
    /// Name of the obstacle or link.
    other: String,
}

/// Clearance function of a pose during a motion: [`ArmInScene::clearance_during`], or
/// [`ArmInScene::self_clearance_during`].
pub(crate) type OfPose = fn(&ArmInScene, MotionIndex, &Joints) -> Option<Clearance>;

/// Motions over the time of positions, which determine the shapes at the flange.
#[derive(Clone, Copy, Debug)]
struct ShiftedTimes<'a> {
    bodies: &'a BodyTimes,
    /// Time of the page minus that of the positions, in s.
    shift_s: f64,
}

impl ShiftedTimes<'_> {
    /// Returns the motion at a time of the positions.
    fn at(&self, t_s: f64) -> MotionIndex {
        self.bodies.at(t_s + self.shift_s)
    }
}

impl Clearances {
    /// Computes the clearance of `arm` at and between `positions`, all times shifted by `shift_s`;
    /// `None` without obstacles or positions.
    pub(crate) fn new(
        arm: &ArmInScene,
        of_pose: OfPose,
        positions: &TimeSeries,
        bodies: &BodyTimes,
        shift_s: f64,
    ) -> Option<Self> {
        let motions = ShiftedTimes { bodies, shift_s };
        let TimeSeries { t_s, rows } = positions;
        let step = rows.len().div_ceil(POSES).max(1);
        let clearance_at = |index: usize| of_pose(arm, motions.at(t_s[index]), &rows[index]);
        let mut places = (0..rows.len()).step_by(step).collect::<Vec<_>>();
        let last = rows.len().checked_sub(1)?;
        if places.last() != Some(&last) {
            places.push(last);
        }
        let clearances = places.par_iter().map(|index| clearance_at(*index)).collect::<Vec<_>>();
        let mut samples = TimeSeries::<1>::with_capacity(places.len());
        let mut pairs: Vec<PairFrom> = Vec::new();
        let mut before = None;
        for (index, clearance) in std::iter::zip(&places, &clearances) {
            samples.push(t_s[*index], [clearance.map_or(f64::NAN, |it| it.distance_m)]);
            let Some(Clearance { link, other, .. }) = *clearance else { continue };
            if before.replace((link, other)) != Some((link, other)) && pairs.len() < PAIRS {
                let other = arm.name_of(other);
                pairs.push(PairFrom { from_s: t_s[*index] + shift_s, link, other });
            }
        }
        let (at_s, nearest) =
            IntervalSearch::new(arm, of_pose, positions, motions).minimum(&places, &clearances)?;
        Some(Self {
            distance: CurveColumns::new(&samples, shift_s),
            pairs,
            nearest: Nearest::new(arm, &nearest, Some(at_s + shift_s)),
        })
    }
}

/// Search for the smallest clearance, which skips intervals that cannot contain it.
struct IntervalSearch<'a> {
    arm: &'a ArmInScene,
    of_pose: OfPose,
    positions: &'a TimeSeries,
    motions: ShiftedTimes<'a>,
    best: Option<(f64, Clearance)>,
    /// Smallest distance of all, in m: that of the best clearance, up to [`SAME_M`].
    least_m: f64,
}

/// Pose with its time and its clearance.
#[derive(Clone, Copy)]
struct KnownPose {
    t_s: f64,
    q: Joints,
    distance_m: f64,
}

impl<'a> IntervalSearch<'a> {
    fn new(
        arm: &'a ArmInScene,
        of_pose: OfPose,
        positions: &'a TimeSeries,
        motions: ShiftedTimes<'a>,
    ) -> Self {
        Self { arm, of_pose, positions, motions, best: None, least_m: f64::MAX }
    }

    fn best_m(&self) -> f64 {
        self.best.map_or(f64::MAX, |(_, best)| best.distance_m)
    }

    /// Returns true if times from `t_s` on are irrelevant: the arm has touched something before.
    fn is_over(&self, t_s: f64) -> bool {
        self.best.is_some_and(|(at_s, best)| best.distance_m == 0.0 && t_s >= at_s)
    }

    /// Accepts a clearance smaller than the best so far; of equal clearances, the first one.
    fn take(&mut self, t_s: f64, clearance: Clearance) {
        let is_sooner = self.best.is_none_or(|(at_s, _)| t_s < at_s);
        let distance_m = clearance.distance_m;
        let is_as_near = distance_m <= self.least_m + SAME_M;
        self.least_m = self.least_m.min(distance_m);
        if distance_m < self.best_m() - SAME_M || is_as_near && is_sooner {
            self.best = Some((t_s, clearance));
        }
    }

    fn is_one_motion(&self, [from_s, to_s]: [f64; 2]) -> bool {
        self.motions.at(from_s) == self.motions.at(to_s)
    }

    fn look(&mut self, t_s: f64, q: Joints) -> Option<KnownPose> {
        let clearance = (self.of_pose)(self.arm, self.motions.at(t_s), &q)?;
        self.take(t_s, clearance);
        Some(KnownPose { t_s, q, distance_m: clearance.distance_m })
    }

    /// Finds the smallest clearance or the first contact, from the clearances at some samples.
    fn minimum(
        mut self,
        places: &[usize],
        clearances: &[Option<Clearance>],
    ) -> Option<(f64, Clearance)> {
        let TimeSeries { t_s, rows } = self.positions;
        for (index, clearance) in std::iter::zip(places, clearances) {
            if let Some(clearance) = clearance {
                self.take(t_s[*index], *clearance);
            }
        }
        // Shapes that other ones replace at once: the robot rests.
        for (page_s, motion) in self.motions.bodies.passing() {
            let at_s = page_s - self.motions.shift_s;
            for q in self.positions.at_times(&[at_s]) {
                if let Some(clearance) = (self.of_pose)(self.arm, motion, &q) {
                    self.take(at_s, clearance);
                }
            }
        }
        for (ends, clearance_pair) in std::iter::zip(places.windows(2), clearances) {
            if self.is_over(t_s[ends[0]]) {
                break;
            }
            let between = ends[0]..=ends[1];
            let start = rows[ends[0]];
            let bound = |index: usize| self.arm.travel_bound_m(&start, &rows[index]);
            // Non-finite bounds are ignored, and gaps are skipped.
            let max_travel_m = between.clone().map(bound).fold(0.0, f64::max);
            // Other shapes may be at the flange from another motion on.
            let known = clearance_pair.filter(|_| self.is_one_motion([t_s[ends[0]], t_s[ends[1]]]));
            let at_start = known.map_or(f64::MIN, |it| it.distance_m);
            if at_start - max_travel_m >= self.best_m() - TOLERANCE_M {
                continue;
            }
            let mut before: Option<KnownPose> = None;
            for index in between {
                let clearance = self.look(t_s[index], rows[index]);
                if let (Some(from), Some(to)) = (before, clearance) {
                    self.between(from, to);
                }
                before = clearance;
            }
        }
        self.best
    }

    /// Searches between two poses, with linear interpolation of the joints.
    fn between(&mut self, from: KnownPose, to: KnownPose) {
        let way = self.arm.travel_bound_m(&from.q, &to.q);
        let lower_m = if self.is_one_motion([from.t_s, to.t_s]) {
            0.5 * (from.distance_m + to.distance_m - way)
        } else {
            f64::MIN
        };
        let is_over = self.is_over(from.t_s);
        if is_over || lower_m >= self.best_m() - TOLERANCE_M || way < TOLERANCE_M {
            return;
        }
        let q = std::array::from_fn(|j| f64::midpoint(from.q[j], to.q[j]));
        if let Some(middle) = self.look(f64::midpoint(from.t_s, to.t_s), q) {
            self.between(from, middle);
            self.between(middle, to);
        }
    }
}
