//! Jerk-limited stamps of one section.
//!
//! A section that is one straight line has a closed form. Any other is solved for on cells
//! ([`solver`]), starting from its acceleration-limited stamps. What comes out keeps all limits at
//! some places of each cell; where it exceeds them in between, the cell's limits are lowered and it is
//! solved again.

mod acceleration_rows;
mod blocks;
mod cells;
mod functionals;
mod jerk_rows;
mod limited_segment;
mod limiting_joints;
mod mesh;
mod quadratic;
mod riccati;
mod settings;
mod slack_pair;
mod solver;
mod velocity_rows;

use std::ops::Range;

use iiwa_path::Step;

use crate::{
    interval::later,
    limit_usage::LimitUsage,
    node::Node,
    phases::{ProfilePoint, phases},
    section::{PieceKind, Section},
    timing::{JerkOptions, TimingError},
};
use limited_segment::LimitedSegment;
use mesh::{Cell, Mesh, mesh};
use settings::{HorizonSettings, RefinementSettings, SETTINGS};
use solver::{NotConverged, Solver};

const REFINEMENT: RefinementSettings = SETTINGS.refinement;
const GAP: f64 = SETTINGS.interior_point.gap;

/// Replaces the acceleration-limited stamps of `section` by jerk-limited ones.
pub(crate) fn limit(section: &mut Section, options: JerkOptions) -> Result<(), TimingError> {
    let Some(first) = section.pieces.first() else { return Ok(()) };
    let motion = first.motion;
    let path = section.path.clone();
    let mut segments = Vec::with_capacity(section.pieces.len());
    for piece in &section.pieces {
        let Step::Move { segment, blend, .. } = &path.steps()[piece.step] else { continue };
        let limits = &path.limits()[piece.motion.index()];
        let swept = &section.nodes[piece.nodes.clone()];
        let Some(segment) = LimitedSegment::new(segment.as_ref(), limits, swept) else {
            let motion = blend.map_or(piece.motion, |corner| corner.motion);
            return Err(TimingError::CurvatureJumps { motion });
        };
        segments.push(segment);
    }
    let stamped = match segments.as_slice() {
        [line] if line.is_line() && !options.general => straight(line),
        _ => curved(&segments, section.start_s, options)
            .ok_or(TimingError::NotConverged { motion })?,
    };
    drop(segments);
    section.stamp(stamped);
    Ok(())
}

/// The stamps of any other section; none if they were not found.
fn curved(
    segments: &[LimitedSegment<'_>],
    start_s: f64,
    options: JerkOptions,
) -> Option<Vec<SegmentStamps>> {
    if !options.general
        && let Some(stamps) = receding_horizon(segments, start_s, options)
    {
        return Some(stamps);
    }
    let whole = Window { segments, range: 0..segments.len(), entry: None };
    Some(whole.solve(options)?.stamps(&whole, segments.len(), start_s, &mut 0.0))
}

/// The stamps of a section that is too long to be solved as a whole: part by part, each with some segments
/// beyond it on whose last line the arm could stop. So there is a way on from the end of every part, and
/// far enough from that stop it makes no difference. None if the section cannot be divided like this.
fn receding_horizon(
    segments: &[LimitedSegment<'_>],
    start_s: f64,
    options: JerkOptions,
) -> Option<Vec<SegmentStamps>> {
    let HorizonSettings { window, ahead, stops } = SETTINGS.horizon;
    // The first segment at least `count` segments and some stops beyond `from`.
    let beyond = |from: usize, count: usize| {
        let before = from.checked_sub(1).map(|before| &segments[before]);
        let mut way = stops * segments.get(from)?.stop_rad(before);
        let mut index = from;
        while index < from + count || way > 0.0 {
            way -= segments.get(index)?.length;
            index += 1;
        }
        Some(index)
    };
    let mut stamps = Vec::with_capacity(segments.len());
    let mut t_s = 0.0;
    let (mut start, mut entry) = (0, None);
    while start < segments.len() {
        let settled = beyond(start, window);
        let end = settled.and_then(|settled| {
            let end = beyond(settled, ahead)?;
            let lines = segments[end - 1..].iter().position(LimitedSegment::is_line)?;
            // What is left after the stop should be worth a part of its own.
            Some(end + lines).filter(|end| end + (settled - start) / 2 < segments.len())
        });
        let (settled, end) = settled.zip(end).unwrap_or((segments.len(), segments.len()));
        if start == 0 && end == segments.len() {
            return None;
        }
        let part = Window { segments, range: start..end, entry };
        let plan = part.solve(options).filter(|plan| plan.time_scale == 1.0)?;
        stamps.extend(plan.stamps(&part, settled, start_s, &mut t_s));
        entry = plan.entry(settled);
        start = settled;
    }
    Some(stamps)
}

/// Legs that are solved for together. The last of them is a line that ends at rest.
struct Window<'a, 'b> {
    segments: &'a [LimitedSegment<'b>],
    range: Range<usize>,
    /// x and its derivative by sigma at the start; none at rest.
    entry: Option<[f64; 2]>,
}

impl Window<'_, '_> {
    /// The best that is found; none if that is nothing.
    fn solve(&self, options: JerkOptions) -> Option<Solution> {
        let [enough, most] = REFINEMENT.longer;
        let mut best: Option<Solution> = None;
        for (index, (refinement, safe)) in REFINEMENT.attempts.into_iter().enumerate() {
            let refinement = options.refinement * refinement;
            let Some(plan) = Solution::find(self, refinement, safe, index > 0) else {
                continue;
            };
            if plan.longer() <= best.as_ref().map_or(most, Solution::longer) {
                best = Some(plan);
            }
            if best.as_ref().is_some_and(|best| best.longer() <= enough) {
                break;
            }
        }
        best
    }
}

/// The stamps of one segment.
struct SegmentStamps {
    nodes: Vec<Node>,
    usage: LimitUsage,
}

/// The stamps of a section that is one line.
fn straight(segment: &LimitedSegment<'_>) -> Vec<SegmentStamps> {
    let instants = phases(segment.length, segment.straight(0.0));
    let nodes: Vec<_> = instants
        .iter()
        .map(|at| Node {
            t_s: at.t_s,
            dt_s: at.phase_s,
            p: at.way / segment.length,
            dp: at.phase_way / segment.length,
            rate: at.speed / segment.length,
            u: [at.acceleration / segment.length; 2],
        })
        .collect();
    let mut usage = LimitUsage::default();
    let derivatives = segment.derivatives(0.0);
    for pair in instants.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let dt = from.phase_s;
        let jerk = (to.acceleration - from.acceleration) / dt;
        // Where the phase is half over, and for the peaks also at its end.
        let half = ProfilePoint {
            speed: from.speed + 0.5 * dt * (from.acceleration + 0.25 * dt * jerk),
            acceleration: 0.5 * (from.acceleration + to.acceleration),
            ..from
        };
        for (at, dt) in [(half, dt), (to, 0.0)] {
            usage.sample(&segment.shares(&derivatives, [at.speed, at.acceleration, jerk]), dt);
        }
    }
    vec![SegmentStamps { nodes, usage }]
}

/// The larger of two shares; what is not a number counts as too much.
fn worse(a: f64, b: f64) -> f64 {
    if b <= a { a } else { b }
}

/// Speed, acceleration and jerk of sigma, from x and its derivatives.
fn in_time([x, dx, ddx]: [f64; 3]) -> [f64; 3] {
    let speed = x.sqrt();
    [speed, 0.5 * dx, 0.5 * ddx * speed]
}

/// A solution.
struct Solution {
    mesh: Mesh,
    solver: Solver,
    /// Share of all times by which it is slowed down.
    time_scale: f64,
}

impl Solution {
    fn find(part: &Window<'_, '_>, refinement: f64, safe: bool, cautious: bool) -> Option<Self> {
        let Window { segments, ref range, entry } = *part;
        let mesh = mesh(segments, range.clone(), entry.is_none(), refinement)?;
        let mut solver = Solver::new(segments, &mesh, entry);
        solver.is_cautious = cautious;
        let mut plan = Self { mesh, solver, time_scale: 1.0 };
        let scale = if safe { plan.time_scale(segments).powi(-2) } else { REFINEMENT.start };
        plan.solver.start(scale);
        if plan.refine(segments).is_err() {
            // Whatever was found is good, as slow as it takes to keep the limits.
            plan.time_scale = plan.time_scale(segments);
        }
        Some(plan)
    }

    /// x and its derivative by sigma where the segment `segment` starts.
    fn entry(&self, segment: usize) -> Option<[f64; 2]> {
        let cell = self.mesh.cells.iter().position(|cell| cell.segment == segment)?;
        let [x, dx, _] = self.solver.at(cell, 0.0);
        Some([x, dx])
    }

    /// By which share it may take longer than the best, if it is as far from it as the solver fears.
    fn longer(&self) -> f64 {
        self.time_scale * (1.0 + self.solver.gap)
    }

    /// Solves and lowers limits until all are kept everywhere.
    fn refine(&mut self, segments: &[LimitedSegment<'_>]) -> Result<(), NotConverged> {
        let [some, all] = REFINEMENT.checks;
        self.solver.solve(SETTINGS.interior_point.first_gap)?;
        // Where limits will be exceeded is seen long before the end.
        if self.tighten(segments, some) > REFINEMENT.abrupt {
            self.solver.restart(REFINEMENT.far);
        }
        self.solver.solve(GAP)?;
        for _ in 0..REFINEMENT.rounds {
            let excess = self.tighten(segments, all);
            if excess == 1.0 {
                return Ok(());
            }
            self.solver.restart(if excess > REFINEMENT.abrupt {
                REFINEMENT.far
            } else {
                REFINEMENT.close[usize::from(self.solver.is_cautious)]
            });
            self.solver.solve(GAP)?;
        }
        Err(NotConverged)
    }

    /// The share of all times that keeps the limits.
    fn time_scale(&self, segments: &[LimitedSegment<'_>]) -> f64 {
        let mut largest = [1.0, 1.0, self.solver.rest_jerk()];
        for shares in self.worst(segments, REFINEMENT.checks[1]) {
            for i in 0..3 {
                largest[i] = worse(largest[i], shares[i]);
            }
        }
        let [v, a, j]: [f64; 3] = std::array::from_fn(|i| largest[i] / REFINEMENT.tolerance[i]);
        let factors = [v, a.sqrt(), j.cbrt(), self.solver.continuity_defect()];
        factors.into_iter().fold(1.0, worse)
    }

    /// Lowers the limits of the cells that exceed them, and returns the largest share; 1 if there are
    /// none.
    fn tighten(&mut self, segments: &[LimitedSegment<'_>], parts: u32) -> f64 {
        let mut largest = 1.0_f64;
        let by: Vec<_> = self
            .worst(segments, parts)
            .into_iter()
            .map(|shares| {
                std::array::from_fn(|i| {
                    // Not a number is above, too.
                    if shares[i] <= REFINEMENT.tolerance[i] {
                        return 1.0;
                    }
                    largest = largest.max(shares[i]);
                    REFINEMENT.target[i] / shares[i]
                })
            })
            .collect();
        if largest > 1.0 {
            self.solver.tighten(&by);
        }
        largest
    }

    /// The largest shares of the limits of speed, acceleration and jerk at some places of each cell between
    /// the two that touch rest.
    fn worst(&self, segments: &[LimitedSegment<'_>], parts: u32) -> Vec<[f64; 3]> {
        pulp::Arch::new().dispatch(Check { solution: self, segments, parts })
    }

    /// The same for one cell.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "it is from 1 to 4"
    )]
    fn worst_of(&self, k: usize, segments: &[LimitedSegment<'_>], parts: u32) -> [f64; 3] {
        let cell = &self.mesh.cells[k];
        let segment = &segments[cell.segment];
        let mut worst = [0.0_f64; 3];
        let parts = parts * self.slowness(segment, k).ceil().clamp(1.0, 4.0) as u32;
        for f in (0..=parts).map(|i| f64::from(i) / f64::from(parts)) {
            let s = if segment.is_line() {
                0.0
            } else {
                segment.s(cell.from + f * cell.length).clamp(0.0, 1.0)
            };
            let shares = segment.largest_shares(s, in_time(self.solver.at(k, f)));
            for i in 0..3 {
                worst[i] = worse(worst[i], shares[i]);
            }
        }
        worst
    }

    /// The stamps of the segments of `part` before the segment `end`, from `t_s` on in a section that starts at
    /// `start_s`.
    fn stamps(
        &self,
        part: &Window<'_, '_>,
        end: usize,
        start_s: f64,
        t_s: &mut f64,
    ) -> Vec<SegmentStamps> {
        let segments = part.segments;
        let first = part.range.start;
        let mut all: Vec<_> = (first..end)
            .map(|_| SegmentStamps { nodes: Vec::new(), usage: LimitUsage::default() })
            .collect();
        let Mesh { from_rest, cells, to_rest } = &self.mesh;
        if let Some(cell) = from_rest {
            let stamps = &mut all[cell.segment - first];
            let segment = &segments[cell.segment];
            let dt = self.time_scale * self.solver.start_s();
            self.node(stamps, segment, [0.0, cell.length], [*t_s, dt], [0.0; 2]);
            self.rest(stamps, segment, cell, self.solver.start_s());
            *t_s = later(start_s, *t_s, dt);
        }
        for (k, cell) in cells.iter().enumerate().take_while(|(_, cell)| cell.segment < end) {
            let segment = &segments[cell.segment];
            let stamps = &mut all[cell.segment - first];
            let s = |f: f64| segment.s(cell.from + f * cell.length).clamp(0.0, 1.0);
            let parts = self.parts(segment, k);
            let is_last = cells.get(k + 1).is_none_or(|next| next.segment != cell.segment);
            for part in 0..parts {
                let [from, middle, to] =
                    [0.0, 0.5, 1.0].map(|half| (f64::from(part) + half) / f64::from(parts));
                let [x, dx, _] = self.solver.at(k, from);
                let dt = self.time_scale * self.duration_s(k, cell, from, to);
                let way = [cell.from + from * cell.length, (to - from) * cell.length];
                self.node(stamps, segment, way, [*t_s, dt], [x, dx]);
                self.usage(stamps, segment, s(middle), in_time(self.solver.at(k, middle)), dt);
                *t_s = later(start_s, *t_s, dt);
            }
            if is_last {
                let [x, dx, _] = self.solver.at(k, 1.0);
                // Exactly at the segment's end, unless it goes on to rest.
                let rests = to_rest.segment == cell.segment;
                let end = if rests { cell.from + cell.length } else { segment.length };
                self.node(stamps, segment, [end, 0.0], [*t_s, 0.0], [x, dx]);
            }
        }
        if to_rest.segment < end {
            let stamps = &mut all[to_rest.segment - first];
            let segment = &segments[to_rest.segment];
            let dt = self.time_scale * self.solver.stop_s();
            if let Some(before) = stamps.nodes.last_mut() {
                (before.dp, before.dt_s) = (to_rest.length / segment.length, dt);
            }
            self.rest(stamps, segment, to_rest, self.solver.stop_s());
            *t_s = later(start_s, *t_s, dt);
            self.node(stamps, segment, [segment.length, 0.0], [*t_s, 0.0], [0.0; 2]);
        }
        all
    }

    /// Adds a node at a sigma and an instant, with the way and the time to the next one; x and its derivative by
    /// sigma are those there.
    fn node(
        &self,
        stamps: &mut SegmentStamps,
        segment: &LimitedSegment<'_>,
        [sigma, way]: [f64; 2],
        [t_s, dt_s]: [f64; 2],
        [x, dx]: [f64; 2],
    ) {
        let length = segment.length;
        let rate = x.sqrt() / (length * self.time_scale);
        let u = 0.5 * dx / (length * self.time_scale * self.time_scale);
        stamps.nodes.push(Node { t_s, dt_s, p: sigma / length, dp: way / length, rate, u: [u; 2] });
    }

    /// Adds what holds at `s` for `dt`, at speed, acceleration and jerk of sigma.
    fn usage(
        &self,
        stamps: &mut SegmentStamps,
        segment: &LimitedSegment<'_>,
        s: f64,
        [v, a, j]: [f64; 3],
        dt: f64,
    ) {
        let time_scale = self.time_scale;
        let at = [v / time_scale, a / time_scale.powi(2), j / time_scale.powi(3)];
        stamps.usage.sample(&segment.shares(&segment.derivatives(s), at), dt);
    }

    /// Adds a cell that touches rest, in which jerk is constant.
    fn rest(
        &self,
        stamps: &mut SegmentStamps,
        segment: &LimitedSegment<'_>,
        cell: &Cell,
        seconds: f64,
    ) {
        let jerk = 6.0 * cell.length / seconds.powi(3);
        let half = [0.125 * jerk * seconds * seconds, 0.5 * jerk * seconds, jerk];
        self.usage(stamps, segment, 0.0, half, seconds * self.time_scale);
    }

    /// How slow an inner cell is: above 1, very much so.
    fn slowness(&self, segment: &LimitedSegment<'_>, k: usize) -> f64 {
        let cell = &self.mesh.cells[k];
        self.duration_s(k, cell, 0.0, 1.0) / (REFINEMENT.slow * segment.least_build_up_s)
    }

    /// Into how many parts an inner cell is divided by nodes: in a cell that is slow, or in which x changes
    /// much, one polynomial of time would not follow it.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "it is from 2 to 16"
    )]
    fn parts(&self, segment: &LimitedSegment<'_>, k: usize) -> u32 {
        let [start, end] = [0.0, 1.0].map(|f| self.solver.at(k, f)[0]);
        let doublings = (end / start).log2().abs();
        (2.0 + 2.0 * doublings + self.slowness(segment, k)).min(16.0) as u32
    }

    /// Time from the share `from` to the share `to` of an inner cell: Gauss's quadrature.
    fn duration_s(&self, k: usize, cell: &Cell, from: f64, to: f64) -> f64 {
        const HALF_WIDTH: f64 = 0.387_298_334_620_741_7;
        let at = |f: f64| 1.0 / self.solver.at(k, from + f * (to - from))[0].sqrt();
        let mean = (5.0 * (at(0.5 - HALF_WIDTH) + at(0.5 + HALF_WIDTH)) + 8.0 * at(0.5)) / 18.0;
        mean * (to - from) * cell.length
    }
}

/// The check of all cells, by the widest vector instructions that the machine has.
struct Check<'a, 'b> {
    solution: &'a Solution,
    segments: &'a [LimitedSegment<'b>],
    parts: u32,
}

impl pulp::WithSimd for Check<'_, '_> {
    type Output = Vec<[f64; 3]>;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        let cells = 0..self.solution.mesh.cells.len();
        cells.map(|k| self.solution.worst_of(k, self.segments, self.parts)).collect()
    }
}

impl Section {
    /// Replaces the stamps of its pieces, which all move.
    fn stamp(&mut self, stamps: Vec<SegmentStamps>) {
        self.nodes.clear();
        for (piece, SegmentStamps { mut nodes, usage }) in self.pieces.iter_mut().zip(stamps) {
            for i in 1..nodes.len() {
                nodes[i - 1].u[1] = nodes[i].u[0];
            }
            let from = self.nodes.len();
            let [start, end] = [nodes[0].t_s, nodes[nodes.len() - 1].t_s];
            self.nodes.append(&mut nodes);
            let limits = &self.path.limits()[piece.motion.index()];
            let full = &self.path.robot().limits().velocity_rad_s;
            piece.nodes = from..self.nodes.len();
            piece.start_s = self.start_s + start;
            piece.end_s = self.start_s + end;
            piece.duration_s = end - start;
            piece.peak_velocity_rel = usage.peak_velocity_rel(&limits.velocity_rad_s, full);
            piece.limited_by = Some(usage.limit());
            piece.usage = usage;
            debug_assert!(matches!(piece.kind, PieceKind::Line | PieceKind::Blend));
        }
    }
}
