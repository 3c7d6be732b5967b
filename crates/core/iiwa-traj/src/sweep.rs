//! Acceleration-limited sweep over the samples of a curved segment (Larsen 2019, section 2.4.1).
//!
//! The path parameter is p, the share of the segment's sigma, 0 to 1. Along a blend, s would not
//! do: at constant speed ds/dt changes, and in a blend that is short relative to the speed, the
//! acceleration would be a small difference of large numbers.
//!
//! The unknowns at the nodes of a grid are x = (dp/dt)^2 and u = d2p/dt2. In each interval, of
//! length h, u changes linearly with p from its value at the start to its value at the end, so that
//! `x[i+1] = x[i] + h (u_start + u_end)`. Limits are constraints in the notation of TOPP-RA (Pham
//! and Pham 2018), `a u + b x + c <= 0`. The acceleration `q'_j u + q''_j x` of joint j gives two
//! of them: `a = q'_j`, `b = q''_j`, `c = -1`, and the mirrored one with `-a`, `-b` and the same c.
//! At each node the constraints leave a range of feasible u, which depends on x.
//!
//! The backward pass finds the upper bound of the controllable set at each node: the largest x from
//! which all later constraints can still be kept. The lower bound is taken to be 0. The forward
//! pass then takes the largest reachable x within the controllable set of each next node. The
//! result is the fastest time parameterisation on this grid: at least one joint is always at a
//! limit (Larsen 2019, section 2.4).
//!
//! TOPP-RA itself keeps u constant in an interval, and both ends have to keep the limits. That
//! wastes half of the change of the bounds from node to node and makes the duration too long by a
//! share of 1/N. With linear u the error falls with 1/N^2.
//!
//! At a sign change of q', such as at a reversal, a node hardly constrains x and u although the
//! points next to it do. Intervals that exceed a limit between their ends are therefore tightened
//! ([`forward`]), and the nodes that this affects are swept again.
//!
//! All numbers are in units of the limits: derivatives are divided by the joint's acceleration
//! limit, so that the limit is 1. The last element of each row of eight is the tool coordinate,
//! zero where the tool has no limit.

mod bounds;
#[cfg(test)]
mod tests;

use iiwa_solver::PathRow;
use pulp::Simd;

use crate::grid::GridNode;
pub(crate) use bounds::{Bounds, MAX_GROUPS, max, min};
use bounds::{Row, UNLIMITED, largest};

/// Excess of an acceleration limit, or of a squared speed limit, tolerated between the ends of an
/// interval, as a share of the limit.
const SWING: f64 = 0.0017;

/// Excess of a further limit tolerated between the ends of an interval, as a share of the limit.
const ROW_SWING: f64 = 0.004;

/// Excess half-way through an interval below which the inner quarters are not checked.
const NEAR: f64 = 0.0013;

/// Excess up to which an interval is tightened by a lower share of the limits; beyond, u has to be
/// the same at both ends.
const MILD: f64 = 0.02;

/// Changes within an interval, relative to x, above which checking half-way is not enough: of u,
/// times the interval's length (`KINK`), and of x (`STEEP`).
const KINK: f64 = 0.008;
const STEEP: f64 = 0.3;

/// Width of the feasible range of u, relative to its upper bound, below which checking half-way is
/// not enough: a joint whose limit is about to become inactive there may exceed that limit first.
const NARROW: f64 = 0.01;

/// Relative differences of x up to this share are rounding.
const SAME: f64 = 1e-12;

/// An interval between two nodes.
#[derive(Clone, Copy)]
struct Interval<'a, const R: usize> {
    h: f64,
    /// `true` if u has to be the same at both ends.
    even: bool,
    start: &'a Bounds<R>,
    end: &'a Bounds<R>,
}

impl<const R: usize> Interval<'_, R> {
    /// Returns the largest x at the start, at most `x`, from which some x up to `end` is reachable:
    /// the upper bound of the one-step controllable set.
    ///
    /// The width of the reachable interval is a concave function of x, and not negative at 0. A
    /// chord over its root therefore meets zero before the root, where the width is not negative.
    #[inline(never)]
    fn search(&self, end: f64, x: f64) -> f64 {
        const STEPS: usize = 100;
        // The velocity cap may be far above the largest x with a feasible u.
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
        let mut is_valid = false;
        // Slightly below the root: at the root itself, the width may be negative by rounding.
        let margin = 1e-14 * x;
        for _ in 0..STEPS {
            if high - low <= 3.0 * margin || spare < 0.0 {
                break;
            }
            // The width is zero where the robot stops, so the chord gives no share: bisect.
            let share = if spare > 0.0 { spare / (spare - lack) } else { 0.5 };
            let chord = (high - low) * share;
            let middle = low + (chord - margin).max(2.0 * margin);
            let difference = room(middle);
            if difference < 0.0 {
                (high, lack, is_valid) = (middle, difference, false);
                continue;
            }
            // The Illinois method: halving the weight of an end that was kept twice speeds up
            // convergence.
            (low, spare) = (middle, difference);
            if is_valid {
                lack *= 0.5;
            }
            is_valid = true;
        }
        low
    }

    /// Returns the smallest and the largest x at the end, at most `cap`, that are reachable from
    /// `x` at the start. The reachable set is empty if the first is above the second.
    #[inline(never)]
    fn reachable(&self, x: f64, cap: f64) -> (f64, f64) {
        let (mut brake, mut u_max) = (UNLIMITED, UNLIMITED);
        let Bounds { fall, rise, below, above, .. } = self.start;
        let lines = [fall, rise, below, above].map(|lines| lines.as_flattened());
        for j in 0..8 * R {
            let [fall, rise, below, above] = lines.map(|line| line[j]);
            brake = min(brake, fall * x + below);
            u_max = min(u_max, rise * x + above);
        }
        let u_min = -brake;
        // With one u for both ends, the range at each end has to contain it, over both halves.
        let (h, brake, drive, mut low, mut high) = if self.even {
            let h = 2.0 * self.h;
            (h, x, x, x + h * u_min, (x + h * u_max).min(cap))
        } else {
            (self.h, x + self.h * u_min, x + self.h * u_max, 0.0, cap)
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
            // A negative factor turns the lower bound of y into an upper one; near zero there is no
            // bound.
            let room = brake - h * below;
            if factor > 1e-9 {
                low = low.max(room / factor);
            } else if factor < -1e-9 {
                high = high.min(room / factor);
            }
        }
        (low.max(0.0), high)
    }
}

/// A node of the sweep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SweepNode {
    /// (dp/dt)^2, in 1/s^2.
    pub(crate) x: f64,
    /// d2p/dt2 at the start and at the end of the interval that begins here, in 1/s^2.
    pub(crate) u: [f64; 2],
    /// `true` if u has to be the same at both ends of the interval that begins here.
    pub(crate) even: bool,
    /// Upper bound of x at this node in addition to the node's own limits.
    pub(crate) x_max: f64,
    /// Usable share of the acceleration limits at this node.
    pub(crate) share: f64,
}

impl Default for SweepNode {
    fn default() -> Self {
        Self { x: 0.0, u: [0.0; 2], even: false, x_max: UNLIMITED, share: 1.0 }
    }
}

/// Sets `bounds` to the constraints at each node of a segment. `R` groups hold all rows of further
/// limits.
#[inline(always)]
pub(crate) fn bounds<S: Simd, const R: usize>(
    Nodes { simd, dq, ddq, velocity, grid, rows, row_count }: Nodes<'_, S>,
    bounds: &mut [Bounds<R>],
) {
    let mut before = 0.0;
    let nodes = dq.iter().zip(ddq).zip(grid).zip(&mut *bounds);
    for (((dq, ddq), node), bounds) in nodes {
        // No interval follows the last node.
        let after = if node.p < 1.0 { node.step } else { 0.0 };
        bounds.set(simd, dq, ddq, velocity, max(before, after));
        before = after;
    }
    if R > 1 {
        for (i, bounds) in bounds.iter_mut().enumerate() {
            bounds.set_rows(&rows[i * row_count..(i + 1) * row_count]);
        }
    }
}

/// Lowers the limits in `bounds` to the shares found by earlier sweeps.
pub(crate) fn lower<const R: usize>(bounds: &mut [Bounds<R>], samples: &[SweepNode]) {
    for (bounds, sample) in bounds.iter_mut().zip(samples) {
        bounds.lower(sample.share);
    }
}

/// Nodes of a segment, as input of [`bounds`], [`backward`] and [`sweep_until_valid`]; all slices
/// over nodes have the same length.
///
/// `dq` and `ddq` hold the derivatives at the nodes over the acceleration limits, `velocity` the
/// acceleration limits over the velocity limits, in 1/s, and `rows` the rows of further limits by
/// p, `row_count` at each node.
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

/// Backward pass: sets the `x` of each sample to the upper bound of the controllable set at its
/// node, given the largest x at the last node.
#[inline(always)]
pub(crate) fn backward<S: Simd, const R: usize>(
    nodes: Nodes<'_, S>,
    bounds: &[Bounds<R>],
    end: f64,
    samples: &mut [SweepNode],
) {
    for sample in &mut *samples {
        sample.x = UNLIMITED;
    }
    let n = samples.len() - 1;
    samples[n].x = end;
    lower_x(nodes, bounds, [0, n], samples);
}

/// Lowers the `x` of `samples` to the upper bounds of the controllable sets, backwards from the
/// node `last`, and ends at the first node before `first` whose `x` does not change. Returns that
/// node.
#[inline(always)]
fn lower_x<S: Simd, const R: usize>(
    nodes: Nodes<'_, S>,
    bounds: &[Bounds<R>],
    [first, last]: [usize; 2],
    samples: &mut [SweepNode],
) -> usize {
    let (nodes, bounds) = (nodes.first(samples.len()), &bounds[..samples.len()]);
    let Nodes { simd, grid, .. } = nodes;
    let next = &bounds[last];
    let (mut pair, mut lines, mut next_lines) = ([0; 2], [0; 2], [0; 2]);
    let mut x = min(min(samples[last].x, next.cap), samples[last].x_max);
    x = next.possible(simd, x, &mut pair);
    let (mut next_u_min, mut next_u_max) = (next.u_min(simd, x), next.u_max(simd, x));
    samples[last].x = x;
    for i in (0..last).rev() {
        let h = grid[i].step;
        let (start, next) = (&bounds[i], &bounds[i + 1]);
        let before = samples[i].x;
        let cap = min(min(start.cap, samples[i].x_max), before);
        let even = samples[i].even;
        let interval = |even| Interval { h, even, start, end: next };
        let end = x;
        let brake = end - h * next_u_min;
        // Where the limits at the end force the robot to speed up, a lower speed at the start may
        // be feasible although a higher one is not: only the search finds it.
        let needs_search = even || brake < 0.5 * end;
        let brakes = [&start.fall, &start.below];
        let brake_max;
        (x, brake_max) = largest(simd, brakes, h, brake, cap, &mut lines);
        let mut u_min = -brake_max;
        let mut u_max = start.u_max(simd, x);
        if u_min > u_max && !needs_search {
            x = start.possible(simd, x, &mut pair);
            (u_min, u_max) = (start.u_min(simd, x), start.u_max(simd, x));
        }
        let drive = x + h * u_max;
        let reached = if needs_search || x < 0.0 {
            Some(interval(even).search(end, cap))
        } else if end - h * next_u_max > drive {
            // `end` is out of reach. The robot arrives slower, which the lower bounds of u at both
            // ends have to permit.
            let (slower, _) =
                largest(simd, [&next.rise, &next.above], h, drive, end, &mut next_lines);
            let able = slower - h * next.u_min(simd, slower) >= x + h * u_min;
            if able { None } else { Some(interval(even).search(end, x)) }
        } else {
            let bands = [next_u_min, next_u_max];
            let u = split((end - x) / h, [u_min, u_max], bands);
            // Half-way, the acceleration differs from the mean of both ends by at most
            // `h |q''| |change of u| / 2`: only a larger bound needs a check.
            let swing = 0.5 * h * max(start.bend, next.bend) * (u[1] - u[0]).abs();
            let acceleration = if swing > SWING { nodes.worst(i, h, x, u)[0] } else { 0.0 };
            if acceleration > 1.0 + SWING {
                // A lower start speed with less braking may suffice, and costs less than equal u at
                // both ends.
                let slower = end + (x - end) / acceleration;
                let band = [start.u_min(simd, slower), start.u_max(simd, slower)];
                let u = split((end - slower) / h, band, bands);
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
        if let Some(reached) = reached {
            x = reached;
            (u_min, u_max) = (start.u_min(simd, x), start.u_max(simd, x));
        }
        // Earlier nodes depend on later ones through x alone: the pass ends where x is unchanged.
        if i < first && x >= before * (1.0 - SAME) {
            return i;
        }
        samples[i].x = x;
        (next_u_min, next_u_max) = (u_min, u_max);
    }
    0
}

/// Forward pass: lowers the `x` of `samples`, as [`backward`] left them, to the values reachable
/// from the node `first`, and sets u. Ends after the node `last` as soon as `x` does not change any
/// more.
///
/// An interval within which a joint exceeds a limit is tightened: the usable share of the limits is
/// lowered, or u has to be the same at both ends. Returns the first and the last tightened
/// interval, which have to be swept again.
#[inline(always)]
fn forward<S: Simd, const R: usize>(
    nodes: Nodes<'_, S>,
    bounds: &[Bounds<R>],
    [first, last]: [usize; 2],
    samples: &mut [SweepNode],
) -> Option<[usize; 2]> {
    let (nodes, bounds) = (nodes.first(samples.len()), &bounds[..samples.len()]);
    let Nodes { simd, grid, .. } = nodes;
    let n = samples.len() - 1;
    let mut tightened = None;
    let mut lines = [0; 2];
    let mut x = samples[first].x;
    let (mut u_min, mut u_max) = (bounds[first].u_min(simd, x), bounds[first].u_max(simd, x));
    let mut narrow = false;
    for i in first..n {
        let h = grid[i].step;
        let next = &bounds[i + 1];
        let even = samples[i].even;
        let interval = |even| Interval { h, even, start: &bounds[i], end: next };
        let cap = samples[i + 1].x;
        let drive = x + h * u_max;
        let drives = [&next.rise, &next.above];
        let (mut y, mut next_u_max) = largest(simd, drives, h, drive, cap, &mut lines);
        let mut next_u_min = next.u_min(simd, y);
        if even || y < 0.0 || y - h * next_u_min < x + h * u_min - 1e-12 * x {
            y = interval(even).reachable(x, cap).1.max(0.0);
            (next_u_min, next_u_max) = (next.u_min(simd, y), next.u_max(simd, y));
        }
        let sum = (y - x) / h;
        let mut u = if even {
            [0.5 * sum; 2]
        } else {
            split(sum, [u_min, u_max], [next_u_min, next_u_max])
        };
        let next_narrow = next_u_max - next_u_min < NARROW * next_u_max.abs();
        let bends = h * (u[1] - u[0]).abs() > KINK * x || (y - x).abs() > STEEP * x;
        if bends || narrow || next_narrow || nodes.half_way(i, h, x, u) > 1.0 + NEAR {
            let [mut acceleration, mut square] = nodes.worst(i, h, x, u);
            if acceleration > 1.0 + SWING && !even {
                // While speeding up, a lower arrival speed often suffices; otherwise u is made
                // equal at both ends.
                let slower = x + (y - x) / acceleration;
                let bands = [next.u_min(simd, slower), next.u_max(simd, slower)];
                let eased = split((slower - x) / h, [u_min, u_max], bands);
                let now = nodes.worst(i, h, x, eased);
                if slower < y && slower - h * bands[0] >= x + h * u_min && now[0] <= 1.0 + SWING {
                    (y, u) = (slower, eased);
                    [next_u_min, next_u_max] = bands;
                    [acceleration, square] = now;
                } else if acceleration > 1.0 + MILD {
                    let (low, high) = interval(true).reachable(x, cap);
                    if low <= high {
                        (y, u) = (high, [0.5 * (high - x) / h; 2]);
                        (next_u_min, next_u_max) = (next.u_min(simd, y), next.u_max(simd, y));
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
            if max(acceleration, square) > 1.0 + SWING {
                let [begin, _] = tightened.unwrap_or([i; 2]);
                tightened = Some([begin, i]);
            }
        }
        samples[i].u = u;
        samples[i + 1].x = y;
        // Later intervals start from the same x as before: nothing changes there.
        if i + 1 >= last && y >= cap * (1.0 - SAME) {
            break;
        }
        (x, u_min, u_max, narrow) = (y, next_u_min, next_u_max, next_narrow);
    }
    tightened
}

impl<S: Simd> Nodes<'_, S> {
    /// Returns the first `count` nodes; the explicit length lets the compiler drop bounds checks.
    #[inline(always)]
    fn first(self, count: usize) -> Self {
        let Self { simd, dq, ddq, velocity, grid, rows, row_count } = self;
        let nodes = ..count;
        let (dq, ddq, grid) = (&dq[nodes], &ddq[nodes], &grid[nodes]);
        Self { simd, dq, ddq, velocity, grid, rows, row_count }
    }

    /// Returns the largest share of an acceleration limit or of a further limit, or squared share
    /// of a velocity limit, half-way through interval `i`.
    #[inline(always)]
    fn half_way(&self, i: usize, h: f64, x: f64, u: [f64; 2]) -> f64 {
        let Self { simd, dq, ddq, velocity, .. } = *self;
        let row = |row| S::as_simd_f64s(row).0;
        let (dq, ddq) = ([row(&dq[i]), row(&dq[i + 1])], [row(&ddq[i]), row(&ddq[i + 1])]);
        let velocity = row(velocity);
        let place = IntervalPlace::new(h, x, u, 0.5);
        let (mut acceleration, mut square) = (simd.splat_f64s(0.0), simd.splat_f64s(0.0));
        for k in 0..velocity.len() {
            let ends = [dq[0][k], dq[1][k], ddq[0][k], ddq[1][k]];
            let (a, v) = place.joints(simd, ends, velocity[k]);
            acceleration = simd.max_f64s(acceleration, simd.abs_f64s(a));
            square = simd.max_f64s(square, v);
        }
        let worst = simd.reduce_max_f64s(simd.max_f64s(acceleration, square));
        if self.row_count == 0 { worst } else { max(worst, self.row(i, &place, 0.5)) }
    }

    /// Returns the largest share of a further limit at a `place` of interval `i`, at the share `t`
    /// of its length. Above the tolerated excess, it returns moving part / (limit - offset)
    /// instead: tightening lowers the moving part only, since the offset (gravity, for torques)
    /// does not depend on the speed.
    fn row(&self, i: usize, place: &IntervalPlace, t: f64) -> f64 {
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
                if share <= 1.0 + ROW_SWING { min(share, 1.0) } else { moving.abs() / room };
            worst = max(worst, measure);
        }
        worst
    }

    /// Returns the largest share of an acceleration limit or of a further limit, and the largest
    /// squared share of a velocity limit, in the inner quarters of interval `i`.
    #[inline(always)]
    fn worst(&self, i: usize, h: f64, x: f64, u: [f64; 2]) -> [f64; 2] {
        let Self { simd, dq, ddq, velocity, .. } = *self;
        let row = |row| S::as_simd_f64s(row).0;
        let (dq, ddq) = ([row(&dq[i]), row(&dq[i + 1])], [row(&ddq[i]), row(&ddq[i + 1])]);
        let velocity = row(velocity);
        let places = [
            IntervalPlace::new(h, x, u, 0.25),
            IntervalPlace::new(h, x, u, 0.5),
            IntervalPlace::new(h, x, u, 0.75),
        ];
        let (mut acceleration, mut square) = (simd.splat_f64s(0.0), simd.splat_f64s(0.0));
        for k in 0..velocity.len() {
            let ends = [dq[0][k], dq[1][k], ddq[0][k], ddq[1][k]];
            // No `map`: a closure would not be compiled with the vector instructions.
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
                acceleration = max(acceleration, self.row(i, place, t));
            }
        }
        [acceleration, square]
    }
}

/// Place within an interval.
struct IntervalPlace {
    /// Weights of q' at both ends of the interval and of q'' at both ends, for q' (`value`) and q''
    /// (`slope`) at the place, by the cubic that matches all four.
    value: [f64; 4],
    slope: [f64; 4],
    x: f64,
    u: f64,
}

impl IntervalPlace {
    /// Creates the place at the share `t` of the interval's length.
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

    /// Returns the shares of the acceleration limits, with signs, and the squared shares of the
    /// velocity limits.
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

/// Returns the largest absolute value of the parabolas through three values at equal distances,
/// between the outer two.
#[inline(always)]
fn peak<S: Simd>(simd: S, values: [S::f64s; 3]) -> S::f64s {
    let sign = simd.and_f64s(values[1], simd.splat_f64s(-0.0));
    let [a, b, c] = values;
    let (a, c) = (simd.xor_f64s(a, sign), simd.xor_f64s(c, sign));
    let b = simd.abs_f64s(b);
    let slope = simd.mul_f64s(simd.splat_f64s(0.5), simd.sub_f64s(c, a));
    let bend = simd.sub_f64s(simd.add_f64s(b, b), simd.add_f64s(a, c));
    // If the vertex of the parabola is not between the outer values, this is less than the larger
    // of them.
    let width = simd.max_f64s(simd.max_f64s(bend, simd.abs_f64s(slope)), simd.splat_f64s(1e-30));
    let top = simd.div_f64s(simd.mul_f64s(slope, slope), simd.add_f64s(width, width));
    let ends = simd.max_f64s(simd.abs_f64s(a), simd.abs_f64s(c));
    simd.max_f64s(ends, simd.add_f64s(b, top))
}

/// Returns the sum of `values` times `weights`.
#[inline(always)]
fn mix<S: Simd>(simd: S, weights: [f64; 4], values: [S::f64s; 4]) -> S::f64s {
    let mut sum = simd.mul_f64s(simd.splat_f64s(weights[0]), values[0]);
    for k in 1..4 {
        sum = simd.mul_add_e_f64s(simd.splat_f64s(weights[k]), values[k], sum);
    }
    sum
}

/// Sweeps forwards until no interval of the segment has to be tightened, and backwards in between.
/// Returns false if the start of the segment had to become slower, so that the segments before it
/// have to be swept again.
#[inline(always)]
pub(crate) fn sweep_until_valid<S: Simd, const R: usize>(
    nodes: Nodes<'_, S>,
    bounds: &mut [Bounds<R>],
    start: f64,
    samples: &mut [SweepNode],
) -> bool {
    const ROUNDS: usize = 30;
    let n = samples.len() - 1;
    samples[0].x = min(samples[0].x, start);
    let mut stretch = [0, n];
    for _ in 0..ROUNDS {
        if samples[0].x < start * (1.0 - SAME) {
            return false;
        }
        let Some([first, last]) = forward(nodes, bounds, stretch, samples) else { return true };
        // The interval after the last tightened one begins at a node whose limits were lowered.
        let end = (last + 2).min(n);
        lower(&mut bounds[first..=last + 1], &samples[first..=last + 1]);
        stretch = [lower_x(nodes, bounds, [first, end], samples), end];
    }
    false
}

/// Splits `sum` into u at both ends of an interval, each within its feasible range: equal if the
/// ranges permit, otherwise as close to equal as possible.
#[inline(always)]
fn split(sum: f64, start: [f64; 2], end: [f64; 2]) -> [f64; 2] {
    let u_start = within(0.5 * sum, start[0], start[1]);
    let u_end = within(sum - u_start, end[0], end[1]);
    [sum - u_end, u_end]
}

/// Clamps `value` to `low..=high`; unlike `f64::clamp`, it accepts `low > high`.
#[inline(always)]
fn within(value: f64, low: f64, high: f64) -> f64 {
    let value = if value < low { low } else { value };
    if value > high { high } else { value }
}
