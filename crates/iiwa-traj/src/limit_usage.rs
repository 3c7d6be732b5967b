//! How close a piece comes to its limits, and for how long it is at each.

use iiwa_kin::{Joint, Joints, PathTorques};
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

/// From this share on, a joint is at its limit of torque: the solver comes less close to it, since it changes along the way.
const SATURATED_TORQUE: f64 = 0.985;

/// What is used of the limits of each kind.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LimitUsage {
    of: ByKind<Shares>,
    torque: TorqueShares,
}

/// For each joint, the largest share of its limit of torque, and the time at it in s; 0 where torques are not limited.
#[derive(Clone, Copy, Debug, Default)]
struct TorqueShares {
    peak: Joints,
    time_s: Joints,
}

impl TorqueShares {
    fn merge(&mut self, other: &Self) {
        for j in 0..7 {
            self.peak[j] = self.peak[j].max(other.peak[j]);
            self.time_s[j] += other.time_s[j];
        }
    }
}

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
            self.of[LimitKind::Velocity].add(&speeds[0], &speeds[1], dt);
            self.of[LimitKind::Acceleration].add(&accelerations[0], &accelerations[1], dt);
            (from, start) = (to, *end);
        }
    }

    /// Adds the intervals between `nodes`, where `torques` are what these are made of there, over their limits; nothing if
    /// torques are not limited.
    pub(crate) fn add_torques(&mut self, nodes: &[Node], torques: &[PathTorques]) {
        for (pair, torques) in nodes.windows(2).zip(torques.windows(2)) {
            let [start, end] = [
                torques[0].at(pair[0].rate, pair[0].u[0]),
                torques[1].at(pair[1].rate, pair[0].u[1]),
            ];
            // The lesser of both ends holds for the time; the peaks are those of either.
            let least = std::array::from_fn(|j| lesser(start[j].abs(), end[j].abs()));
            self.torques(&least, pair[1].t_s - pair[0].t_s);
            self.torques(&start, 0.0);
            self.torques(&end, 0.0);
        }
    }

    /// Adds the shares of the limits of all kinds that hold for `dt`.
    #[inline(always)]
    pub(crate) fn sample(&mut self, shares: &ByKind<[f64; 8]>, dt: f64) {
        for (kind, shares) in shares {
            let shares = &shares.map(f64::abs);
            self.of[kind].add(shares, shares, dt);
        }
    }

    /// Adds the shares of the limits of torque that hold for `dt`.
    #[inline(always)]
    pub(crate) fn torques(&mut self, shares: &Joints, dt: f64) {
        let TorqueShares { peak, time_s } = &mut self.torque;
        for j in 0..7 {
            let share = shares[j].abs();
            peak[j] = greater(peak[j], share);
            time_s[j] += if share >= SATURATED_TORQUE { dt } else { 0.0 };
        }
    }

    /// The same, with what is used of the limits of the `tool` as that of its way or of its turn.
    pub(crate) fn told_apart(mut self, tool: Option<&ToolCoordinate>) -> Self {
        let Some(tool) = tool else { return self };
        for (_, shares) in self.of.iter_mut().filter(|(kind, _)| tool.is_of_turn(*kind)) {
            shares.turn_peak = std::mem::take(&mut shares.peak[TOOL]);
            shares.turn_time_s = std::mem::take(&mut shares.time_s[TOOL]);
        }
        self
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        for (kind, shares) in &mut self.of {
            shares.merge(&other.of[kind]);
        }
        self.torque.merge(&other.torque);
    }

    /// The largest share of any limit of velocity, acceleration or jerk, and which one it is.
    pub(crate) fn worst(&self) -> (Limit, f64) {
        self.largest(Shares::peaks)
    }

    /// The largest share of a limit of torque, and of which; 0 if torques are not limited.
    pub(crate) fn largest_torque(&self) -> (Limit, f64) {
        largest_torque(&self.torque.peak)
    }

    /// The limit that is kept for the longest time, or else the one that is come closest to.
    pub(crate) fn limit(&self) -> Limit {
        let (limit, time_s) = self.largest(Shares::times_s);
        let (of_torque, at_torque_s) = largest_torque(&self.torque.time_s);
        if at_torque_s > time_s {
            return of_torque;
        }
        if time_s > 0.0 {
            return limit;
        }
        let (limit, share) = self.worst();
        let (of_torque, torque) = largest_torque(&self.torque.peak);
        if torque > share { of_torque } else { limit }
    }

    /// The largest share of a limit of speed, where `full` are the limits, of which `own` are shares.
    #[inline(always)]
    pub(crate) fn peak_velocity_rel(&self, own: &[f64; 7], full: &[f64; 7]) -> f64 {
        (0..7).map(|j| self.of[LimitKind::Velocity].peak[j] * own[j] / full[j]).fold(0.0, f64::max)
    }

    /// The limits that are kept, with their shares of `total_s`, the largest first.
    pub(crate) fn shares(&self, total_s: f64) -> Vec<LimitShare> {
        let at =
            |limit: Limit, time_s: f64| LimitShare { limit, share: (time_s / total_s).min(1.0) };
        let mut shares: Vec<_> = self
            .of
            .iter()
            .flat_map(|(kind, shares)| {
                // A wait is at none, and may take no time.
                let kept = shares.times_s().filter(|(_, time_s)| *time_s > 0.0);
                kept.map(move |(of, time_s)| at(Limit::Motion { of, kind }, time_s))
            })
            .collect();
        let torques = Joint::ALL.into_iter().zip(self.torque.time_s);
        let kept = torques.filter(|(_, time_s)| *time_s > 0.0);
        shares.extend(kept.map(|(joint, time_s)| at(Limit::Torque(joint), time_s)));
        shares.sort_by(|a, b| b.share.total_cmp(&a.share));
        shares
    }

    fn largest<V: Iterator<Item = (Limited, f64)>>(
        &self,
        values: impl Fn(&Shares) -> V,
    ) -> (Limit, f64) {
        let first = Limited::Joint(Joint::A1);
        let mut best = (Limit::Motion { of: first, kind: LimitKind::Velocity }, 0.0);
        for (kind, shares) in &self.of {
            for (of, value) in values(shares) {
                if value > best.1 {
                    best = (Limit::Motion { of, kind }, value);
                }
            }
        }
        best
    }
}

/// The largest of the values of the joints' torques, and of which it is.
fn largest_torque(values: &Joints) -> (Limit, f64) {
    Joint::ALL.into_iter().zip(*values).fold(
        (Limit::Torque(Joint::A1), 0.0),
        |best, (joint, value)| {
            if value > best.1 { (Limit::Torque(joint), value) } else { best }
        },
    )
}
