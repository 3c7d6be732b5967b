//! Clearance of a planned motion, by branch and bound.

use std::ops::Range;

use iiwa_kin::Joints;
use iiwa_path::Segment;
use iiwa_program::MotionIndex;
use iiwa_traj::{Piece, Section, Trajectory};

use crate::{
    arm::PosedPart,
    clearance::{Among, ArmInScene, Clearance, ClearanceTarget, Pair},
    distance::Near,
    gjk::EXACT_M,
    span::Span,
};

/// Smallest clearance of a planned motion, and its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedClearance {
    /// Clearance at a pose of the motion. No pose of the motion has a clearance that is smaller by
    /// more than 0.1 mm.
    pub clearance: Clearance,
    /// Time, in s from the start of the program. If the arm touches an obstacle, the time of the
    /// first contact: before, it touches none, or by less than 0.1 mm.
    pub at_s: f64,
    /// Motion of the program.
    pub motion: MotionIndex,
}

/// Tolerance of the smallest distance, in m.
const TOLERANCE_M: f64 = 1e-4;

/// Difference below which distances count as equal, in m: at rest, each may have another error.
const SAME_M: f64 = 2.0 * EXACT_M;

/// Number of poses of each piece that are evaluated first: the smaller their clearance, the sooner
/// the rest is excluded.
const SAMPLES: u32 = 8;

impl ArmInScene {
    /// Returns the smallest clearance of `trajectory`; none if the scene has no obstacles.
    ///
    /// The search runs along the path, piece by piece, and halves spans until the bounds of the
    /// joint motion in a span exclude a smaller clearance.
    #[must_use]
    pub fn clearance_of(&self, trajectory: &Trajectory) -> Option<PlannedClearance> {
        self.nearest_of(Among::Obstacles, trajectory.sections())
    }

    /// Returns the smallest clearance of `section`, a part of a trajectory; none if the scene has
    /// no obstacles.
    #[must_use]
    pub fn clearance_of_section(&self, section: &Section) -> Option<PlannedClearance> {
        self.nearest_of(Among::Obstacles, [section])
    }

    /// Returns the smallest distance of two parts of the arm in `trajectory`; none if it has no
    /// sections.
    #[must_use]
    pub fn self_clearance_of(&self, trajectory: &Trajectory) -> Option<PlannedClearance> {
        self.nearest_of(Among::OwnParts, trajectory.sections())
    }

    /// Returns the smallest distance of two parts of the arm in `section`, a part of a trajectory.
    #[must_use]
    pub fn self_clearance_of_section(&self, section: &Section) -> Option<PlannedClearance> {
        self.nearest_of(Among::OwnParts, [section])
    }

    fn nearest_of<'a>(
        &self,
        among: Among,
        sections: impl IntoIterator<Item = &'a Section>,
    ) -> Option<PlannedClearance> {
        let mut search = ClearanceSearch::new(self, among);
        for section in sections {
            search.go(section, section.pieces());
            search.load_changes(section);
        }
        search.best
    }

    /// Returns the smallest clearance of each motion of `section`, including the wait or the
    /// settling after it, in order; empty if the scene has no obstacles.
    #[must_use]
    pub fn clearances(&self, section: &Section) -> Vec<PlannedClearance> {
        let motions = section.pieces().chunk_by(|a, b| a.motion == b.motion);
        let nearest = |pieces: &[Piece]| {
            let mut search = ClearanceSearch::new(self, Among::Obstacles);
            search.go(section, pieces);
            search.best
        };
        motions.filter_map(nearest).collect()
    }
}

/// Search for the smallest clearance.
struct ClearanceSearch<'a> {
    arm: &'a ArmInScene,
    among: Among,
    best: Option<PlannedClearance>,
    /// Smallest distance so far, in m: that of the best result, up to the difference that counts as
    /// equal.
    nearest_m: f64,
    /// Stack of the pairs that may be nearer in a span, with their lower bound of the distance in
    /// it: those of the current span, on top of those of the spans that contain it.
    open: Vec<(Pair, f64)>,
    /// Stack of the nodes of a surface that are searched in the current span.
    targets: Vec<ClearanceTarget>,
}

/// Piece in motion that is searched.
#[derive(Clone, Copy)]
struct SearchedPiece<'a> {
    section: &'a Section,
    piece: &'a Piece,
    segment: &'a dyn Segment,
}

impl<'a> ClearanceSearch<'a> {
    fn new(arm: &'a ArmInScene, among: Among) -> Self {
        Self { arm, among, best: None, nearest_m: f64::MAX, open: Vec::new(), targets: Vec::new() }
    }

    /// Searches `pieces` of `section` for a smaller clearance than the best so far.
    fn go(&mut self, section: &Section, pieces: &[Piece]) {
        let moving = |piece| {
            let place = |segment| SearchedPiece { section, piece, segment };
            section.segment(piece).map(place)
        };
        for piece in pieces {
            match moving(piece) {
                Some(place) => {
                    for i in 0..=SAMPLES {
                        let s = f64::from(i) / f64::from(SAMPLES);
                        self.sample(piece.motion, &place.segment.at(s).q, || {
                            section.time_at(piece, s)
                        });
                    }
                }
                None => self.sample(piece.motion, &section.at(piece.start_s).q, || piece.start_s),
            }
        }
        for place in pieces.iter().filter_map(moving) {
            let rooted = |pair| (self.arm.rooted(pair), f64::MIN);
            let carried = self.arm.bodies_during(Some(place.piece.motion));
            self.open.extend(self.arm.pairs(self.among, carried).map(rooted));
            self.span(place, 0.5, 0.5, 0..self.open.len());
            self.open.clear();
        }
    }

    /// Evaluates the rests at which load changes add shapes: other load changes at the same rest,
    /// or the end of the program, may follow without any piece.
    fn load_changes(&mut self, section: &Section) {
        let pieces = section.pieces();
        let Some(last) = pieces.last() else { return };
        let carried = self.arm.carried();
        let starts = pieces.chunk_by(|a, b| a.motion == b.motion).map(|pieces| &pieces[0]);
        for piece in starts {
            let (at_s, q) = (piece.start_s, section.at(piece.start_s).q);
            let before = carried.loads_before(piece.motion);
            before.for_each(|load| self.sample(load, &q, || at_s));
        }
        let (at_s, q) = (last.end_s, section.at(last.end_s).q);
        let after = carried.loads_after(last.motion);
        after.for_each(|load| self.sample(load, &q, || at_s));
    }

    /// Returns the smallest distance so far, in m.
    fn best_m(&self) -> f64 {
        self.best.map_or(f64::MAX, |best| best.clearance.distance_m)
    }

    /// Evaluates one pose of a motion.
    fn sample(&mut self, motion: MotionIndex, joints_rad: &Joints, at_s: impl FnOnce() -> f64) {
        let carried = self.arm.bodies_during(Some(motion));
        let nearest = self.arm.nearest(self.among, carried, joints_rad, self.best_m() + SAME_M);
        if let Some((pair, near)) = nearest {
            self.add(motion, pair, &near, at_s);
        }
    }

    /// Records a result if it is nearer than the best so far, or equally near and earlier.
    fn add(&mut self, motion: MotionIndex, pair: Pair, near: &Near, at_s: impl FnOnce() -> f64) {
        if near.distance > self.nearest_m + SAME_M {
            return;
        }
        self.nearest_m = self.nearest_m.min(near.distance);
        let at_s = at_s();
        let earlier = self.best.is_none_or(|best| at_s < best.at_s);
        if near.distance < self.best_m() - SAME_M || earlier {
            let clearance = self.arm.to_clearance(pair, near);
            self.best = Some(PlannedClearance { clearance, at_s, motion });
        }
    }

    /// Searches the span from `middle - half` to `middle + half` of s, with the remaining `pairs`
    /// of [`Self::open`], and its halves if any pair remains.
    fn span(&mut self, place: SearchedPiece<'_>, middle: f64, half: f64, pairs: Range<usize>) {
        let SearchedPiece { section, piece, segment } = place;
        if let Some(best) = &self.best
            && best.clearance.distance_m == 0.0
            && section.time_at(piece, middle - half) >= best.at_s
        {
            return;
        }
        let arm = self.arm;
        let span = Span::new(&arm.robot, segment, middle, half);
        let first = self.open.len();
        let at = |part: usize| -> PosedPart<'_> {
            let part = &arm.parts[part];
            part.at(&span.poses[part.link])
        };
        let mut last = None;
        for index in pairs {
            let (pair, lower_bound) = self.open[index];
            if lower_bound >= self.best_m() - TOLERANCE_M {
                continue;
            }
            let part = &arm.parts[pair.part];
            // Obstacles are fixed to the base, link 0.
            let from = match pair.target {
                ClearanceTarget::Obstacle(_) | ClearanceTarget::Surface { .. } => 0,
                ClearanceTarget::Part(other) => arm.parts[other].link,
            };
            // Pairs of the same part are adjacent, so that its body and bounds are reused.
            let (body, moves) = match last {
                Some((same, body, moves)) if same == (pair.part, from) => (body, moves),
                _ => (at(pair.part), span.moves(part, from)),
            };
            last = Some(((pair.part, from), body, moves));
            self.targets.push(pair.target);
            while let Some(target) = self.targets.pop() {
                let pair = Pair { target, ..pair };
                if arm.lower_bound(pair, &body, at) - moves.max_m >= self.best_m() - TOLERANCE_M {
                    continue;
                }
                let Some(near) = arm.near(pair, &body, at, self.best_m() + moves.max_m) else {
                    continue;
                };
                let bounding_box = arm.bounding_box(target);
                if bounding_box.is_none() {
                    self.add(piece.motion, pair, &near, || section.time_at(piece, middle));
                }
                let beyond = match target {
                    ClearanceTarget::Obstacle(o) => arm.obstacles[o].farthest_along(near.away),
                    ClearanceTarget::Surface { obstacle, node } => {
                        arm.obstacles[obstacle].node_farthest_along(node, near.away)
                    }
                    ClearanceTarget::Part(other) => at(other).farthest_along(near.away),
                };
                let lower_bound = span.lower_bound((part, &body), (from, moves), &near, beyond);
                if lower_bound >= self.best_m() - TOLERANCE_M {
                    continue;
                }
                match (target, bounding_box) {
                    // A box that is larger than the motion does not exclude much: its contents do.
                    (ClearanceTarget::Surface { obstacle, .. }, Some((cuboid, first)))
                        if cuboid.half.length() > 0.5 * moves.max_m =>
                    {
                        let node = |node| ClearanceTarget::Surface { obstacle, node };
                        self.targets.extend([first, first + 1].map(node));
                    }
                    _ => self.open.push((pair, lower_bound)),
                }
            }
        }
        let remaining = first..self.open.len();
        if !remaining.is_empty() && half > SHORTEST {
            let half = 0.5 * half;
            self.span(place, middle - half, half, remaining.clone());
            self.span(place, middle + half, half, remaining);
        }
        self.open.truncate(first);
    }
}

/// Half-length of the shortest span that is halved: no point of a piece moves by more than the
/// tolerance in it.
const SHORTEST: f64 = 1e-9;
