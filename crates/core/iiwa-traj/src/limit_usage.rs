//! Usage of the limits by a piece: peaks, and the time at each limit.

use iiwa_kin::Joint;
use iiwa_path::ToolCoordinate;
use iiwa_program::{ByKind, LimitKind, TcpSpeedSource};
use iiwa_solver::PathRow;

use crate::{
    interval::Node,
    limit::{Limit, LimitShare, Limited},
    sweep::{max, min},
};

/// Share of a limit above which the limit counts as active.
const SATURATED: f64 = 0.995;

/// Relative excess of a limit that counts as rounding.
pub(crate) const TOLERANCE: f64 = 1e-6;

/// Share of a further limit from which it counts as active: the solver stays further below it,
/// since it changes along the way.
pub(crate) const SATURATED_ROW: f64 = 0.985;

/// Usage of the limits of each kind.
#[derive(Clone, Debug, Default)]
pub(crate) struct LimitUsage {
    of: ByKind<Shares>,
    /// Usage of each further limit.
    rows: Vec<RowUsage>,
    /// Usage of each speed limit that the program does not set: the minimum duration, and T1.
    speeds: Vec<RowUsage>,
}

/// Largest share of a limit, and the time at the limit in s.
#[derive(Clone, Copy, Debug, Default)]
struct RowUsage {
    /// Limit; of a row, once it is [named](LimitUsage::name_rows).
    limit: Option<Limit>,
    peak: f64,
    time_s: f64,
}

impl RowUsage {
    fn add(&mut self, share: f64, dt: f64) {
        let share = share.abs();
        self.peak = max(self.peak, share);
        self.time_s += if share >= SATURATED_ROW { dt } else { 0.0 };
    }
}

/// Largest share of the limit and time at the limit in s, for each joint and, last, the tool.
#[derive(Clone, Copy, Debug, Default)]
struct Shares {
    peak: [f64; 8],
    time_s: [f64; 8],
    /// Usage by the rotation of the tool, once it is separated: the last elements above are then
    /// those of its way.
    turn_peak: f64,
    turn_time_s: f64,
}

/// Index of the tool.
const TOOL: usize = 7;

impl Shares {
    /// Adds an interval of `dt` with the largest and the smallest shares in it.
    #[inline(always)]
    fn add(&mut self, largest: &[f64; 8], smallest: &[f64; 8], dt: f64) {
        for j in 0..8 {
            self.peak[j] = max(self.peak[j], largest[j]);
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

/// Pairs the values with the joints and the tool.
fn each(values: &[f64; 8], of_turn: f64) -> impl Iterator<Item = (Limited, f64)> + use<> {
    let joints = Joint::ALL.into_iter().map(Limited::Joint).zip(*values);
    joints.chain([(Limited::Way, values[TOOL]), (Limited::Turn, of_turn)])
}

impl LimitUsage {
    /// Adds the intervals between `nodes`, whose derivatives `dq` and `ddq` are in units of the
    /// acceleration limits; `velocity` is the same as for the sweep.
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
        // Speeds at the start of an interval and the curvature term of the acceleration: the same
        // as at the end of the previous interval.
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
                speeds[0][j] = max(before, speed[j]);
                speeds[1][j] = min(before, speed[j]);
                let last = (end[j] * from.u[1] + bend[j]).abs();
                accelerations[0][j] = max(acceleration, last);
                accelerations[1][j] = min(acceleration, last);
            }
            self.of[LimitKind::Velocity].add(&speeds[0], &speeds[1], dt);
            self.of[LimitKind::Acceleration].add(&accelerations[0], &accelerations[1], dt);
            (from, start) = (to, *end);
        }
    }

    /// Adds the intervals between `nodes` for further limits with `count` `rows` at each node.
    pub(crate) fn add_rows(&mut self, nodes: &[Node], rows: &[PathRow], count: usize) {
        if count == 0 {
            return;
        }
        self.rows.resize(count, RowUsage::default());
        for (i, pair) in nodes.windows(2).enumerate() {
            let dt = pair[1].t_s - pair[0].t_s;
            let (starts, ends) = (&rows[i * count..], &rows[(i + 1) * count..]);
            for ((usage, start), end) in self.rows.iter_mut().zip(starts).zip(ends) {
                let [start, end] =
                    [start.at(pair[0].rate, pair[0].u[0]), end.at(pair[1].rate, pair[0].u[1])];
                // The lower of both ends decides if the limit is active; both count for the peak.
                usage.add(min(start.abs(), end.abs()), dt);
                usage.add(start, 0.0);
                usage.add(end, 0.0);
            }
        }
    }

    /// Adds the shares of the limits of all kinds over a time `dt`.
    #[inline(always)]
    pub(crate) fn sample(&mut self, shares: &ByKind<[f64; 8]>, dt: f64) {
        for (kind, shares) in shares {
            let shares = &shares.map(f64::abs);
            self.of[kind].add(shares, shares, dt);
        }
    }

    /// Adds the shares of further limits over a time `dt`.
    #[inline(always)]
    pub(crate) fn sample_rows(&mut self, shares: impl Iterator<Item = f64>, dt: f64) {
        for (row, share) in shares.enumerate() {
            if row == self.rows.len() {
                self.rows.push(RowUsage::default());
            }
            self.rows[row].add(share, dt);
        }
    }

    /// Names the further limits, in the order of their rows.
    pub(crate) fn name_rows(&mut self, limits: &[Limit]) {
        for (row, limit) in self.rows.iter_mut().zip(limits) {
            row.limit = Some(*limit);
        }
    }

    /// Adds an interval of `dt` with the shares of a speed limit at its ends.
    pub(crate) fn add_speed(&mut self, limit: Limit, shares: [f64; 2], dt: f64) {
        let [smaller, larger] = [min(shares[0], shares[1]), max(shares[0], shares[1])];
        let time_s = if smaller >= SATURATED { dt } else { 0.0 };
        merge_row(&mut self.speeds, &RowUsage { limit: Some(limit), peak: larger, time_s });
    }

    /// Assigns the usage of the limits of the `tool` to its way or to its rotation, and that of the
    /// speed along its way to the source of the speed limit.
    pub(crate) fn with_tool_limits(
        mut self,
        tool: Option<&ToolCoordinate>,
        source: TcpSpeedSource,
    ) -> Self {
        let Some(tool) = tool else { return self };
        for (_, shares) in self.of.iter_mut().filter(|(kind, _)| tool.is_of_turn(*kind)) {
            shares.turn_peak = std::mem::take(&mut shares.peak[TOOL]);
            shares.turn_time_s = std::mem::take(&mut shares.time_s[TOOL]);
        }
        let limit = match source {
            TcpSpeedSource::Program => return self,
            TcpSpeedSource::MinimumDuration => Limit::MinimumDuration,
            TcpSpeedSource::T1 => Limit::T1Velocity,
        };
        let shares = &mut self.of[LimitKind::Velocity];
        let peak = std::mem::take(&mut shares.peak[TOOL]);
        let time_s = std::mem::take(&mut shares.time_s[TOOL]);
        if peak > 0.0 {
            merge_row(&mut self.speeds, &RowUsage { limit: Some(limit), peak, time_s });
        }
        self
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        for (kind, shares) in &mut self.of {
            shares.merge(&other.of[kind]);
        }
        other.rows.iter().for_each(|row| merge_row(&mut self.rows, row));
        other.speeds.iter().for_each(|speed| merge_row(&mut self.speeds, speed));
    }

    /// Returns the limit of velocity, acceleration or jerk with the largest share, and that share.
    pub(crate) fn worst(&self) -> (Limit, f64) {
        larger(self.largest(Shares::peaks), largest_of(&self.speeds, |speed| speed.peak))
    }

    /// Returns the further limit with the largest share, and that share.
    pub(crate) fn largest_row(&self) -> Option<(Limit, f64)> {
        largest_of(&self.rows, |row| row.peak)
    }

    /// Returns the limit that is active for the longest time, or else the one with the largest
    /// share.
    pub(crate) fn limit(&self) -> Limit {
        let of_time = |row: &RowUsage| row.time_s;
        let longest = self.largest(Shares::times_s);
        let longest = larger(longest, largest_of(&self.speeds, of_time));
        let (limit, time_s) = larger(longest, largest_of(&self.rows, of_time));
        if time_s > 0.0 {
            return limit;
        }
        larger(self.worst(), self.largest_row()).0
    }

    /// Returns the largest share of a velocity limit of `full`, for a usage in shares of the lower
    /// limits `motion_limits`.
    #[inline(always)]
    pub(crate) fn peak_velocity_rel(&self, motion_limits: &[f64; 7], full: &[f64; 7]) -> f64 {
        (0..7)
            .map(|j| self.of[LimitKind::Velocity].peak[j] * motion_limits[j] / full[j])
            .fold(0.0, f64::max)
    }

    /// Returns the active limits, with their shares of `total_s`, the largest first.
    pub(crate) fn shares(&self, total_s: f64) -> Vec<LimitShare> {
        let share_of =
            |limit: Limit, time_s: f64| LimitShare { limit, share: (time_s / total_s).min(1.0) };
        let mut shares: Vec<_> = self
            .of
            .iter()
            .flat_map(|(kind, shares)| {
                // A wait has no active limit and may have no duration.
                let nonzero = shares.times_s().filter(|(_, time_s)| *time_s > 0.0);
                nonzero.map(move |(of, time_s)| share_of(Limit::Motion { of, kind }, time_s))
            })
            .collect();
        let nonzero = self.rows.iter().chain(&self.speeds).filter(|row| row.time_s > 0.0);
        shares.extend(nonzero.filter_map(|row| Some(share_of(row.limit?, row.time_s))));
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
            for (limited, value) in values(shares) {
                if value > best.1 {
                    best = (Limit::Motion { of: limited, kind }, value);
                }
            }
        }
        best
    }
}

/// Adds a usage to that of the same limit. The pieces of a motion may have different rows, so that
/// an index would not identify the limit.
fn merge_row(rows: &mut Vec<RowUsage>, row: &RowUsage) {
    match rows.iter_mut().find(|total| total.limit == row.limit) {
        Some(total) => {
            total.peak = total.peak.max(row.peak);
            total.time_s += row.time_s;
        }
        None => rows.push(*row),
    }
}

/// Returns the limit with the largest value among `rows`, and that value.
fn largest_of(rows: &[RowUsage], value: impl Fn(&RowUsage) -> f64) -> Option<(Limit, f64)> {
    let values = rows.iter().filter_map(|row| Some((row.limit?, value(row))));
    values.reduce(|best, next| if next.1 > best.1 { next } else { best })
}

/// Returns the other limit if its value is larger, otherwise the first.
fn larger(first: (Limit, f64), other: Option<(Limit, f64)>) -> (Limit, f64) {
    other.filter(|other| other.1 > first.1).unwrap_or(first)
}
