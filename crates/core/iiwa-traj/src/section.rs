//! Part of a trajectory from one stop to the next.

use std::ops::Range;

use iiwa_kin::{Joints, Robot};
use iiwa_path::{JointPath, Segment, Step, ToolCoordinate};
use iiwa_program::{MotionIndex, MotionType};

use crate::{
    interval::{self, IntervalProgress, Node},
    limit::{Limit, LimitShare},
    limit_usage::LimitUsage,
    state::State,
};

/// Part of a trajectory: a motion without a stop, followed by the rests at its end.
///
/// Sections are independent of each other, so that a long program can be planned and written
/// section by section. Times are counted from the start of the program.
#[derive(Clone, Debug)]
pub struct Section {
    pub(crate) path: JointPath,
    pub(crate) start_s: f64,
    /// Joint positions at the end and at rest, in rad.
    pub(crate) rest_rad: Joints,
    pub(crate) pieces: Vec<Piece>,
    pub(crate) nodes: Vec<Node>,
    /// Blend after the section that was not known in time.
    pub(crate) late_blend: Option<LateBlend>,
}

/// Blend before which the robot stopped, because the motion after it was not known in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LateBlend {
    /// Motion whose target the blend cuts off.
    pub after_motion: MotionIndex,
    /// Time at which the next motion is known, the end of the waits in between, in s.
    pub known_s: f64,
    /// Latest time at which the next motion would have to be known to avoid the stop, in s.
    pub needed_s: f64,
}

/// Line, TCP path, blend or rest of a trajectory.
#[derive(Clone, Debug)]
pub struct Piece {
    /// Kind of the piece.
    pub kind: PieceKind,
    /// Motion whose limits apply.
    pub motion: MotionIndex,
    /// Start time, in s.
    pub start_s: f64,
    /// End time, in s.
    pub end_s: f64,
    /// Duration, in s. Unlike `end_s - start_s`, it keeps all digits late in a program.
    pub duration_s: f64,
    /// Top speed: the largest share of a joint's velocity limit (the robot's limit, not the
    /// motion's).
    pub peak_velocity_rel: f64,
    /// Limit that is active for the longest time or, if none is active, the one with the largest
    /// ratio of value to limit; `None` at rest.
    pub limited_by: Option<Limit>,
    pub(crate) usage: LimitUsage,
    /// Index of the segment among the path's steps; for a wait before a blend that was not known in
    /// time, the index of the blend.
    pub step: usize,
    pub(crate) nodes: Range<usize>,
}

/// Kind of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PieceKind {
    /// Straight line in joint space.
    Line,
    /// Straight TCP path.
    Lin,
    /// Circular TCP path.
    Circ,
    /// Segment of a TCP spline.
    Spline,
    /// Blend.
    Blend,
    /// Rest until the robot has settled.
    Settle,
    /// Wait of the program.
    Wait,
}

impl PieceKind {
    const ALL: [Self; 7] =
        [Self::Line, Self::Lin, Self::Circ, Self::Spline, Self::Blend, Self::Settle, Self::Wait];

    /// Returns the kind with this name in files.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Returns the name in files: `line`, `lin`, `circ`, `spline`, `blend`, `settle` or `wait`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Line => "line",
            Self::Lin => "lin",
            Self::Circ => "circ",
            Self::Spline => "spline",
            Self::Blend => "blend",
            Self::Settle => "settle",
            Self::Wait => "wait",
        }
    }

    /// Returns true if the motion is defined for the TCP: LIN, CIRC or a spline.
    pub(crate) fn is_of_tcp(self) -> bool {
        matches!(self, Self::Lin | Self::Circ | Self::Spline)
    }

    /// Returns true if the robot moves.
    #[must_use]
    pub fn moves(self) -> bool {
        !matches!(self, Self::Settle | Self::Wait)
    }
}

impl Piece {
    /// Creates the piece of a step of `section` that moves the robot, between two instants after
    /// the section's start.
    pub(crate) fn moving(
        section: &Section,
        step: usize,
        [start_s, end_s]: [f64; 2],
        usage: &LimitUsage,
        nodes: Range<usize>,
    ) -> Option<Self> {
        let Step::Move { motion, segment, blend, .. } = &section.path.steps()[step] else {
            return None;
        };
        let limits = section.path.limits_of(step);
        let usage = usage.clone();
        let tool = ToolCoordinate::new(segment.as_ref(), limits.tool());
        let usage = usage.with_tool_limits(tool.as_ref(), limits.tcp_speed_source());
        // Converts shares of the motion's velocity limits into shares of the robot's.
        let motion_limits = limits.velocity_rad_s();
        let full = &section.path.robot().limits().velocity_rad_s;
        Some(Self {
            kind: match section.path.motion_type(*motion) {
                _ if blend.is_some() => PieceKind::Blend,
                Some(MotionType::Lin | MotionType::LinRel) => PieceKind::Lin,
                Some(MotionType::Circ) => PieceKind::Circ,
                Some(MotionType::Spline | MotionType::Spl) => PieceKind::Spline,
                _ => PieceKind::Line,
            },
            motion: *motion,
            start_s: section.start_s + start_s,
            end_s: section.start_s + end_s,
            duration_s: end_s - start_s,
            peak_velocity_rel: usage.peak_velocity_rel(motion_limits, full),
            limited_by: Some(usage.limit()),
            usage,
            step,
            nodes,
        })
    }
}

impl Piece {
    /// Returns the active limits with their shares of the piece's time, the longest first.
    #[must_use]
    pub fn limits(&self) -> Vec<LimitShare> {
        self.usage.shares(self.duration_s)
    }
}

impl Section {
    /// Returns true if a piece is the standstill after a motion whose end the program waits for.
    #[must_use]
    pub fn is_blocking(&self, piece: &Piece) -> bool {
        matches!(self.path.steps()[piece.step], Step::Settle { blocking: true, .. })
    }

    /// Returns the path that contains the section.
    #[must_use]
    pub fn path(&self) -> &JointPath {
        &self.path
    }

    /// Returns the start time, in s.
    #[must_use]
    pub fn start_s(&self) -> f64 {
        self.start_s
    }

    /// Returns the end time, in s.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.pieces.last().map_or(self.start_s, |piece| piece.end_s)
    }

    /// Returns the blend before which the robot stops at the section's end, because the motion
    /// after it was not known in time.
    #[must_use]
    pub fn late_blend(&self) -> Option<&LateBlend> {
        self.late_blend.as_ref()
    }

    /// Returns the pieces, in order.
    #[must_use]
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Returns the segment along which a piece moves; none at rest.
    #[must_use]
    pub fn segment(&self, piece: &Piece) -> Option<&dyn Segment> {
        match &self.path.steps()[piece.step] {
            Step::Move { segment, .. } if piece.kind.moves() => Some(segment.as_ref()),
            _ => None,
        }
    }

    /// Returns the nodes of a piece.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_path::JointPath;
    /// use iiwa_program::{Blend, Program};
    /// use iiwa_traj::{Timing, Trajectory};
    ///
    /// let program = Program::from_deg([0.0; 7])
    ///     .ptp_deg([40.0, 0.0, 0.0, -60.0, 0.0, 0.0, 0.0])
    ///     .blend(Blend::Fraction(0.3))
    ///     .ptp_deg([40.0, 30.0, 0.0, -30.0, 0.0, 0.0, 0.0])
    ///     .build();
    /// let path = JointPath::new(&program, &Robot::default())?;
    /// let trajectory = Trajectory::plan(&path, Timing::default())?;
    /// let section = &trajectory.sections()[0];
    /// let nodes = section.nodes(&section.pieces()[0]);
    /// assert!(nodes.windows(2).all(|pair| pair[0].t_s < pair[1].t_s));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn nodes(&self, piece: &Piece) -> &[Node] {
        &self.nodes[piece.nodes.clone()]
    }

    /// Returns the state at `t_s`, clamped to the section. O(log n).
    #[must_use]
    pub fn at(&self, t_s: f64) -> State {
        let t_s = t_s.clamp(self.start_s, self.end_s());
        let next = self.pieces.partition_point(|piece| piece.end_s <= t_s);
        let Some(piece) = self.pieces.get(next).or(self.pieces.last()) else {
            return self.resting(t_s, MotionIndex::default(), 0);
        };
        let Some(segment) = self.segment(piece) else {
            return self.resting(t_s, piece.motion, piece.step);
        };
        let nodes = self.nodes(piece);
        let t = t_s - self.start_s;
        // The interval that contains t; at the ends of the piece, its first or last interval.
        let node = nodes.partition_point(|node| node.t_s <= t).clamp(1, nodes.len() - 1) - 1;
        self.state(t_s, piece, segment, &nodes[node], &nodes[node + 1])
    }

    /// Returns the time at which the robot is at `s` of the segment of `piece`, a piece of this
    /// section, in s from the start of the program; for a rest, its start.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_path::JointPath;
    /// use iiwa_program::{Blend, Program};
    /// use iiwa_traj::{Timing, Trajectory};
    ///
    /// let program = Program::from_deg([0.0; 7])
    ///     .ptp_deg([40.0, 0.0, 0.0, -60.0, 0.0, 0.0, 0.0])
    ///     .blend(Blend::Fraction(0.3))
    ///     .ptp_deg([40.0, 30.0, 0.0, -30.0, 0.0, 0.0, 0.0])
    ///     .build();
    /// let path = JointPath::new(&program, &Robot::default())?;
    /// let trajectory = Trajectory::plan(&path, Timing::default())?;
    /// let section = &trajectory.sections()[0];
    /// let blend = &section.pieces()[1];
    /// let middle_s = section.time_at(blend, 0.5);
    /// assert!(blend.start_s < middle_s && middle_s < blend.end_s);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn time_at(&self, piece: &Piece, s: f64) -> f64 {
        let nodes = self.nodes(piece);
        if nodes.len() < 2 {
            return piece.start_s;
        }
        let p =
            self.segment(piece).map_or(s, |segment| segment.sigma(s)[0] / segment.sigma(1.0)[0]);
        self.passing(piece, p)[0]
    }

    /// Returns the time at a share of a piece's sigma, in s, and dp/dt there, in 1/s.
    pub(crate) fn passing(&self, piece: &Piece, p: f64) -> [f64; 2] {
        let nodes = self.nodes(piece);
        if nodes.len() < 2 {
            return [piece.start_s, 0.0];
        }
        let node = nodes.partition_point(|node| node.p <= p).clamp(1, nodes.len() - 1) - 1;
        let (from, to) = (&nodes[node], &nodes[node + 1]);
        // p increases monotonically: bisection down to rounding.
        let (mut lower, mut upper) = (0.0, from.dt_s);
        let dp = (p - from.p).clamp(0.0, from.dp);
        for _ in 0..HALVINGS {
            let dt = f64::midpoint(lower, upper);
            if interval::progress(dt, from, to).dp < dp {
                lower = dt;
            } else {
                upper = dt;
            }
        }
        [self.start_s + from.t_s + upper, interval::progress(upper, from, to).rate]
    }

    /// Returns the states at each node of the section and at the start of each rest.
    pub fn states(&self) -> impl Iterator<Item = State> {
        self.pieces.iter().flat_map(move |piece| {
            let moving = self.segment(piece).into_iter().flat_map(move |segment| {
                let nodes = self.nodes(piece);
                // The last node is the first one of the next piece.
                nodes.windows(2).map(move |pair| {
                    self.state(self.start_s + pair[0].t_s, piece, segment, &pair[0], &pair[1])
                })
            });
            let resting = (!piece.kind.moves())
                .then(|| self.resting(piece.start_s, piece.motion, piece.step));
            moving.chain(resting)
        })
    }

    /// Returns the states of a piece at each node and at evenly spaced instants between nodes,
    /// `samples` per interval.
    pub(crate) fn samples_of(&self, piece: &Piece, samples: u32) -> impl Iterator<Item = State> {
        self.segment(piece).into_iter().flat_map(move |segment| {
            let nodes = self.nodes(piece);
            let inner = nodes.windows(2).flat_map(move |pair| {
                let step_s = pair[0].dt_s / f64::from(samples);
                (0..samples).map(move |k| {
                    let t_s = self.start_s + pair[0].t_s + f64::from(k) * step_s;
                    self.state(t_s, piece, segment, &pair[0], &pair[1])
                })
            });
            let end = nodes.windows(2).next_back().map(|pair| {
                let t_s = self.start_s + pair[1].t_s;
                self.state(t_s, piece, segment, &pair[0], &pair[1])
            });
            inner.chain(end)
        })
    }

    /// Divides a piece in motion into short spans, in each of which the robot moves by at most
    /// `max_rad` along the path. Returns the duration of each span, in s, and the states at
    /// `shares` of that time.
    pub(crate) fn spans_of<const N: usize>(
        &self,
        piece: &Piece,
        shares: &[f64; N],
        max_rad: f64,
    ) -> impl Iterator<Item = (f64, [State; N])> {
        self.segment(piece).into_iter().flat_map(move |segment| {
            // sigma is scaled such that no joint turns by much more than sigma.
            let length_rad = segment.sigma_length_rad();
            self.nodes(piece).windows(2).flat_map(move |pair| {
                let (from, to) = (&pair[0], &pair[1]);
                let start_s = self.start_s + from.t_s;
                let at = move |dt_s: f64| self.state(start_s + dt_s, piece, segment, from, to);
                let spans = (from.dp * length_rad / max_rad).ceil().max(1.0);
                let step_s = from.dt_s / spans;
                let starts = (0_u32..).map(f64::from).take_while(move |k| *k < spans);
                starts.map(move |k| (step_s, shares.map(|share| at((k + share) * step_s))))
            })
        })
    }

    /// Calls `add` with states along a piece in motion and with their weights in an integral over
    /// time, in s. The piece is divided into spans in each of which the robot moves by at most
    /// `max_rad` along the path. The integral over a span is that of Simpson's rule or, if the
    /// speed changes by much, of Lobatto's rule with four points.
    ///
    /// Two spans share the state between them, unless the acceleration jumps there: `add` then
    /// receives the states before and after the jump.
    pub(crate) fn integrate(&self, piece: &Piece, max_rad: f64, mut add: impl FnMut(&State, f64)) {
        let Some(segment) = self.segment(piece) else { return };
        // sigma is scaled such that no joint turns by much more than sigma.
        let length_rad = segment.sigma_length_rad();
        let nodes = self.nodes(piece);
        // Weight of the next state by the span before it.
        let mut before_s = 0.0;
        for (index, pair) in nodes.windows(2).enumerate() {
            let (from, to) = (&pair[0], &pair[1]);
            let start_s = self.start_s + from.t_s;
            let at = |dt_s: f64| self.state(start_s + dt_s, piece, segment, from, to);
            let spans = (from.dp * length_rad / max_rad).ceil().max(1.0);
            let step_s = from.dt_s / spans;
            let is_steady = (to.rate - from.rate).abs() <= STEADY * spans * (to.rate + from.rate);
            let [of_end, inner, of_inner] = if is_steady { SIMPSON } else { LOBATTO };
            for span in (0_u32..).map(f64::from).take_while(|span| *span < spans) {
                add(&at(span * step_s), before_s + of_end * step_s);
                add(&at((span + inner) * step_s), of_inner * step_s);
                if !is_steady {
                    add(&at((span + 1.0 - inner) * step_s), of_inner * step_s);
                }
                before_s = of_end * step_s;
            }
            let jumps = nodes.get(index + 2).is_none_or(|after| {
                let [before, after] = [
                    interval::progress(from.dt_s, from, to).u,
                    interval::progress(0.0, to, after).u,
                ];
                (after - before).abs() > JUMP * before.abs().max(after.abs())
            });
            if jumps {
                add(&at(from.dt_s), before_s);
                before_s = 0.0;
            }
        }
    }

    /// Returns the state of a piece at rest.
    pub(crate) fn resting_in(&self, piece: &Piece) -> State {
        self.resting(piece.start_s, piece.motion, piece.step)
    }

    /// Adds the rest of the step at `step`, if it takes time; `still_s` is the duration of a motion
    /// without displacement.
    pub(crate) fn rest(&mut self, step: usize, still_s: f64) {
        match self.path.steps()[step] {
            Step::Settle { still, .. } => self.settle(step, if still { still_s } else { 0.0 }),
            Step::Wait { motion, seconds } => self.stand(PieceKind::Wait, motion, step, seconds),
            _ => {}
        }
    }

    /// Adds the end of a motion: `still_s`, the duration of a motion without displacement, and the
    /// standstill after the motion.
    pub(crate) fn settle(&mut self, step: usize, still_s: f64) {
        let Step::Settle { motion, blocking, .. } = self.path.steps()[step] else { return };
        self.stand(PieceKind::Settle, motion, step, still_s);
        let pause_s = self.pause_s(blocking);
        self.stand(PieceKind::Settle, motion, step, pause_s);
    }

    /// Moves a section of moves that was planned from time 0 to `start_s`.
    ///
    /// Late in a program, short intervals are lost in the rounding of absolute times: the nodes are
    /// then moved by the least that keeps the times increasing.
    pub(crate) fn place(&mut self, start_s: f64) {
        self.start_s = start_s;
        let increases = |pair: &[Node]| start_s + pair[1].t_s > start_s + pair[0].t_s;
        let nodes = |piece: &Piece| &self.nodes[piece.nodes.clone()];
        if !self.pieces.iter().all(|piece| nodes(piece).windows(2).all(increases)) {
            let mut t_s = 0.0;
            for piece in &self.pieces {
                let nodes = &mut self.nodes[piece.nodes.clone()];
                for index in 0..nodes.len() {
                    nodes[index].t_s = t_s;
                    if index + 1 < nodes.len() {
                        t_s = interval::later(start_s, t_s, nodes[index].dt_s);
                    }
                }
            }
        }
        for piece in &mut self.pieces {
            if let [first, .., last] = &self.nodes[piece.nodes.clone()] {
                [piece.start_s, piece.end_s] = [first.t_s, last.t_s].map(|t_s| start_s + t_s);
                piece.duration_s = last.t_s - first.t_s;
            }
        }
    }

    /// Returns the duration of the standstill at the end of a motion, in s.
    pub(crate) fn pause_s(&self, blocking: bool) -> f64 {
        pause_s(self.path.robot(), blocking)
    }

    /// Adds a rest, if it takes time.
    pub(crate) fn stand(
        &mut self,
        kind: PieceKind,
        motion: MotionIndex,
        step: usize,
        seconds: f64,
    ) {
        let start_s = self.end_s();
        // A rest without duration would repeat a time, and stamps increase strictly.
        if start_s + seconds > start_s {
            self.pieces.push(Piece {
                kind,
                motion,
                start_s,
                end_s: start_s + seconds,
                duration_s: seconds,
                peak_velocity_rel: 0.0,
                limited_by: None,
                usage: LimitUsage::default(),
                step,
                nodes: 0..0,
            });
        }
    }

    fn resting(&self, t_s: f64, motion: MotionIndex, step: usize) -> State {
        State { t_s, q: self.rest_rad, dq: [0.0; 7], ddq: [0.0; 7], dddq: [0.0; 7], motion, step }
    }

    fn state(
        &self,
        t_s: f64,
        piece: &Piece,
        segment: &dyn Segment,
        from: &Node,
        to: &Node,
    ) -> State {
        let dt = (t_s - self.start_s - from.t_s).clamp(0.0, from.dt_s);
        let IntervalProgress { dp, rate, u, du } = interval::progress(dt, from, to);
        // Rounding may lead beyond the ends of the segment.
        let d = segment.at_share((from.p + dp).clamp(0.0, 1.0));
        State {
            t_s,
            q: d.q,
            dq: d.dq.map(|v| v * rate),
            ddq: std::array::from_fn(|j| d.dq[j] * u + d.ddq[j] * rate * rate),
            dddq: std::array::from_fn(|j| {
                d.dq[j] * du + rate * (3.0 * d.ddq[j] * u + d.dddq[j] * rate * rate)
            }),
            motion: piece.motion,
            step: piece.step,
        }
    }
}

/// Returns the duration of the standstill at the end of a motion, in s.
pub(crate) fn pause_s(robot: &Robot, blocking: bool) -> f64 {
    if blocking { robot.blocking_pause_s() } else { robot.settle_time_s() }
}

/// Relative change of d2p/dt2 at a node that counts as a jump of the acceleration: far above the
/// rounding of continuous accelerations, far below any change of the torques that matters.
const JUMP: f64 = 1e-6;

/// Largest change of the speed in a span, as a share of the sum of both speeds, for Simpson's rule.
const STEADY: f64 = 0.1;

/// Rules of integration: weight of the ends of a span, place of its first inner point as a share of
/// the span, and weight of the inner points.
const SIMPSON: [f64; 3] = [1.0 / 6.0, 0.5, 4.0 / 6.0];
const LOBATTO: [f64; 3] = [1.0 / 12.0, 0.276_393_202_250_021, 5.0 / 12.0];

/// Halvings after which only rounding is left of an interval.
const HALVINGS: usize = 60;
