//! Speed supervision of a finished plan, as by the controller in the operating mode T1.
//!
//! The controller plans motions as in any other mode and holds the speed of TCP and flange during
//! execution: the speed stops growing abruptly where it reaches the limit.

use iiwa_kin::{Pose, Robot};
use iiwa_path::{Segment, Step};
use iiwa_solver::{LimitedSegment, SweptNode};

use crate::{
    interval::{Node, progress},
    limit::Limit,
    limit_usage::LimitUsage,
    sampled_usage::sampled_usage,
    section::{Piece, PieceKind, Section},
};

/// Largest interval in the supervised part, in s: the TCP speed is held at both of its ends and
/// half-way.
const LONGEST_S: f64 = 4e-3;

/// Halvings after which only rounding is left of an interval.
const HALVINGS: usize = 50;

/// Piece under speed supervision.
struct SupervisedPiece<'a> {
    segment: &'a dyn Segment,
    robot: &'a Robot,
    tcp: &'a Pose,
    speed_m_s: f64,
}

impl SupervisedPiece<'_> {
    /// Returns the largest dp/dt at `p`.
    fn max_rate(&self, p: f64) -> f64 {
        let derivatives = self.segment.at_share(p.clamp(0.0, 1.0));
        let speed_of = |tcp| self.robot.tcp_speed_m_s(tcp, &derivatives.q, &derivatives.dq);
        self.speed_m_s / speed_of(self.tcp).max(speed_of(&Pose::IDENTITY))
    }

    /// Returns the largest dp/dt, and d2p/dt2 of a motion that keeps it, by central differences.
    fn kept(&self, p: f64) -> [f64; 2] {
        const STEP: f64 = 1e-5;
        let [before, after] = [(p - STEP).max(0.0), (p + STEP).min(1.0)];
        let max_rate = self.max_rate(p);
        [max_rate, max_rate * (self.max_rate(after) - self.max_rate(before)) / (after - before)]
    }

    /// Returns true if the speed at `seconds` after the node `from` is too high.
    fn is_exceeded(&self, from: &Node, to: &Node, seconds: f64) -> bool {
        let state = progress(seconds, from, to);
        state.rate > self.max_rate(from.p + state.dp)
    }

    /// Adds the nodes from `from` on, up to but not including `to`;
    /// [`is_exceeded`](Self::is_exceeded) changes at most once in between.
    fn cut(&self, from: Node, to: &Node, nodes: &mut Vec<Node>) {
        let (start, end) =
            (self.is_exceeded(&from, to, 0.0), self.is_exceeded(&from, to, from.dt_s));
        if start == end {
            nodes.push(if start { self.held(&from, to) } else { from });
            return;
        }
        let (mut low, mut high) = (0.0, from.dt_s);
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            if self.is_exceeded(&from, to, middle) == start { low = middle } else { high = middle }
        }
        // The change is at a node, up to rounding: an interval of zero length is not created.
        if low <= 0.0 || low >= from.dt_s {
            nodes.push(if end { self.held(&from, to) } else { from });
            return;
        }
        let [first, second] = parted(&from, to, low);
        nodes.push(if start { self.held(&first, &second) } else { first });
        nodes.push(if end { self.held(&second, to) } else { second });
    }

    /// Returns a node from which the speed is held up to `to`.
    fn held(&self, from: &Node, to: &Node) -> Node {
        let [[rate, u], [end_rate, end_u]] = [from.p, to.p].map(|p| self.kept(p));
        let middle = self.max_rate(from.p + 0.5 * from.dp);
        // Simpson's rule.
        let dt_s = from.dp / 6.0 * (1.0 / rate + 4.0 / middle + 1.0 / end_rate);
        Node { dt_s, rate, u: [u, end_u], ..*from }
    }
}

/// Splits the interval that begins at the node `from`, `seconds` after that node.
fn parted(from: &Node, to: &Node, seconds: f64) -> [Node; 2] {
    let state = progress(seconds, from, to);
    let first = Node { dt_s: seconds, dp: state.dp, u: [from.u[0], state.u], ..*from };
    let second = Node {
        t_s: from.t_s + seconds,
        dt_s: from.dt_s - seconds,
        p: from.p + state.dp,
        dp: from.dp - state.dp,
        rate: state.rate,
        u: [state.u, from.u[1]],
    };
    [first, second]
}

impl SupervisedPiece<'_> {
    /// Returns the nodes of a piece with the speed held where it is too high, with times from its
    /// start.
    fn nodes(&self, planned: &[Node]) -> Vec<Node> {
        let mut nodes = Vec::with_capacity(planned.len());
        for pair in planned.windows(2) {
            let [mut from, to] = [pair[0], pair[1]];
            let parts = (from.dt_s / LONGEST_S).ceil().max(1.0);
            let instants = (0_u32..).map(f64::from).take_while(|k| *k <= parts);
            let mut instants = instants.map(|k| k / parts * from.dt_s);
            if !instants.any(|seconds| self.is_exceeded(&pair[0], &to, seconds)) {
                nodes.push(from);
                continue;
            }
            let mut remaining = parts;
            while remaining > 1.0 {
                let [first, rest] = parted(&from, &to, from.dt_s / remaining);
                self.cut(first, &rest, &mut nodes);
                (from, remaining) = (rest, remaining - 1.0);
            }
            self.cut(from, &to, &mut nodes);
        }
        if let Some(last) = planned.last() {
            nodes.push(Node { rate: last.rate.min(self.max_rate(1.0)), ..*last });
        }
        let mut t_s = 0.0;
        for node in &mut nodes {
            node.t_s = t_s;
            t_s += node.dt_s;
        }
        nodes
    }

    /// Returns the largest share of a joint's velocity limit at the nodes.
    fn peak_velocity_rel(&self, nodes: &[Node]) -> f64 {
        let full = &self.robot.limits().velocity_rad_s;
        let share = |node: &Node| {
            let dq = self.segment.at_share(node.p).dq;
            (0..7).map(|j| (dq[j] * node.rate).abs() / full[j]).fold(0.0, f64::max)
        };
        nodes.iter().map(share).fold(0.0, f64::max)
    }

    /// Adds the usage of the supervised speed.
    fn add_usage(&self, usage: &mut LimitUsage, nodes: &[Node]) {
        let share = |node: &Node| node.rate / self.max_rate(node.p);
        let Some((mut from, nodes)) = nodes.split_first() else { return };
        let mut before = share(from);
        for to in nodes {
            let after = share(to);
            usage.add_speed(Limit::T1Velocity, [before, after], from.dt_s);
            (from, before) = (to, after);
        }
    }
}

impl Section {
    /// Holds TCP and flange at a speed, in m/s, where the plan is faster. The path of the section
    /// is the one without this limit.
    pub(crate) fn hold_speed(&mut self, speed_m_s: f64) {
        let (path, mut start_s) = (self.path.clone(), 0.0);
        let (mut pieces, mut all) = (Vec::with_capacity(self.pieces.len()), Vec::new());
        // A single PTP motion follows the ramp law instead of jerk limits.
        let has_jerk_limits =
            !matches!(self.pieces.as_slice(), [piece] if piece.kind == PieceKind::Line);
        for piece in &self.pieces {
            let Step::Move { segment, motion, .. } = &path.steps()[piece.step] else { continue };
            let tcp = path.tcp(*motion);
            let way =
                SupervisedPiece { segment: segment.as_ref(), robot: path.robot(), tcp, speed_m_s };
            let planned = &self.nodes[piece.nodes.clone()];
            let mut nodes = way.nodes(planned);
            let end_s = start_s + nodes.last().map_or(0.0, |last| last.t_s);
            let range = all.len()..all.len() + nodes.len();
            let held = if is_same(&nodes, planned) {
                let [start_s, end_s] = [start_s, end_s].map(|t_s| self.start_s + t_s);
                Some(Piece { start_s, end_s, nodes: range, ..piece.clone() })
            } else {
                let swept: Vec<_> = nodes.iter().map(swept).collect();
                let limited =
                    LimitedSegment::new(segment.as_ref(), path.limits_of(piece.step), &swept);
                let usage = limited.map(|limited| sampled_usage(&limited, &nodes, has_jerk_limits));
                let usage = usage.unwrap_or_default();
                Piece::moving(self, piece.step, [start_s, end_s], &usage, range)
            };
            pieces.extend(held.map(|mut held| {
                way.add_usage(&mut held.usage, &nodes);
                held.limited_by = Some(held.usage.limit());
                // Samples of the usage lie between the nodes.
                held.peak_velocity_rel = held.peak_velocity_rel.max(way.peak_velocity_rel(&nodes));
                held
            }));
            for node in &mut nodes {
                node.t_s += start_s;
            }
            all.extend(nodes);
            start_s = end_s;
        }
        (self.pieces, self.nodes) = (pieces, all);
    }
}

/// Returns true if the speed was held nowhere.
fn is_same(nodes: &[Node], planned: &[Node]) -> bool {
    let same = |(node, planned): (&Node, &Node)| {
        node.dt_s.to_bits() == planned.dt_s.to_bits()
            && node.rate.to_bits() == planned.rate.to_bits()
    };
    nodes.len() == planned.len() && std::iter::zip(nodes, planned).all(same)
}

fn swept(&Node { t_s, p, rate, u, .. }: &Node) -> SweptNode {
    SweptNode { t_s, p, rate, u }
}
