//! Finds the stamps of a path, one section at a time.

use std::{
    cell::Cell,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use iiwa_kin::Joints;
use iiwa_path::{Grid, GridNode, JointPath, MotionIndex, Segment, Step};
use pulp::Simd;

use crate::{
    interval, jerk,
    limit_usage::{LimitUsage, TOLERANCE},
    line_limits::LineLimits,
    node::Node,
    section::{Piece, PieceKind, Section},
    sweep::{self, Bounds, Nodes, Sample},
    timing::{JerkOptions, Timing, TimingError},
};

/// Plans a path section by section: an iterator that needs memory for one of them only.
///
/// ```
/// use iiwa_kin::Robot;
/// use iiwa_path::{Blend, JointPath, Program};
/// use iiwa_traj::{Planner, Timing};
///
/// let program = Program::from_deg([0.0; 7])
///     .ptp_deg([40.0, 0.0, 0.0, -60.0, 0.0, 0.0, 0.0])
///     .blend(Blend::Fraction(0.3))
///     .ptp_deg([40.0, 30.0, 0.0, -30.0, 0.0, 0.0, 0.0])
///     .build();
/// let path = JointPath::new(&program, &Robot::default())?;
/// let mut cycle_time_s = 0.0;
/// for section in Planner::new(&path, Timing::default()) {
///     // Written, sent or dropped before the next one is planned.
///     cycle_time_s = section?.end_s();
/// }
/// assert!(cycle_time_s > 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Planner {
    path: JointPath,
    jerk: Option<JerkOptions>,
    /// The next of the path's steps.
    step: usize,
    time_s: f64,
    rest_rad: Joints,
    scratch: Scratch,
    /// Whether it is to stop.
    stop: Arc<AtomicBool>,
}

/// Memory that is used again for each section.
#[derive(Debug)]
struct Scratch {
    grid: Grid,
    /// The nodes of all segments.
    samples: Vec<Sample>,
    /// What the way backwards found out about curves, for the way forwards.
    curves: Vec<CurveSamples>,
}

thread_local! {
    /// Of the last planner of this thread: to ask the system for fresh memory takes as long as to
    /// plan ten motions.
    static SPARE: Cell<Option<Scratch>> = const { Cell::new(None) };
}

impl Default for Scratch {
    fn default() -> Self {
        Self { grid: Grid::new(1), samples: Vec::new(), curves: Vec::new() }
    }
}

impl Scratch {
    fn take(intervals: usize) -> Self {
        let mut scratch = SPARE.take().unwrap_or_default();
        if scratch.grid.intervals() != intervals {
            scratch.grid = Grid::new(intervals);
        }
        scratch.curves.iter_mut().for_each(|curve| curve.step = None);
        scratch
    }
}

impl Drop for Planner {
    fn drop(&mut self) {
        let mut scratch = std::mem::take(&mut self.scratch);
        scratch.samples.clear();
        scratch.samples.shrink_to(KEPT_NODES);
        // A thread that ends has no spare any more.
        let _ = SPARE.try_with(|spare| spare.set(Some(scratch)));
    }
}

/// Most nodes that are kept, of about 0.4 kB each: 64 curves of 100 intervals.
const KEPT_NODES: usize = 6_500;

/// The derivatives at the nodes of one curve, and what the limits leave there.
#[derive(Debug, Default)]
struct CurveSamples {
    /// Place of the segment among the path's steps.
    step: Option<usize>,
    grid: Vec<GridNode>,
    dq: Vec<[f64; 8]>,
    ddq: Vec<[f64; 8]>,
    bounds: Vec<Bounds>,
}

impl Planner {
    /// A planner for `path`.
    #[must_use]
    pub fn new(path: &JointPath, timing: Timing) -> Self {
        let (samples, jerk) = match timing {
            Timing::Acceleration(options) => (options.samples.max(2), None),
            Timing::Jerk(options) => (SAMPLES_BEFORE_JERK, Some(options)),
        };
        Self {
            path: path.clone(),
            jerk,
            step: 0,
            time_s: 0.0,
            rest_rad: *path.start_rad(),
            scratch: Scratch::take(samples),
            stop: Arc::default(),
        }
    }

    /// Ends in [`TimingError::Interrupted`] soon after `stop` is set, in the middle of a section as well.
    #[must_use]
    pub fn interrupted_by(mut self, stop: Arc<AtomicBool>) -> Self {
        self.stop = stop;
        self
    }

    /// Share of the path's steps that are planned, 0 to 1.
    #[must_use]
    pub fn progress(&self) -> f64 {
        self.step as f64 / self.path.steps().len().max(1) as f64
    }
}

impl Iterator for Planner {
    type Item = Result<Section, TimingError>;

    fn next(&mut self) -> Option<Self::Item> {
        let steps = self.path.steps();
        let first = self.step;
        let moves = |step: &Step| matches!(step, Step::Move { .. });
        let rest = first + steps[first..].iter().take_while(|step| moves(step)).count();
        let end = rest + steps[rest..].iter().take_while(|step| !moves(step)).count();
        if first == end {
            return None;
        }
        self.step = end;
        let mut section = Section {
            path: self.path.clone(),
            start_s: self.time_s,
            rest_rad: match steps[first..rest].last() {
                Some(Step::Move { segment, .. }) => segment.at(1.0).q,
                _ => self.rest_rad,
            },
            pieces: Vec::with_capacity(end - first),
            nodes: Vec::new(),
        };
        let moves = Moves {
            path: &self.path,
            scratch: &mut self.scratch,
            stop: &self.stop,
            steps: first..rest,
            section: &mut section,
        };
        let mut result = pulp::Arch::new().dispatch(moves);
        if let Some(options) = self.jerk {
            result = result.and_then(|()| jerk::limit(&mut section, options, &self.stop));
        }
        if let Err(error) = result {
            self.step = steps.len();
            return Some(Err(error));
        }
        let mut time_s = section.end_s();
        for (step, rest) in steps.iter().enumerate().take(end).skip(rest) {
            let (kind, motion, seconds) = match *rest {
                Step::Settle { motion } => {
                    (PieceKind::Settle, motion, self.path.robot().settle_time_s())
                }
                Step::Wait { motion, seconds } => (PieceKind::Wait, motion, seconds),
                _ => continue,
            };
            // What takes no time has no place in it: stamps increase.
            if time_s + seconds <= time_s {
                continue;
            }
            section.pieces.push(Piece {
                kind,
                motion,
                start_s: time_s,
                end_s: time_s + seconds,
                duration_s: seconds,
                peak_velocity_rel: 0.0,
                limited_by: None,
                usage: LimitUsage::default(),
                step,
                nodes: 0..0,
            });
            time_s += seconds;
        }
        self.time_s = time_s;
        self.rest_rad = section.rest_rad;
        Some(Ok(section))
    }
}

/// Intervals a blend of the acceleration-limited stamps from which jerk-limited ones are sought.
const SAMPLES_BEFORE_JERK: usize = 32;

/// Most sweeps of one section until none of its intervals has to be tightened.
const ROUNDS: usize = 30;

/// The moves of one section, planned with the widest vector instructions that the machine has.
///
/// Not a closure: those reach the function with vector instructions by way of a shim that is not
/// inlined into it, and so stay without them.
struct Moves<'a> {
    path: &'a JointPath,
    scratch: &'a mut Scratch,
    stop: &'a AtomicBool,
    steps: std::ops::Range<usize>,
    section: &'a mut Section,
}

impl pulp::WithSimd for Moves<'_> {
    type Output = Result<(), TimingError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Moves { path, scratch, stop, steps, section } = self;
        SectionSweep { simd, path, scratch, stop }.moves(steps, section)
    }
}

/// What one section is planned with.
struct SectionSweep<'a, S> {
    simd: S,
    path: &'a JointPath,
    scratch: &'a mut Scratch,
    stop: &'a AtomicBool,
}

/// A segment and its limits, in the form that the sweep takes.
struct SweepSegment<'a> {
    shape: &'a dyn Segment,
    motion: MotionIndex,
    is_blend: bool,
    /// One over each acceleration limit.
    scale: Joints,
    /// Acceleration limits over velocity limits, in 1/s.
    velocity: [f64; 8],
    line: Option<LineLimits>,
}

impl<'a, S: Simd> SectionSweep<'a, S> {
    #[inline(always)]
    fn segment(&self, step: usize) -> Option<SweepSegment<'a>> {
        let path: &'a JointPath = self.path;
        let Step::Move { motion, segment, blend } = &path.steps()[step] else { return None };
        let limits = &path.limits()[motion.index()];
        let [speed, acceleration] = [limits.velocity_rad_s(), limits.acceleration_rad_s2()];
        let mut velocity = [0.0; 8];
        for j in 0..7 {
            velocity[j] = acceleration[j] / speed[j];
        }
        Some(SweepSegment {
            shape: segment.as_ref(),
            motion: *motion,
            is_blend: blend.is_some(),
            scale: acceleration.map(|a| 1.0 / a),
            velocity,
            line: segment.is_straight().then(|| {
                let direction = segment.at(0.0).dq;
                LineLimits::new(&direction, speed, acceleration)
            }),
        })
    }

    fn nodes(&self, segment: &SweepSegment<'_>) -> usize {
        if segment.line.is_some() { 2 } else { self.scratch.grid.intervals() + 1 }
    }

    /// Plans the moves among `steps` and adds them to `section`.
    #[inline(always)]
    fn moves(
        &mut self,
        steps: std::ops::Range<usize>,
        section: &mut Section,
    ) -> Result<(), TimingError> {
        let total = steps
            .clone()
            .filter_map(|step| self.segment(step))
            .map(|segment| self.nodes(&segment))
            .sum();
        let mut samples = std::mem::take(&mut self.scratch.samples);
        samples.clear();
        samples.resize(total, Sample::default());
        // A line has up to four nodes, and two among the samples.
        section.nodes.reserve_exact(total + 2 * steps.len());

        for round in 0..ROUNDS {
            if !self.sweep(steps.clone(), round > 0, &mut samples, section)? {
                break;
            }
            section.pieces.clear();
            section.nodes.clear();
        }
        if section.pieces.is_empty() && !steps.is_empty() {
            let motion =
                self.segment(steps.start).map_or(MotionIndex::default(), |segment| segment.motion);
            return Err(TimingError::Stuck { motion });
        }
        self.scratch.samples = samples;
        Ok(())
    }

    /// Sweeps backwards and forwards once, `again` with what an earlier time found. True if intervals had to
    /// be tightened, which makes another time necessary.
    #[inline(always)]
    fn sweep(
        &mut self,
        steps: std::ops::Range<usize>,
        again: bool,
        samples: &mut [Sample],
        section: &mut Section,
    ) -> Result<bool, TimingError> {
        let mut tightened = false;
        // Backwards, from rest: at each node the largest x that all that follows allows.
        let mut next: Option<(f64, f64)> = None;
        let mut to = samples.len();
        for step in steps.clone().rev() {
            let Some(segment) = self.segment(step) else { continue };
            if self.stop.load(Ordering::Relaxed) {
                return Err(TimingError::Interrupted);
            }
            let from = to - self.nodes(&segment);
            let [first, last] = self.tangent_lengths_rad(&segment, step);
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

        // Forwards, from rest: as fast as that allows.
        let mut before: Option<(f64, f64)> = None;
        let mut from = 0;
        let mut t_s = 0.0;
        for step in steps {
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
            if !tightened {
                self.finish_piece(&segment, step, first_node, t_s, section)?;
            }
        }
        Ok(tightened)
    }

    /// Length of the tangent dq/dp at both ends, in rad.
    #[inline(always)]
    fn tangent_lengths_rad(&mut self, segment: &SweepSegment<'_>, step: usize) -> [f64; 2] {
        let [first, last] = segment.shape.tangent_lengths_rad();
        if segment.line.is_some() {
            return [first, last];
        }
        let (Nodes { grid, .. }, _) = self.curve(segment, step);
        [first * grid[0].slope, last * grid[grid.len() - 1].slope]
    }

    /// The nodes of a curve, of which `step` is the place, and what the limits leave there.
    #[inline(always)]
    fn curve<'n>(
        &'n mut self,
        segment: &'n SweepSegment<'_>,
        step: usize,
    ) -> (Nodes<'n, S>, &'n mut [Bounds]) {
        let Scratch { grid, curves, .. } = &mut *self.scratch;
        let nodes = grid.intervals() + 1;
        // Of blended motions, every second step is a curve.
        let slot = (step / 2) % (KEPT_NODES / nodes).max(1);
        if curves.len() <= slot {
            curves.resize_with(slot + 1, CurveSamples::default);
        }
        let curve = &mut curves[slot];
        if curve.step != Some(step) {
            curve.step = Some(step);
            curve.dq.resize(nodes, [0.0; 8]);
            curve.ddq.resize(nodes, [0.0; 8]);
            curve.bounds.resize(nodes, Bounds::default());
            let CurveSamples { dq, ddq, bounds, .. } = curve;
            curve.grid.clear();
            curve.grid.extend_from_slice(&segment.shape.grid_nodes(grid));
            segment.shape.grid_derivatives(grid, &segment.scale, dq, ddq);
            sweep::bounds(self.simd, dq, ddq, &segment.velocity, &curve.grid, bounds);
        }
        let CurveSamples { grid, dq, ddq, bounds, .. } = curve;
        (Nodes { simd: self.simd, dq, ddq, velocity: &segment.velocity, grid }, bounds)
    }

    /// Checks the nodes from `first_node` on against the limits and makes them a piece.
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
            // dq/ds is the same at all nodes of a line: one interval after the other.
            let direction = segment.shape.at(0.0).dq;
            let mut row = [0.0; 8];
            for j in 0..7 {
                row[j] = direction[j] * segment.scale[j];
            }
            for pair in nodes.windows(2) {
                usage.add(pair, &[row; 2], &[[0.0; 8]; 2], &segment.velocity);
            }
        } else {
            let (Nodes { dq, ddq, .. }, _) = self.curve(segment, step);
            usage.add(nodes, dq, ddq, &segment.velocity);
        }
        let motion = segment.motion;
        if !end_s.is_finite() {
            return Err(TimingError::Stuck { motion });
        }
        let (limit, ratio) = usage.worst();
        if ratio > 1.0 + TOLERANCE {
            let crate::Limit { joint, kind } = limit;
            return Err(TimingError::LimitExceeded { motion, joint, kind, ratio });
        }
        // Shares of the motion's limits become shares of the robot's.
        let own = self.path.limits()[motion.index()].velocity_rad_s();
        let full = &self.path.robot().limits().velocity_rad_s;
        let peak_velocity_rel = usage.peak_velocity_rel(own, full);
        section.pieces.push(Piece {
            kind: if segment.is_blend { PieceKind::Blend } else { PieceKind::Line },
            motion,
            start_s: section.start_s + nodes[0].t_s,
            end_s: section.start_s + end_s,
            duration_s: end_s - nodes[0].t_s,
            peak_velocity_rel,
            limited_by: Some(usage.limit()),
            usage,
            step,
            nodes: first_node..section.nodes.len(),
        });
        Ok(())
    }
}

/// Gives samples at p their time, counted on from `t_s` in a section that starts at `start_s`.
#[inline(always)]
fn stamp<S: Simd>(
    simd: S,
    samples: impl Iterator<Item = (f64, Sample)>,
    start_s: f64,
    t_s: &mut f64,
    nodes: &mut Vec<Node>,
) {
    let first = nodes.len();
    for (p, Sample { x, u, .. }) in samples {
        nodes.push(Node { t_s: *t_s, p, rate: x.sqrt(), u, ..Node::default() });
    }
    let mut nodes = &mut nodes[first..];
    while nodes.len() > 1 {
        // Eight intervals at a time; of the last eight, some may be empty.
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
    use iiwa_path::Program;

    #[test]
    fn the_same_without_vector_instructions() {
        let text = r#"{ "version": 1, "start": { "joints_deg": [0, 10, 0, -80, 0, 60, 0] }, "motions": [
            { "type": "ptp", "joints_deg": [40, 30, -20, -60, 10, 50, 30], "blend": { "fraction": 0.4 } },
            { "type": "ptp", "joints_deg": [-10, 50, 30, -90, -20, 70, 0], "blend": { "fraction": 0.3 } },
            { "type": "ptp", "joints_deg": [40, 30, -20, -60, 10, 50, 30], "blend": { "fraction": 0.5 } },
            { "type": "ptp", "joints_deg": [0, 10, 0, -80, 0, 60, 0] }] }"#;
        let program = Program::from_json(text).unwrap();
        let path = JointPath::new(&program, &Robot::lbr_iiwa_7_r800()).unwrap();
        let widest = Planner::new(&path, Timing::Acceleration(crate::SweepOptions::default()))
            .next()
            .unwrap()
            .unwrap();

        let mut scratch = Scratch::take(100);
        let mut section = Section { pieces: Vec::new(), nodes: Vec::new(), ..widest.clone() };
        let moves = Moves {
            path: &path,
            scratch: &mut scratch,
            stop: &AtomicBool::new(false),
            steps: 0..7,
            section: &mut section,
        };
        pulp::WithSimd::with_simd(moves, pulp::Scalar::new()).unwrap();
        assert_eq!(widest.nodes.len(), section.nodes.len());
        for (a, b) in widest.nodes.iter().zip(&section.nodes) {
            assert!(
                (a.t_s - b.t_s).abs() < 1e-9 && (a.rate - b.rate).abs() < 1e-6 * a.rate.max(1.0)
            );
        }
    }
}
