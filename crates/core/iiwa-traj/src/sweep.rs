//! The sweep over the samples of a curved segment (Larsen 2019, section 2.4.1).
//!
//! The path parameter is p, the share of the segment's sigma, 0 to 1. Along a blend, s would not do: where
//! the arm keeps its speed, ds/dt changes, and in a blend that is short against the speed, the acceleration
//! would be a small difference of large numbers.
//!
//! Unknown is x = (dp/dt)^2 at the nodes of a grid. In each interval, of length h, u = d2p/dt2
//! changes linearly with p, from one value at its start to another at its end, so that
//! `x[i+1] = x[i] + h (u_start + u_end)`. The acceleration of joint j is `q'_j u + q''_j x`; its
//! limit leaves u a band at each node, which depends on x there. A sweep backwards finds how fast
//! the arm may be at each node and still slow down in time for all that follows; a sweep forwards
//! then goes as fast as that allows. The fastest stamps on this grid come out: at least one joint is always at
//! a limit (Larsen 2019, section 2.4).
//!
//! The two passes are those of TOPP-RA (Pham and Pham 2018). There u is constant in an interval and
//! both ends have to keep the limits, which wastes half of what the bounds change from node to node
//! and makes the time too long by a share of 1/N. With u linear the error falls with 1/N^2.
//!
//! Where q' changes its direction, as in a turn-back, a large x or u costs nothing at a node and much
//! next to it. Intervals that exceed a limit between their ends are therefore tightened ([`forward`]), and what
//! that changes is swept again.
//!
//! All numbers are in units of the limits: derivatives are divided by the joint's acceleration
//! limit, so that the limit is 1. The eighth of each row of eight is the coordinate of the tool, zero where that has
//! no limit.

mod bounds;
#[cfg(test)]
mod tests;

use iiwa_solver::PathRow;
use pulp::Simd;

use crate::grid::GridNode;
pub(crate) use bounds::{Bounds, MOST_GROUPS, greater, lesser};
use bounds::{Row, UNLIMITED, largest};

/// Share of a limit of acceleration, or of squared speed, by which an interval may exceed it between its ends.
const SWING: f64 = 0.0017;

/// Share of a further limit by which an interval may exceed it between its ends.
const ROW_SWING: f64 = 0.004;

/// Share by which it may half-way without being looked at closely.
const NEAR: f64 = 0.0013;

/// Up to this share, it is less of the limit that mends it; beyond, u has to be the same at both ends.
const MILD: f64 = 0.02;

/// Half-way is not enough to look at if within an interval u changes, times its length, by more than this share
/// of x; or x does by more than the other.
const KINK: f64 = 0.008;
const STEEP: f64 = 0.3;

/// Nor is it where the limits leave u no more than this share of itself: a joint that leaves its limit there may
/// exceed it first.
const NARROW: f64 = 0.01;

/// Differences of x by such a share are rounding.
const SAME: f64 = 1e-12;

/// An interval between two nodes.
#[derive(Clone, Copy)]
struct Interval<'a, const R: usize> {
    h: f64,
    /// Whether u has to be the same at both ends.
    even: bool,
    start: &'a Bounds<R>,
    end: &'a Bounds<R>,
}

impl<const R: usize> Interval<'_, R> {
    /// Largest x at the start, not above `x`, from which something up to `end` is reached.
    ///
    /// The room between the smallest and the largest x reached is a concave function of x, and there
    /// is some at 0. A chord over its root meets zero before the root, where there still is room.
    #[inline(never)]
    fn search(&self, end: f64, x: f64) -> f64 {
        const STEPS: usize = 100;
        // The cap of velocities may be far above what accelerations allow.
        let x = self.start.possible(pulp::Scalar::new(), x, &mut [0; 2]);
        let room = |x| {
            let (low, high) = self.reachable(x, end);
            high - low
        };
        let (mut high, mut lack) = (x, room(x));
        if lack >= 0.0 {
            return x;
        }
        let (mut low, mut spare) = (0.0, room(0.0));
        let mut kept = false;
        // A little before the root: at the root itself, rounding may leave no room.
        let margin = 1e-14 * x;
        for _ in 0..STEPS {
            if high - low <= 3.0 * margin || spare < 0.0 {
                break;
            }
            // Where the arm comes to rest there is no room but that: it is halved.
            let share = if spare > 0.0 { spare / (spare - lack) } else { 0.5 };
            let chord = (high - low) * share;
            let middle = low + (chord - margin).max(2.0 * margin);
            let found = room(middle);
            if found < 0.0 {
                (high, lack, kept) = (middle, found, false);
                continue;
            }
            // An end that is kept twice comes nearer if it weighs less (the Illinois method).
            (low, spare) = (middle, found);
            if kept {
                lack *= 0.5;
            }
            kept = true;
        }
        low
    }

    /// Smallest and largest x at the end, not above `cap`, that are reached from `x` at the start;
    /// none if the first is above the second.
    #[inline(never)]
    fn reachable(&self, x: f64, cap: f64) -> (f64, f64) {
        let (mut brake, mut most) = (UNLIMITED, UNLIMITED);
        let Bounds { fall, rise, below, above, .. } = self.start;
        let lines = [fall, rise, below, above].map(|lines| lines.as_flattened());
        for j in 0..8 * R {
            let [fall, rise, below, above] = lines.map(|line| line[j]);
            brake = lesser(brake, fall * x + below);
            most = lesser(most, rise * x + above);
        }
        let least = -brake;
        // With u the same at both ends, each end's band has to hold it alone, over both halves.
        let (h, brake, drive, mut low, mut high) = if self.even {
            let h = 2.0 * self.h;
            (h, x, x, x + h * least, (x + h * most).min(cap))
        } else {
            (self.h, x + self.h * least, x + self.h * most, 0.0, cap)
        };
        let Bounds { fall, rise, below, above, .. } = self.end;
        let lines = [fall, rise, below, above].map(|lines| lines.as_flattened());
        for j in 0..8 * R {
            let [fall, rise, below, above] = lines.map(|line| line[j]);
            // y - h (rise y + above) <= drive.
            let factor = 1.0 - h * rise;
            if factor > 1e-9 {
                high = high.min((drive + h * above) / factor);
            }
            // y + h (fall y + below) >= brake.
            let factor = 1.0 + h * fall;
            let least = brake - h * below;
            if factor > 1e-9 {
                low = low.max(least / factor);
            } else if factor < -1e-9 {
                high = high.min(least / factor);
            }
        }
        (low.max(0.0), high)
    }
}

/// A node of the sweep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// (dp/dt)^2, in 1/s^2.
    pub(crate) x: f64,
    /// d2p/dt2 at the start and at the end of the interval that begins here, in 1/s^2.
    pub(crate) u: [f64; 2],
    /// Whether u has to be the same at both ends of the interval that begins here.
    pub(crate) even: bool,
    /// Largest x here, beside what the limits at this node allow.
    pub(crate) x_max: f64,
    /// Share of the acceleration limits that may be used here.
    pub(crate) share: f64,
}

impl Default for Sample {
    fn default() -> Self {
        Self { x: 0.0, u: [0.0; 2], even: false, x_max: UNLIMITED, share: 1.0 }
    }
}

/// Fills `bounds` with what the limits leave at each node of a segment; they have room for all rows of further limits.
#[inline(always)]
pub(crate) fn bounds<S: Simd, const R: usize>(
    Nodes { simd, dq, ddq, velocity, grid, rows, row_count }: Nodes<'_, S>,
    bounds: &mut [Bounds<R>],
) {
    let mut before = 0.0;
    let nodes = dq.iter().zip(ddq).zip(grid).zip(&mut *bounds);
    for (((dq, ddq), node), bounds) in nodes {
        // After the last node nothing follows.
        let after = if node.p < 1.0 { node.step } else { 0.0 };
        bounds.set(simd, dq, ddq, velocity, greater(before, after));
        before = after;
    }
    if R > 1 {
        for (i, bounds) in bounds.iter_mut().enumerate() {
            bounds.set_rows(&rows[i * row_count..(i + 1) * row_count]);
        }
    }
}

/// Lowers the limits in `bounds` to the shares that earlier sweeps found.
pub(crate) fn lower<const R: usize>(bounds: &mut [Bounds<R>], samples: &[Sample]) {
    for (bounds, sample) in bounds.iter_mut().zip(samples) {
        bounds.lower(sample.share);
    }
}

/// The nodes of a segment, as [`bounds`], [`backward`] and [`sweep_until_valid`] take them; all slices are as long.
///
/// `dq` and `ddq` hold the derivatives at the nodes over the acceleration limits; `velocity` the
/// acceleration limits over the velocity limits, in 1/s; `rows` those of further limits by p, `row_count` at each node.
#[derive(Clone, Copy)]
pub(crate) struct Nodes<'a, S> {
    pub(crate) simd: S,
    pub(crate) dq: &'a [Row],
    pub(crate) ddq: &'a [Row],
    pub(crate) velocity: &'a Row,
    pub(crate) grid: &'a [GridNode],
    pub(crate) rows: &'a [PathRow],
    pub(crate) row_count: usize,
}

/// Sets the `x` of `samples` to the largest at each node from which all that follows can be kept,
/// given the largest x at the last node.
#[inline(always)]
pub(crate) fn backward<S: Simd, const R: usize>(
    nodes: Nodes<'_, S>,
    bounds: &[Bounds<R>],
    end: f64,
    samples: &mut [Sample],
) {
    for sample in &mut *samples {
        sample.x = UNLIMITED;
    }
    let n = samples.len() - 1;
    samples[n].x = end;
    lower_x(nodes, bounds, [0, n], samples);
}

/// Lowers the `x` of `samples` to what can be kept, backwards from the node `last`, until before `first` there is
/// nothing to lower. Returns the node at which it ends.
#[inline(always)]
fn lower_x<S: Simd, const R: usize>(
    nodes: Nodes<'_, S>,
    bounds: &[Bounds<R>],
    [first, last]: [usize; 2],
    samples: &mut [Sample],
) -> usize {
    let (nodes, bounds) = (nodes.first(samples.len()), &bounds[..samples.len()]);
    let Nodes { simd, grid, .. } = nodes;
    let next = &bounds[last];
    let (mut pair, mut lines, mut next_lines) = ([0; 2], [0; 2], [0; 2]);
    let mut x = lesser(lesser(samples[last].x, next.cap), samples[last].x_max);
    x = next.possible(simd, x, &mut pair);
    let (mut next_least, mut next_most) = (next.least(simd, x), next.most(simd, x));
    samples[last].x = x;
    for i in (0..last).rev() {
        let h = grid[i].step;
        let (start, next) = (&bounds[i], &bounds[i + 1]);
        let before = samples[i].x;
        let cap = lesser(lesser(start.cap, samples[i].x_max), before);
        let even = samples[i].even;
        let interval = |even| Interval { h, even, start, end: next };
        let end = x;
        let brake = end - h * next_least;
        // Where the arm speeds up although it has to arrive at `end`, a lower speed at the start may allow for more.
        let needs_search = even || brake < 0.5 * end;
        let brakes = [&start.fall, &start.below];
        let brake_most;
        (x, brake_most) = largest(simd, brakes, h, brake, cap, &mut lines);
        let mut least = -brake_most;
        let mut most = start.most(simd, x);
        if least > most && !needs_search {
            x = start.possible(simd, x, &mut pair);
            (least, most) = (start.least(simd, x), start.most(simd, x));
        }
        let drive = x + h * most;
        let found = if needs_search || x < 0.0 {
            Some(interval(even).search(end, cap))
        } else if end - h * next_most > drive {
            // Out of reach: it will arrive slower, and has to be able to.
            let (slower, _) =
                largest(simd, [&next.rise, &next.above], h, drive, end, &mut next_lines);
            let able = slower - h * next.least(simd, slower) >= x + h * least;
            if able { None } else { Some(interval(even).search(end, x)) }
        } else {
            let bands = [next_least, next_most];
            let u = split((end - x) / h, [least, most], bands);
            // Half-way, the acceleration differs from the mean of both ends by no more than
            // `h |q''| |change of u| / 2`.
            let swing = 0.5 * h * greater(start.bend, next.bend) * (u[1] - u[0]).abs();
            let acceleration = if swing > SWING { nodes.worst(i, h, x, u)[0] } else { 0.0 };
            if acceleration > 1.0 + SWING {
                // To come slower, and brake less, may be all it takes.
                let slower = end + (x - end) / acceleration;
                let own = [start.least(simd, slower), start.most(simd, slower)];
                let u = split((end - slower) / h, own, bands);
                if slower < x && nodes.worst(i, h, slower, u)[0] <= 1.0 + SWING {
                    Some(slower)
                } else {
                    samples[i].even = true;
                    Some(interval(true).search(end, x))
                }
            } else {
                None
            }
        };
        if let Some(found) = found {
            x = found;
            (least, most) = (start.least(simd, x), start.most(simd, x));
        }
        if i < first && x >= before * (1.0 - SAME) {
            return i;
        }
        samples[i].x = x;
        (next_least, next_most) = (least, most);
    }
    0
}

/// Lowers the `x` of `samples`, as [`backward`] left it, to what is reached from the node `first`, and finds u; until
/// from the node `last` on all is as it was.
///
/// Where a joint exceeds a limit within an interval, that is tightened: less of the limits is left there, or u
/// has to be the same at both ends. Returns the first and the last one for which that has to be swept again.
#[inline(always)]
fn forward<S: Simd, const R: usize>(
    nodes: Nodes<'_, S>,
    bounds: &[Bounds<R>],
    [first, last]: [usize; 2],
    samples: &mut [Sample],
) -> Option<[usize; 2]> {
    let (nodes, bounds) = (nodes.first(samples.len()), &bounds[..samples.len()]);
    let Nodes { simd, grid, .. } = nodes;
    let n = samples.len() - 1;
    let mut tightened = None;
    let mut lines = [0; 2];
    let mut x = samples[first].x;
    let (mut least, mut most) = (bounds[first].least(simd, x), bounds[first].most(simd, x));
    let mut narrow = false;
    for i in first..n {
        let h = grid[i].step;
        let next = &bounds[i + 1];
        let even = samples[i].even;
        let interval = |even| Interval { h, even, start: &bounds[i], end: next };
        let cap = samples[i + 1].x;
        let drive = x + h * most;
        let drives = [&next.rise, &next.above];
        let (mut y, mut next_most) = largest(simd, drives, h, drive, cap, &mut lines);
        let mut next_least = next.least(simd, y);
        if even || y < 0.0 || y - h * next_least < x + h * least - 1e-12 * x {
            y = interval(even).reachable(x, cap).1.max(0.0);
            (next_least, next_most) = (next.least(simd, y), next.most(simd, y));
        }
        let sum = (y - x) / h;
        let mut u =
            if even { [0.5 * sum; 2] } else { split(sum, [least, most], [next_least, next_most]) };
        let next_narrow = next_most - next_least < NARROW * next_most.abs();
        let bends = h * (u[1] - u[0]).abs() > KINK * x || (y - x).abs() > STEEP * x;
        if bends || narrow || next_narrow || nodes.half_way(i, h, x, u) > 1.0 + NEAR {
            let [mut acceleration, mut square] = nodes.worst(i, h, x, u);
            if acceleration > 1.0 + SWING && !even {
                // On the way up it can often be mended here: arriving slower, or else with u the same.
                let slower = x + (y - x) / acceleration;
                let bands = [next.least(simd, slower), next.most(simd, slower)];
                let eased = split((slower - x) / h, [least, most], bands);
                let now = nodes.worst(i, h, x, eased);
                if slower < y && slower - h * bands[0] >= x + h * least && now[0] <= 1.0 + SWING {
                    (y, u) = (slower, eased);
                    [next_least, next_most] = bands;
                    [acceleration, square] = now;
                } else if acceleration > 1.0 + MILD {
                    let (low, high) = interval(true).reachable(x, cap);
                    if low <= high {
                        (y, u) = (high, [0.5 * (high - x) / h; 2]);
                        (next_least, next_most) = (next.least(simd, y), next.most(simd, y));
                        [acceleration, square] = nodes.worst(i, h, x, u);
                    }
                    samples[i].even = true;
                }
            }
            if square > 1.0 + SWING {
                samples[i].x_max = x / square;
                samples[i + 1].x_max = y / square;
            }
            if acceleration > 1.0 + SWING && (even || acceleration < 1.0 + MILD) {
                for node in &mut samples[i..=i + 1] {
                    node.share /= acceleration;
                }
            }
            if greater(acceleration, square) > 1.0 + SWING {
                let [begin, _] = tightened.unwrap_or([i; 2]);
                tightened = Some([begin, i]);
            }
        }
        samples[i].u = u;
        samples[i + 1].x = y;
        if i + 1 >= last && y >= cap * (1.0 - SAME) {
            break;
        }
        (x, least, most, narrow) = (y, next_least, next_most, next_narrow);
    }
    tightened
}

impl<S: Simd> Nodes<'_, S> {
    /// The same nodes, of which the compiler then knows that there are `count`.
    #[inline(always)]
    fn first(self, count: usize) -> Self {
        let Self { simd, dq, ddq, velocity, grid, rows, row_count } = self;
        let nodes = ..count;
        let (dq, ddq, grid) = (&dq[nodes], &ddq[nodes], &grid[nodes]);
        Self { simd, dq, ddq, velocity, grid, rows, row_count }
    }

    /// The largest share of a limit of acceleration or of a further limit, or squared share of a velocity limit, half-way through
    /// interval `i`.
    #[inline(always)]
    fn half_way(&self, i: usize, h: f64, x: f64, u: [f64; 2]) -> f64 {
        let Self { simd, dq, ddq, velocity, .. } = *self;
        let row = |row| S::as_simd_f64s(row).0;
        let (dq, ddq) = ([row(&dq[i]), row(&dq[i + 1])], [row(&ddq[i]), row(&ddq[i + 1])]);
        let velocity = row(velocity);
        let place = Place::new(h, x, u, 0.5);
        let (mut acceleration, mut square) = (simd.splat_f64s(0.0), simd.splat_f64s(0.0));
        for k in 0..velocity.len() {
            let ends = [dq[0][k], dq[1][k], ddq[0][k], ddq[1][k]];
            let (a, v) = place.joints(simd, ends, velocity[k]);
            acceleration = simd.max_f64s(acceleration, simd.abs_f64s(a));
            square = simd.max_f64s(square, v);
        }
        let worst = simd.reduce_max_f64s(simd.max_f64s(acceleration, square));
        if self.row_count == 0 { worst } else { greater(worst, self.row(i, &place, 0.5)) }
    }

    /// The largest share of a further limit at a `place`, the share `t`, of interval `i`. Above what is let pass, it is the
    /// share of what the offset leaves of the limit, which is what tightening lowers.
    fn row(&self, i: usize, place: &Place, t: f64) -> f64 {
        let count = self.row_count;
        let [from, to] = [i, i + 1].map(|node| &self.rows[node * count..(node + 1) * count]);
        let mut worst = 0.0;
        for (from, to) in from.iter().zip(to) {
            let mixed = |from: f64, to: f64| from + t * (to - from);
            let offset = mixed(from.offset, to.offset);
            let moving = mixed(from.acceleration, to.acceleration) * place.u
                + mixed(from.square, to.square) * place.x;
            let share = (moving + offset).abs();
            let room = 1.0 - offset.copysign(offset * moving);
            let measure =
                if share <= 1.0 + ROW_SWING { lesser(share, 1.0) } else { moving.abs() / room };
            worst = greater(worst, measure);
        }
        worst
    }

    /// The largest share of a limit of acceleration or of a further limit, and squared share of a velocity limit, in the inner
    /// quarters of interval `i`.
    #[inline(always)]
    fn worst(&self, i: usize, h: f64, x: f64, u: [f64; 2]) -> [f64; 2] {
        let Self { simd, dq, ddq, velocity, .. } = *self;
        let row = |row| S::as_simd_f64s(row).0;
        let (dq, ddq) = ([row(&dq[i]), row(&dq[i + 1])], [row(&ddq[i]), row(&ddq[i + 1])]);
        let velocity = row(velocity);
        let places =
            [Place::new(h, x, u, 0.25), Place::new(h, x, u, 0.5), Place::new(h, x, u, 0.75)];
        let (mut acceleration, mut square) = (simd.splat_f64s(0.0), simd.splat_f64s(0.0));
        for k in 0..velocity.len() {
            let ends = [dq[0][k], dq[1][k], ddq[0][k], ddq[1][k]];
            // No `map`: its closure would not have the vector instructions.
            let a = places[0].joints(simd, ends, velocity[k]);
            let b = places[1].joints(simd, ends, velocity[k]);
            let c = places[2].joints(simd, ends, velocity[k]);
            acceleration = simd.max_f64s(acceleration, peak(simd, [a.0, b.0, c.0]));
            square = simd.max_f64s(square, peak(simd, [a.1, b.1, c.1]));
        }
        let [mut acceleration, square] =
            [simd.reduce_max_f64s(acceleration), simd.reduce_max_f64s(square)];
        if self.row_count > 0 {
            for (place, t) in places.iter().zip([0.25, 0.5, 0.75]) {
                acceleration = greater(acceleration, self.row(i, place, t));
            }
        }
        [acceleration, square]
    }
}

/// A place within an interval.
struct Place {
    /// Weights of q' at both ends of the interval and of q'' there: those of q' and of q'' at the place, by the
    /// cubic that has the same at both ends.
    value: [f64; 4],
    slope: [f64; 4],
    x: f64,
    u: f64,
}

impl Place {
    /// At the share `t` of the interval's length.
    #[inline(always)]
    fn new(h: f64, x: f64, u: [f64; 2], t: f64) -> Self {
        let to = t * t * (3.0 - 2.0 * t);
        let steep = 6.0 * t * (1.0 - t) / h;
        Self {
            value: [1.0 - to, to, h * t * (1.0 - t) * (1.0 - t), h * t * t * (t - 1.0)],
            slope: [-steep, steep, (1.0 - t) * (1.0 - 3.0 * t), t * (3.0 * t - 2.0)],
            x: x + h * t * (2.0 * u[0] + t * (u[1] - u[0])),
            u: u[0] + t * (u[1] - u[0]),
        }
    }

    /// The shares of the acceleration limits, with their signs, and the squared shares of the velocity limits.
    #[inline(always)]
    fn joints<S: Simd>(
        &self,
        simd: S,
        ends: [S::f64s; 4],
        velocity: S::f64s,
    ) -> (S::f64s, S::f64s) {
        let (p, r) = (mix(simd, self.value, ends), mix(simd, self.slope, ends));
        let x = simd.splat_f64s(self.x);
        let a = simd.mul_add_e_f64s(p, simd.splat_f64s(self.u), simd.mul_f64s(r, x));
        let v = simd.mul_f64s(p, velocity);
        (a, simd.mul_f64s(simd.mul_f64s(v, v), x))
    }
}

/// The largest absolute value of the parabolas through three values at equal distances, as far as they reach.
#[inline(always)]
fn peak<S: Simd>(simd: S, values: [S::f64s; 3]) -> S::f64s {
    let sign = simd.and_f64s(values[1], simd.splat_f64s(-0.0));
    let [a, b, c] = values;
    let (a, c) = (simd.xor_f64s(a, sign), simd.xor_f64s(c, sign));
    let b = simd.abs_f64s(b);
    let slope = simd.mul_f64s(simd.splat_f64s(0.5), simd.sub_f64s(c, a));
    let bend = simd.sub_f64s(simd.add_f64s(b, b), simd.add_f64s(a, c));
    // Where the parabola has no top between them, this is less than the greater end.
    let width = simd.max_f64s(simd.max_f64s(bend, simd.abs_f64s(slope)), simd.splat_f64s(1e-30));
    let top = simd.div_f64s(simd.mul_f64s(slope, slope), simd.add_f64s(width, width));
    let ends = simd.max_f64s(simd.abs_f64s(a), simd.abs_f64s(c));
    simd.max_f64s(ends, simd.add_f64s(b, top))
}

/// The sum of `values`, each times its weight.
#[inline(always)]
fn mix<S: Simd>(simd: S, weights: [f64; 4], values: [S::f64s; 4]) -> S::f64s {
    let mut sum = simd.mul_f64s(simd.splat_f64s(weights[0]), values[0]);
    for k in 1..4 {
        sum = simd.mul_add_e_f64s(simd.splat_f64s(weights[k]), values[k], sum);
    }
    sum
}

/// Sweeps forwards until no interval of the segment has to be tightened, and backwards in between.
/// False if that makes what came before the segment too fast: then all has to be swept again.
#[inline(always)]
pub(crate) fn sweep_until_valid<S: Simd, const R: usize>(
    nodes: Nodes<'_, S>,
    bounds: &mut [Bounds<R>],
    start: f64,
    samples: &mut [Sample],
) -> bool {
    const ROUNDS: usize = 30;
    let n = samples.len() - 1;
    samples[0].x = lesser(samples[0].x, start);
    let mut stretch = [0, n];
    for _ in 0..ROUNDS {
        if samples[0].x < start * (1.0 - SAME) {
            return false;
        }
        let Some([first, last]) = forward(nodes, bounds, stretch, samples) else { return true };
        // The interval after it starts at a node with other limits.
        let end = (last + 2).min(n);
        lower(&mut bounds[first..=last + 1], &samples[first..=last + 1]);
        stretch = [lower_x(nodes, bounds, [first, end], samples), end];
    }
    false
}

/// u at both ends of an interval, which add up to `sum`, within the bands that the limits leave:
/// the same at both ends where there is a choice.
#[inline(always)]
fn split(sum: f64, start: [f64; 2], end: [f64; 2]) -> [f64; 2] {
    let u_start = within(0.5 * sum, start[0], start[1]);
    let u_end = within(sum - u_start, end[0], end[1]);
    [sum - u_end, u_end]
}

/// `value`, moved into `low` to `high`; unlike `clamp`, whatever the order of the two.
#[inline(always)]
fn within(value: f64, low: f64, high: f64) -> f64 {
    let value = if value < low { low } else { value };
    if value > high { high } else { value }
}
