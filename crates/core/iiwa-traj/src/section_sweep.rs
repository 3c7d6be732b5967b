//! Acceleration-limited stamps of a section, or of a part of it.

use std::{
    ops::Range,
    sync::atomic::{AtomicBool, Ordering},
};

use iiwa_kin::Joints;
use iiwa_path::{Derivatives, JointPath, Segment, Step, ToolCoordinate};
use iiwa_program::{LimitKind, MotionIndex};
use iiwa_solver::{PathRow, RowLimits};
use pulp::Simd;

use crate::{
    grid::{Grid, GridNode, tool_derivatives},
    interval::{self, Node},
    limit_usage::{LimitUsage, TOLERANCE},
    line_limits::LineLimits,
    path_limits::StepLimits,
    section::{Piece, Section},
    sweep::{self, Bounds, MAX_GROUPS, Nodes, SweepNode},
    timing::TimingError,
};

/// Memory of sweeps that is reused from section to section, for any number of rows of further
/// limits.
#[derive(Debug)]
pub(crate) struct SweepScratch {
    plain: Scratch<1>,
    /// Memory for up to eight and up to sixteen rows of further limits.
    eight: Option<Scratch<2>>,
    sixteen: Option<Scratch<3>>,
}

/// Memory of sweeps with `R` groups of eight lines: one of accelerations, the others of further
/// limits.
#[derive(Debug)]
struct Scratch<const R: usize> {
    grid: Grid,
    /// Nodes of all segments.
    samples: Vec<SweepNode>,
    /// Samples and bounds of curves, kept from the backward pass for the forward pass.
    curves: Vec<CurveSamples<R>>,
}

impl SweepScratch {
    /// Creates memory for grids of `intervals` intervals.
    pub(crate) fn new(intervals: usize) -> Self {
        Self { plain: Scratch::new(intervals), eight: None, sixteen: None }
    }
}

impl<const R: usize> Scratch<R> {
    fn new(intervals: usize) -> Self {
        Self { grid: Grid::new(intervals), samples: Vec::new(), curves: Vec::new() }
    }
}

/// Largest number of nodes that are kept, of about 0.4 kB each: 64 curves of 100 intervals.
const KEPT_NODES: usize = 6_500;

/// Derivatives and constraints at the nodes of one curve.
#[derive(Debug, Default)]
struct CurveSamples<const R: usize> {
    /// Index of the segment among the path's steps.
    step: Option<usize>,
    grid: Vec<GridNode>,
    dq: Vec<[f64; 8]>,
    ddq: Vec<[f64; 8]>,
    /// Rows of further limits, node after node.
    rows: Vec<PathRow>,
    bounds: Vec<Bounds<R>>,
}

impl<const R: usize> CurveSamples<R> {
    /// Samples a segment at the nodes of a grid.
    #[inline(never)]
    fn fill<S: Simd>(&mut self, simd: S, segment: &SweepSegment<'_>, grid: &Grid, nodes: usize) {
        self.dq.resize(nodes, [0.0; 8]);
        self.ddq.resize(nodes, [0.0; 8]);
        self.bounds.resize(nodes, Bounds::default());
        self.grid.clear();
        self.grid.extend_from_slice(&grid.nodes_on(segment.shape));
        grid.derivatives_on(segment.shape, &segment.scale, &mut self.dq, &mut self.ddq);
        segment.tool_derivatives(&self.grid, &mut self.dq, &mut self.ddq);
        segment.rows(&self.grid, &mut self.rows);
        let Self { grid, dq, ddq, bounds, rows, .. } = self;
        let (velocity, row_count) = (&segment.velocity, segment.row_count());
        let nodes = Nodes { simd, dq, ddq, velocity, grid, rows, row_count };
        simd.vectorize(
            #[inline(always)]
            move || {
                // Moved in by value: the closure itself is then inlined into the function with the
                // vector registers.
                let (nodes, bounds) = (nodes, bounds);
                sweep::bounds(nodes, bounds);
            },
        );
    }
}

/// Intervals per blend of the acceleration-limited stamps that are the start of the jerk-limited
/// ones.
pub(crate) const SAMPLES_BEFORE_JERK: usize = 32;

/// Largest number of sweeps of one section until no interval has to be tightened.
const ROUNDS: usize = 30;

/// Moves that follow each other without a stop.
pub(crate) struct Moves<'a> {
    /// Indices among the path's steps.
    pub(crate) steps: Range<usize>,
    /// Squared path speeds |dq/dt|^2 at the start and at the end, in rad^2/s^2; none at rest.
    pub(crate) ends: [Option<f64>; 2],
    /// Further limits of each of the steps, if any.
    pub(crate) limits: &'a [StepLimits],
}

/// Plans `moves` and adds them to `section`, as pieces that keep the velocity, acceleration and
/// further limits of their steps.
pub(crate) fn sweep_moves(
    moves: &Moves<'_>,
    scratch: &mut SweepScratch,
    stop: &AtomicBool,
    section: &mut Section,
) -> Result<(), TimingError> {
    let SweepScratch { plain, eight, sixteen } = scratch;
    let intervals = plain.grid.intervals();
    let rows = moves.limits.iter().map(|limits| limits.rows.count()).max().unwrap_or(0);
    match 1 + rows.div_ceil(8) {
        1 => sweep_by(moves, plain, stop, section),
        2 => {
            let scratch = eight.get_or_insert_with(|| Scratch::new(intervals));
            sweep_by(moves, scratch, stop, section)
        }
        MAX_GROUPS => {
            let scratch = sixteen.get_or_insert_with(|| Scratch::new(intervals));
            sweep_by(moves, scratch, stop, section)
        }
        _ => Err(TimingError::TooManyRows { rows, max: 8 * (MAX_GROUPS - 1) }),
    }
}

/// Plans moves with the memory for their number of rows.
fn sweep_by<const R: usize>(
    moves: &Moves<'_>,
    scratch: &mut Scratch<R>,
    stop: &AtomicBool,
    section: &mut Section,
) -> Result<(), TimingError> {
    // Cached curves belong to the path and the limits of an earlier call.
    scratch.curves.iter_mut().for_each(|curve| curve.step = None);
    pulp::Arch::new().dispatch(WidestSweep { moves, scratch, stop, section })
}

/// Sweep with the widest vector instructions of the machine.
///
/// A struct and not a closure: `pulp` calls closures through a shim that is not inlined into the
/// function with vector instructions, so they would be compiled without these.
struct WidestSweep<'a, const R: usize> {
    moves: &'a Moves<'a>,
    scratch: &'a mut Scratch<R>,
    stop: &'a AtomicBool,
    section: &'a mut Section,
}

impl<const R: usize> pulp::WithSimd for WidestSweep<'_, R> {
    type Output = Result<(), TimingError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let WidestSweep { moves, scratch, stop, section } = self;
        let path = &section.path.clone();
        let Moves { ref steps, limits, .. } = *moves;
        SectionSweep { simd, path, scratch, stop, first_step: steps.start, limits }
            .moves(moves, section)
    }
}

/// Inputs and memory for planning one section.
struct SectionSweep<'a, S, const R: usize> {
    simd: S,
    path: &'a JointPath,
    scratch: &'a mut Scratch<R>,
    stop: &'a AtomicBool,
    /// Step of the first entry of `limits`.
    first_step: usize,
    limits: &'a [StepLimits],
}

/// Segment with its limits, in the form that the sweep uses.
struct SweepSegment<'a> {
    shape: &'a dyn Segment,
    motion: MotionIndex,
    /// Reciprocal of each acceleration limit.
    scale: Joints,
    /// Acceleration limits over velocity limits, in 1/s.
    velocity: [f64; 8],
    /// Tool coordinate, if it is limited, and its scale in place of `scale`.
    tool: Option<(ToolCoordinate, f64)>,
    line: Option<LineLimits>,
    /// Further limits, if there are any.
    rows: Option<&'a RowLimits>,
}

/// Ratio of acceleration to speed limit, in 1/s, that replaces a missing limit of the tool's
/// acceleration: too high to become active.
const AT_ONCE_PER_S: f64 = 1e9;

impl SweepSegment<'_> {
    /// Adds the derivatives of the tool at the `nodes` of a grid to those of the joints.
    fn tool_derivatives(&self, nodes: &[GridNode], dq: &mut [[f64; 8]], ddq: &mut [[f64; 8]]) {
        let Some((tool, scale)) = &self.tool else { return };
        let [end, ..] = self.shape.sigma(1.0);
        for ((node, dq), ddq) in nodes.iter().zip(dq).zip(ddq) {
            let s = self.shape.s_at(node.p * end).clamp(0.0, 1.0);
            let derivatives = tool_derivatives(tool, self.shape, s, node);
            [dq[7], ddq[7]] = derivatives.map(|derivative| derivative * scale);
        }
    }

    fn row_count(&self) -> usize {
        self.rows.map_or(0, RowLimits::count)
    }

    /// Sets `rows` to the rows of further limits by p at the `nodes` of a grid.
    fn rows(&self, nodes: &[GridNode], rows: &mut Vec<PathRow>) {
        rows.clear();
        let Some(limits) = self.rows else { return };
        let [mut q, mut first, mut second] = [(); 3].map(|()| Vec::with_capacity(nodes.len()));
        for node in nodes {
            let Derivatives { q: joints, dq, ddq, .. } = self.shape.at_share(node.p);
            q.push(joints);
            first.push(dq);
            second.push(ddq);
        }
        *rows = limits.rows(&q, &first, &second);
    }
}

impl<'a, S: Simd, const R: usize> SectionSweep<'a, S, R> {
    #[inline(never)]
    fn segment(&self, step: usize) -> Option<SweepSegment<'a>> {
        let path: &'a JointPath = self.path;
        let Step::Move { motion, segment, .. } = &path.steps()[step] else { return None };
        let limits = path.limits_of(step);
        let rows = self.limits.get(step - self.first_step).map(|limits| &limits.rows);
        let rows = rows.filter(|rows| rows.count() > 0);
        let [speed, acceleration] = [limits.velocity_rad_s(), limits.acceleration_rad_s2()];
        let mut velocity = [0.0; 8];
        for j in 0..7 {
            velocity[j] = acceleration[j] / speed[j];
        }
        let tool = ToolCoordinate::new(segment.as_ref(), limits.tool());
        let tool = tool.map(|tool| {
            let [speed, acceleration] =
                [LimitKind::Velocity, LimitKind::Acceleration].map(|kind| tool.limits()[kind]);
            let acceleration = acceleration.min(AT_ONCE_PER_S * speed);
            // Both limits are infinite if only the tool's jerk is limited.
            velocity[7] = if speed.is_finite() { acceleration / speed } else { 0.0 };
            (tool, 1.0 / acceleration)
        });
        Some(SweepSegment {
            shape: segment.as_ref(),
            motion: *motion,
            scale: acceleration.map(|a| 1.0 / a),
            velocity,
            tool,
            // Further limits change along a line, and the closed form requires constant limits.
            line: (segment.is_straight() && tool.is_none() && rows.is_none()).then(|| {
                let direction = segment.at(0.0).dq;
                LineLimits::new(&direction, speed, acceleration)
            }),
            rows,
        })
    }

    /// Creates the error of a section without a feasible motion from the step at `step` on.
    fn stuck(&self, step: usize) -> TimingError {
        let motion = self.segment(step).map_or(MotionIndex::default(), |segment| segment.motion);
        TimingError::Stuck { motion }
    }

    fn nodes(&self, segment: &SweepSegment<'_>) -> usize {
        if segment.line.is_some() { 2 } else { self.scratch.grid.intervals_on(segment.shape) + 1 }
    }

    /// Plans `moves` and adds them to `section`.
    #[inline(always)]
    fn moves(&mut self, moves: &Moves<'_>, section: &mut Section) -> Result<(), TimingError> {
        let steps = &moves.steps;
        let total = steps
            .clone()
            .filter_map(|step| self.segment(step))
            .map(|segment| self.nodes(&segment))
            .sum();
        let mut samples = std::mem::take(&mut self.scratch.samples);
        samples.clear();
        samples.resize(total, SweepNode::default());
        // A line yields up to four nodes but uses two samples.
        section.nodes.reserve_exact(total + 2 * steps.len());

        for round in 0..ROUNDS {
            if !self.sweep(moves, round > 0, &mut samples, section)? {
                break;
            }
            section.pieces.clear();
            section.nodes.clear();
        }
        // The pieces are empty if the last round still had to tighten intervals.
        if section.pieces.is_empty() && !steps.is_empty() {
            return Err(self.stuck(steps.start));
        }
        self.scratch.samples = samples;
        Ok(())
    }

    /// Runs one backward and one forward pass; `again` applies the shares found by an earlier
    /// round. Returns true if intervals were tightened, so that another round is necessary.
    #[inline(always)]
    fn sweep(
        &mut self,
        Moves { steps, ends: [start, end], .. }: &Moves<'_>,
        again: bool,
        samples: &mut [SweepNode],
        section: &mut Section,
    ) -> Result<bool, TimingError> {
        let mut tightened = false;
        // Backward pass, from rest: the upper bound of the controllable set at each node.
        let mut next: Option<(f64, f64)> = end.map(|square| (square, 1.0));
        let mut to = samples.len();
        for step in steps.clone().rev() {
            let Some(segment) = self.segment(step) else { continue };
            if self.stop.load(Ordering::Relaxed) {
                return Err(TimingError::Interrupted);
            }
            let from = to - self.nodes(&segment);
            let [first, last] = self.tangent_lengths_rad(&segment, step);
            // x refers to the p of its segment; at the joint, both have the same path speed.
            let end = next.map_or(0.0, |(x, tangent)| x * (tangent / last).powi(2));
            let samples = &mut samples[from..to];
            if let Some(line) = &segment.line {
                samples[1].x = end.min(line.x_max);
                samples[0].x = line.reach(samples[1].x);
            } else {
                let (nodes, bounds) = self.curve(&segment, step);
                if again {
                    sweep::lower(bounds, samples);
                }
                sweep::backward(nodes, bounds, end, samples);
            }
            next = Some((samples[0].x, first));
            to = from;
        }

        // At the given speed, the robot could not slow down in time.
        if let (Some(start), Some((x, tangent))) = (*start, next)
            && x * tangent * tangent < start * (1.0 - TOLERANCE)
        {
            return Err(self.stuck(steps.start));
        }

        // Forward pass, from rest: the largest x within the controllable sets.
        let mut before: Option<(f64, f64)> = start.map(|square| (square, 1.0));
        let mut from = 0;
        let mut t_s = 0.0;
        for step in steps.clone() {
            let Some(segment) = self.segment(step) else { continue };
            let to = from + self.nodes(&segment);
            let [first, last] = self.tangent_lengths_rad(&segment, step);
            let start = before.map_or(0.0, |(x, tangent)| x * (tangent / first).powi(2));
            let samples = &mut samples[from..to];
            let first_node = section.nodes.len();
            if let Some(line) = &segment.line {
                let x0 = start.min(samples[0].x);
                let x1 = line.reach(x0).min(samples[1].x);
                samples[1].x = x1;
                let line = line.fastest(x0, x1);
                stamp(self.simd, line, section.start_s, &mut t_s, &mut section.nodes);
            } else {
                let (nodes, bounds) = self.curve(&segment, step);
                if again {
                    sweep::lower(bounds, samples);
                }
                tightened |= !sweep::sweep_until_valid(nodes, bounds, start, samples);
                let Nodes { simd, grid, .. } = nodes;
                let nodes = grid.iter().map(|node| node.p).zip(samples.iter().copied());
                stamp(simd, nodes, section.start_s, &mut t_s, &mut section.nodes);
            }
            before = Some((samples[samples.len() - 1].x, last));
            from = to;
            // Pieces of a round that is repeated would be discarded.
            if !tightened {
                self.finish_piece(&segment, step, first_node, t_s, section)?;
            }
        }
        Ok(tightened)
    }

    /// Returns the length of the tangent dq/dp at both ends, in rad.
    #[inline(always)]
    fn tangent_lengths_rad(&mut self, segment: &SweepSegment<'_>, step: usize) -> [f64; 2] {
        let [first, last] = segment.shape.tangent_lengths_rad();
        if segment.line.is_some() {
            return [first, last];
        }
        let (Nodes { grid, .. }, _) = self.curve(segment, step);
        [first * grid[0].slope, last * grid[grid.len() - 1].slope]
    }

    /// Returns the nodes of the curve at `step` and their constraints, from the cache if possible.
    #[inline(always)]
    fn curve<'n>(
        &'n mut self,
        segment: &'n SweepSegment<'_>,
        step: usize,
    ) -> (Nodes<'n, S>, &'n mut [Bounds<R>]) {
        let Scratch { grid, curves, .. } = &mut *self.scratch;
        let nodes = grid.intervals_on(segment.shape) + 1;
        // Every second step of blended lines is a curve; the slots between them remain empty.
        let slot = step % (2 * KEPT_NODES / nodes).max(1);
        if curves.len() <= slot {
            curves.resize_with(slot + 1, CurveSamples::default);
        }
        let curve = &mut curves[slot];
        if curve.step != Some(step) {
            curve.step = Some(step);
            curve.fill(self.simd, segment, grid, nodes);
        }
        let CurveSamples { grid, dq, ddq, bounds, rows, .. } = curve;
        let (velocity, row_count) = (&segment.velocity, segment.row_count());
        (Nodes { simd: self.simd, dq, ddq, velocity, grid, rows, row_count }, bounds)
    }

    /// Checks the nodes from `first_node` on against the limits and adds a piece of them.
    #[inline(always)]
    fn finish_piece(
        &mut self,
        segment: &SweepSegment<'_>,
        step: usize,
        first_node: usize,
        end_s: f64,
        section: &mut Section,
    ) -> Result<(), TimingError> {
        let nodes = &section.nodes[first_node..];
        let mut usage = LimitUsage::default();
        if segment.line.is_some() {
            // dq/ds is the same at all nodes of a line: the intervals are added one by one with one
            // row.
            let direction = segment.shape.at(0.0).dq;
            let mut row = [0.0; 8];
            for j in 0..7 {
                row[j] = direction[j] * segment.scale[j];
            }
            for pair in nodes.windows(2) {
                usage.add(pair, &[row; 2], &[[0.0; 8]; 2], &segment.velocity);
            }
        } else {
            let (Nodes { dq, ddq, rows, row_count, .. }, _) = self.curve(segment, step);
            usage.add(nodes, dq, ddq, &segment.velocity);
            usage.add_rows(nodes, rows, row_count);
            if let Some(StepLimits { limits, .. }) = self.limits.get(step - self.first_step) {
                usage.name_rows(limits);
            }
        }
        let motion = segment.motion;
        // The robot would stop on the way: a speed of zero makes the time infinite.
        if !end_s.is_finite() {
            return Err(TimingError::Stuck { motion });
        }
        let tool = segment.tool.map(|(tool, _)| tool);
        let source = section.path.limits_of(step).tcp_speed_source();
        let (limit, ratio) = usage.clone().with_tool_limits(tool.as_ref(), source).worst();
        if ratio > 1.0 + TOLERANCE {
            return Err(TimingError::LimitExceeded { motion, limit, ratio });
        }
        let times_s = [nodes[0].t_s, end_s];
        let nodes = first_node..section.nodes.len();
        section.pieces.extend(Piece::moving(section, step, times_s, &usage, nodes));
        Ok(())
    }
}

/// Adds nodes for samples at p with their times, counted from `t_s` in a section that starts at
/// `start_s`.
#[inline(always)]
fn stamp<S: Simd>(
    simd: S,
    samples: impl Iterator<Item = (f64, SweepNode)>,
    start_s: f64,
    t_s: &mut f64,
    nodes: &mut Vec<Node>,
) {
    let first = nodes.len();
    for (p, SweepNode { x, u, .. }) in samples {
        nodes.push(Node { t_s: *t_s, p, rate: x.sqrt(), u, ..Node::default() });
    }
    let mut nodes = &mut nodes[first..];
    while nodes.len() > 1 {
        // Eight intervals at a time; unused ones of the last group have neutral values.
        let intervals = (nodes.len() - 1).min(8);
        let (mut dp, mut rates, mut change) = ([1.0; 8], [1.0; 8], [0.0; 8]);
        for (i, pair) in nodes.windows(2).take(8).enumerate() {
            dp[i] = pair[1].p - pair[0].p;
            rates[i] = pair[0].rate + pair[1].rate;
            change[i] = pair[0].u[1] - pair[0].u[0];
        }
        let durations = interval::durations(simd, &dp, &rates, &change);
        for (i, (dp, duration)) in dp.into_iter().zip(durations).enumerate().take(intervals) {
            (nodes[i].dp, nodes[i].dt_s) = (dp, duration);
            *t_s = interval::later(start_s, *t_s, duration);
            nodes[i + 1].t_s = *t_s;
        }
        nodes = &mut nodes[intervals..];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use iiwa_kin::Robot;
    use iiwa_program::Program;

    #[test]
    fn the_same_without_vector_instructions() {
        let text = r#"{ "version": 1, "start": { "joints_deg": [0, 10, 0, -80, 0, 60, 0] },
            "motions": [
                { "type": "ptp", "joints_deg": [40, 30, -20, -60, 10, 50, 30],
                  "blend": { "fraction": 0.4 } },
                { "type": "ptp", "joints_deg": [-10, 50, 30, -90, -20, 70, 0],
                  "blend": { "fraction": 0.3 } },
                { "type": "ptp", "joints_deg": [40, 30, -20, -60, 10, 50, 30],
                  "blend": { "fraction": 0.5 } },
                { "type": "ptp", "joints_deg": [0, 10, 0, -80, 0, 60, 0] }] }"#;
        let program = Program::from_json(text).unwrap();
        let path = JointPath::new(&program, &Robot::lbr_iiwa_7_r800()).unwrap();
        let widest =
            crate::Planner::new(&path, crate::Timing::Acceleration(crate::SweepOptions::default()))
                .next()
                .unwrap()
                .unwrap();

        let mut scratch = Scratch::<1>::new(100);
        let mut section = Section { pieces: Vec::new(), nodes: Vec::new(), ..widest.clone() };
        let sweep = WidestSweep {
            moves: &Moves { steps: 0..7, ends: [None; 2], limits: &[] },
            scratch: &mut scratch,
            stop: &AtomicBool::new(false),
            section: &mut section,
        };
        pulp::WithSimd::with_simd(sweep, pulp::Scalar::new()).unwrap();
        assert_eq!(widest.nodes.len(), section.nodes.len());
        for (a, b) in widest.nodes.iter().zip(&section.nodes) {
            assert!(
                (a.t_s - b.t_s).abs() < 1e-9 && (a.rate - b.rate).abs() < 1e-6 * a.rate.max(1.0)
            );
        }
    }
}
