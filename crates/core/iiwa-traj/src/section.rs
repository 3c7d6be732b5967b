//! A part of a trajectory from one stop to the next.

use std::ops::Range;

use iiwa_kin::{Joints, Robot};
use iiwa_path::{JointPath, Segment, Step, ToolCoordinate};
use iiwa_program::{MotionIndex, MotionType};

use crate::{
    interval::{self, Progress},
    late_blend::LateBlend,
    limit::{Limit, LimitShare},
    limit_usage::LimitUsage,
    node::Node,
    state::State,
};

/// A part of a trajectory: the arm moves without a stop, then it stands.
///
/// Sections are independent of each other: a long program is planned and written one by one.
/// Times are counted from the start of the program.
#[derive(Clone, Debug)]
pub struct Section {
    pub(crate) path: JointPath,
    pub(crate) start_s: f64,
    /// Where it ends and rests, in rad.
    pub(crate) rest_rad: Joints,
    pub(crate) pieces: Vec<Piece>,
    pub(crate) nodes: Vec<Node>,
    /// The blend after it that was not known in time.
    pub(crate) late_blend: Option<LateBlend>,
}

/// A line, a path of the TCP, a blend or a rest.
#[derive(Clone, Debug)]
pub struct Piece {
    /// What it is.
    pub kind: PieceKind,
    /// The motion whose limits hold.
    pub motion: MotionIndex,
    /// When it starts, in s.
    pub start_s: f64,
    /// When it ends, in s.
    pub end_s: f64,
    /// How long it takes, in s; not rounded by how late it is.
    pub duration_s: f64,
    /// Top speed: the largest share of a joint's speed limit (the robot's, not the motion's).
    pub peak_velocity_rel: f64,
    /// The limit that the piece is at for the longest time; none at rest.
    pub limited_by: Option<Limit>,
    pub(crate) usage: LimitUsage,
    /// Place of the segment among the path's steps; of a wait before a blend that was not known in time, that of the blend.
    pub step: usize,
    pub(crate) nodes: Range<usize>,
}

/// What a piece of a trajectory is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PieceKind {
    /// A straight line in joint space.
    Line,
    /// A straight line of the TCP.
    Lin,
    /// A circle of the TCP.
    Circ,
    /// A segment of a spline of the TCP.
    Spline,
    /// A blend.
    Blend,
    /// Standing until settled.
    Settle,
    /// A wait of the program.
    Wait,
}

impl PieceKind {
    const ALL: [Self; 7] =
        [Self::Line, Self::Lin, Self::Circ, Self::Spline, Self::Blend, Self::Settle, Self::Wait];

    /// The kind of this name in files.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Its name in files: `line`, `lin`, `circ`, `spline`, `blend`, `settle` or `wait`.
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

    /// Returns whether the motion is defined for the TCP: LIN, CIRC or a spline.
    pub(crate) fn is_of_tcp(self) -> bool {
        matches!(self, Self::Lin | Self::Circ | Self::Spline)
    }

    /// Whether the arm moves.
    #[must_use]
    pub fn moves(self) -> bool {
        !matches!(self, Self::Settle | Self::Wait)
    }
}

impl Piece {
    /// That of a step of the path of `section` which moves the arm, between two instants after the section's start.
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
        let usage = usage.told_apart(ToolCoordinate::new(segment.as_ref(), limits.tool()).as_ref());
        // Shares of the motion's limits become shares of the robot's.
        let own = limits.velocity_rad_s();
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
            peak_velocity_rel: usage.peak_velocity_rel(own, full),
            limited_by: Some(usage.limit()),
            usage,
            step,
            nodes,
        })
    }
}

impl Piece {
    /// The limits that it is at, the one for the longest time first, with their shares of its time.
    #[must_use]
    pub fn limits(&self) -> Vec<LimitShare> {
        self.usage.shares(self.duration_s)
    }
}

impl Section {
    /// Whether a piece is the pause after a motion whose end the program waits for.
    #[must_use]
    pub fn is_blocking(&self, piece: &Piece) -> bool {
        matches!(self.path.steps()[piece.step], Step::Settle { blocking: true, .. })
    }

    /// The path that it is a part of.
    #[must_use]
    pub fn path(&self) -> &JointPath {
        &self.path
    }

    /// When it starts, in s.
    #[must_use]
    pub fn start_s(&self) -> f64 {
        self.start_s
    }

    /// When it ends, in s.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.pieces.last().map_or(self.start_s, |piece| piece.end_s)
    }

    /// The blend before which the arm stops at the section's end, since what it leads into was not known in time.
    #[must_use]
    pub fn late_blend(&self) -> Option<&LateBlend> {
        self.late_blend.as_ref()
    }

    /// Its pieces, in order.
    #[must_use]
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The segment that a piece moves along; none at rest.
    #[must_use]
    pub fn segment(&self, piece: &Piece) -> Option<&dyn Segment> {
        match &self.path.steps()[piece.step] {
            Step::Move { segment, .. } if piece.kind.moves() => Some(segment.as_ref()),
            _ => None,
        }
    }

    /// The samples of a piece at which the stamps were found.
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

    /// What the arm does at `t_s`, which is moved into the section if it is outside. O(log n).
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
        let node = nodes.partition_point(|node| node.t_s <= t).clamp(1, nodes.len() - 1) - 1;
        self.state(t_s, piece, segment, &nodes[node], &nodes[node + 1])
    }

    /// When the arm is at `s` of the segment that `piece`, one of this section, moves along, in s from the
    /// start of the program; of a rest, its start.
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

    /// When the arm is at a share of a piece's sigma, in s, and dp/dt there, in 1/s.
    pub(crate) fn passing(&self, piece: &Piece, p: f64) -> [f64; 2] {
        let nodes = self.nodes(piece);
        if nodes.len() < 2 {
            return [piece.start_s, 0.0];
        }
        let node = nodes.partition_point(|node| node.p <= p).clamp(1, nodes.len() - 1) - 1;
        let (from, to) = (&nodes[node], &nodes[node + 1]);
        // p never falls: its time is between two that are halved until numbers end.
        let (mut least, mut most) = (0.0, from.dt_s);
        let dp = (p - from.p).clamp(0.0, from.dp);
        for _ in 0..HALVINGS {
            let dt = f64::midpoint(least, most);
            if interval::progress(dt, from, to).dp < dp {
                least = dt;
            } else {
                most = dt;
            }
        }
        [self.start_s + from.t_s + most, interval::progress(most, from, to).rate]
    }

    /// What the arm does at each node of the section, and at the start and end of each rest.
    pub fn states(&self) -> impl Iterator<Item = State> {
        self.pieces.iter().flat_map(move |piece| {
            let moving = self.segment(piece).into_iter().flat_map(move |segment| {
                let nodes = self.nodes(piece);
                // The last node is the first one of what follows.
                nodes.windows(2).map(move |pair| {
                    self.state(self.start_s + pair[0].t_s, piece, segment, &pair[0], &pair[1])
                })
            });
            let resting = (!piece.kind.moves())
                .then(|| self.resting(piece.start_s, piece.motion, piece.step));
            moving.chain(resting)
        })
    }

    /// What the arm does in a piece: at each node, and at evenly spaced instants between, so that there are `samples` in
    /// each interval.
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

    /// What the arm does at `shares` of short spans that a piece in motion is made of, and how long they take, in s. In none
    /// of them does the arm go on by more than `most_rad` along the path.
    pub(crate) fn spans_of<const N: usize>(
        &self,
        piece: &Piece,
        shares: &[f64; N],
        most_rad: f64,
    ) -> impl Iterator<Item = (f64, [State; N])> {
        self.segment(piece).into_iter().flat_map(move |segment| {
            // Along sigma, no joint turns by much more than it.
            let length_rad = segment.sigma_length_rad();
            self.nodes(piece).windows(2).flat_map(move |pair| {
                let (from, to) = (&pair[0], &pair[1]);
                let start_s = self.start_s + from.t_s;
                let at = move |dt_s: f64| self.state(start_s + dt_s, piece, segment, from, to);
                let spans = (from.dp * length_rad / most_rad).ceil().max(1.0);
                let step_s = from.dt_s / spans;
                let starts = (0_u32..).map(f64::from).take_while(move |k| *k < spans);
                starts.map(move |k| (step_s, shares.map(|share| at((k + share) * step_s))))
            })
        })
    }

    /// What the arm does in a piece at rest.
    pub(crate) fn resting_in(&self, piece: &Piece) -> State {
        self.resting(piece.start_s, piece.motion, piece.step)
    }

    /// Adds the step at `step`, if the arm stands there for some time; `still_s` is how long a motion takes that goes nowhere.
    pub(crate) fn rest(&mut self, step: usize, still_s: f64) {
        match self.path.steps()[step] {
            Step::Settle { still, .. } => self.settle(step, if still { still_s } else { 0.0 }),
            Step::Wait { motion, seconds } => self.stand(PieceKind::Wait, motion, step, seconds),
            _ => {}
        }
    }

    /// Adds the end of a motion: `still_s`, how long a motion takes that goes nowhere, and a pause.
    pub(crate) fn settle(&mut self, step: usize, still_s: f64) {
        let Step::Settle { motion, blocking, .. } = self.path.steps()[step] else { return };
        self.stand(PieceKind::Settle, motion, step, still_s);
        let pause_s = self.pause_s(blocking);
        self.stand(PieceKind::Settle, motion, step, pause_s);
    }

    /// Duration of the rest at the end of a motion, in s.
    pub(crate) fn pause_s(&self, blocking: bool) -> f64 {
        pause_s(self.path.robot(), blocking)
    }

    /// Adds a rest, if it takes some time.
    pub(crate) fn stand(
        &mut self,
        kind: PieceKind,
        motion: MotionIndex,
        step: usize,
        seconds: f64,
    ) {
        let start_s = self.end_s();
        // What takes no time has no place in it: stamps increase.
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
        let Progress { dp, rate, u, du } = interval::progress(dt, from, to);
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

/// How long the arm stands at the end of a motion, in s.
pub(crate) fn pause_s(robot: &Robot, blocking: bool) -> f64 {
    if blocking { robot.blocking_pause_s() } else { robot.settle_time_s() }
}

/// Halvings of an interval that leave nothing of it but rounding.
const HALVINGS: usize = 60;
