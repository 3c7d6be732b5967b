//! How close a piece comes to its limits, and for how long it is at each.

use iiwa_kin::Joint;
use iiwa_path::ToolCoordinate;
use iiwa_program::{ByKind, LimitKind};

use crate::{
    limit::{Limit, LimitShare, Limited},
    node::Node,
    sweep::{greater, lesser},
};

/// Above this share of a limit, a joint or the tool counts as being at it.
const SATURATED: f64 = 0.995;

/// Largest value over limit that is taken for rounding.
pub(crate) const TOLERANCE: f64 = 1e-6;

/// What is used of the limits of each kind.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LimitUsage(ByKind<Shares>);

/// For each joint and, last, the tool, the largest share of its limit, and the time at it in s.
#[derive(Clone, Copy, Debug, Default)]
struct Shares {
    peak: [f64; 8],
    time_s: [f64; 8],
    /// The same for the turn of the tool, once it is told apart: then the last of the others are those of its way.
    turn_peak: f64,
    turn_time_s: f64,
}

/// The place of the tool.
const TOOL: usize = 7;

impl Shares {
    /// Adds an interval of `dt` with the largest and the smallest shares in it.
    #[inline(always)]
    fn add(&mut self, largest: &[f64; 8], smallest: &[f64; 8], dt: f64) {
        for j in 0..8 {
            self.peak[j] = greater(self.peak[j], largest[j]);
            self.time_s[j] += if smallest[j] >= SATURATED { dt } else { 0.0 };
        }
    }

    fn merge(&mut self, other: &Self) {
        for j in 0..8 {
            self.peak[j] = self.peak[j].max(other.peak[j]);
            self.time_s[j] += other.time_s[j];
        }
        self.turn_peak = self.turn_peak.max(other.turn_peak);
        self.turn_time_s += other.turn_time_s;
    }

    fn peaks(&self) -> impl Iterator<Item = (Limited, f64)> + use<> {
        each(&self.peak, self.turn_peak)
    }

    fn times_s(&self) -> impl Iterator<Item = (Limited, f64)> + use<> {
        each(&self.time_s, self.turn_time_s)
    }
}

/// The values with what they are of.
fn each(values: &[f64; 8], of_turn: f64) -> impl Iterator<Item = (Limited, f64)> + use<> {
    let joints = Joint::ALL.into_iter().map(Limited::Joint).zip(*values);
    joints.chain([(Limited::Way, values[TOOL]), (Limited::Turn, of_turn)])
}

impl LimitUsage {
    /// Adds the intervals between `nodes`, whose derivatives `dq` and `ddq` are in units of the
    /// acceleration limits; `velocity` as for the sweep.
    #[inline(always)]
    pub(crate) fn add(
        &mut self,
        nodes: &[Node],
        dq: &[[f64; 8]],
        ddq: &[[f64; 8]],
        velocity: &[f64; 8],
    ) {
        let Some((mut from, nodes)) = nodes.split_first() else { return };
        let mut start = dq[0];
        // Speeds at the start of an interval, and the part of the acceleration that is theirs: the same
        // as at the end of the one before.
        let (mut speed, mut bend) = ([0.0; 8], [0.0; 8]);
        for j in 0..8 {
            speed[j] = (start[j] * from.rate).abs() * velocity[j];
            bend[j] = ddq[0][j] * (from.rate * from.rate);
        }
        for ((to, end), ddq) in nodes.iter().zip(&dq[1..]).zip(&ddq[1..]) {
            let dt = to.t_s - from.t_s;
            let (mut speeds, mut accelerations) = ([[0.0; 8]; 2], [[0.0; 8]; 2]);
            for j in 0..8 {
                let before = speed[j];
                let acceleration = (start[j] * from.u[0] + bend[j]).abs();
                speed[j] = (end[j] * to.rate).abs() * velocity[j];
                bend[j] = ddq[j] * (to.rate * to.rate);
                speeds[0][j] = greater(before, speed[j]);
                speeds[1][j] = lesser(before, speed[j]);
                let last = (end[j] * from.u[1] + bend[j]).abs();
                accelerations[0][j] = greater(acceleration, last);
                accelerations[1][j] = lesser(acceleration, last);
            }
            self.0[LimitKind::Velocity].add(&speeds[0], &speeds[1], dt);
            self.0[LimitKind::Acceleration].add(&accelerations[0], &accelerations[1], dt);
            (from, start) = (to, *end);
        }
    }

    /// Adds the shares of the limits of all kinds that hold for `dt`.
    #[inline(always)]
    pub(crate) fn sample(&mut self, shares: &ByKind<[f64; 8]>, dt: f64) {
        for (kind, shares) in shares {
            let shares = &shares.map(f64::abs);
            self.0[kind].add(shares, shares, dt);
        }
    }

    /// The same, with what is used of the limits of the `tool` as that of its way or of its turn.
    pub(crate) fn told_apart(mut self, tool: Option<&ToolCoordinate>) -> Self {
        let Some(tool) = tool else { return self };
        for (_, shares) in self.0.iter_mut().filter(|(kind, _)| tool.is_of_turn(*kind)) {
            shares.turn_peak = std::mem::take(&mut shares.peak[TOOL]);
            shares.turn_time_s = std::mem::take(&mut shares.time_s[TOOL]);
        }
        self
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        for (kind, shares) in &mut self.0 {
            shares.merge(&other.0[kind]);
        }
    }

    /// The largest share of any limit, and which one it is.
    pub(crate) fn worst(&self) -> (Limit, f64) {
        self.largest(Shares::peaks)
    }

    /// The limit that is kept for the longest time, or else the one that is come closest to.
    pub(crate) fn limit(&self) -> Limit {
        let (limit, time_s) = self.largest(Shares::times_s);
        if time_s > 0.0 { limit } else { self.worst().0 }
    }

    /// The largest share of a limit of speed, where `full` are the limits, of which `own` are shares.
    #[inline(always)]
    pub(crate) fn peak_velocity_rel(&self, own: &[f64; 7], full: &[f64; 7]) -> f64 {
        (0..7).map(|j| self.0[LimitKind::Velocity].peak[j] * own[j] / full[j]).fold(0.0, f64::max)
    }

    /// The limits that are kept, with their shares of `total_s`, the largest first.
    pub(crate) fn shares(&self, total_s: f64) -> Vec<LimitShare> {
        let mut shares: Vec<_> = self
            .0
            .iter()
            .flat_map(|(kind, shares)| {
                // A wait is at none, and may take no time.
                let kept = shares.times_s().filter(|(_, time_s)| *time_s > 0.0);
                kept.map(move |(of, time_s)| LimitShare {
                    limit: Limit { of, kind },
                    share: (time_s / total_s).min(1.0),
                })
            })
            .collect();
        shares.sort_by(|a, b| b.share.total_cmp(&a.share));
        shares
    }

    fn largest<V: Iterator<Item = (Limited, f64)>>(
        &self,
        values: impl Fn(&Shares) -> V,
    ) -> (Limit, f64) {
        let mut best = (Limit { of: Limited::Joint(Joint::A1), kind: LimitKind::Velocity }, 0.0);
        for (kind, shares) in &self.0 {
            for (of, value) in values(shares) {
                if value > best.1 {
                    best = (Limit { of, kind }, value);
                }
            }
        }
        best
    }
}
