//! The sweep over the samples of a curved segment (Larsen 2019, section 2.4.1).
//!
//! Unknown is x = (ds/dt)^2 at the nodes of a uniform grid of step h. In each interval u = d2s/dt2
//! changes linearly with s, from one value at its start to another at its end, so that
//! `x[i+1] = x[i] + h (u_start + u_end)`. The acceleration of joint j is `q'_j u + q''_j x`; its
//! limit leaves u a band at each node, which depends on x there. A sweep backwards finds how fast
//! the arm may be at each node and still slow down in time for all that follows; a sweep forwards
//! then goes as fast as that allows. "At least one joint is always running in saturation" is what comes
//! out: the fastest stamps on this grid.
//!
//! The two passes are those of TOPP-RA (Pham and Pham 2018). There u is constant in an interval and
//! both ends have to keep the limits, which wastes half of what the bounds change from node to node
//! and makes the time too long by a share of 1/N. With u linear the error falls with 1/N^2.
//!
//! Where q' changes its direction, as in a turn-back, a large x or u costs nothing at a node and much
//! next to it. Intervals that exceed a limit half-way are therefore tightened ([`forward`]), and swept
//! again.
//!
//! All numbers are in units of the limits: derivatives are divided by the joint's acceleration
//! limit, so that the limit is 1. The eighth of each row of eight is zero.

type Row = [f64; 8];

/// Above any x or u that a limit leaves.
const UNLIMITED: f64 = 1e30;

/// Share of a limit by which an interval may exceed it between its ends.
const SWING: f64 = 0.004;

/// What the limits leave at one node: x at most `cap`, and for each joint u within the band
/// `lower x - half` to `upper x + half`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Bounds {
    lower: Row,
    upper: Row,
    half: Row,
    cap: f64,
    /// Factor and summand of [`Bounds::largest_start`].
    start: [Row; 2],
    /// Factor and summand of [`Bounds::largest_end`].
    end: [Row; 2],
}

impl Bounds {
    /// `velocity` holds the acceleration limits over the velocity limits, in 1/s.
    #[inline(always)]
    fn new(dq: &Row, ddq: &Row, velocity: &Row, h: f64) -> Self {
        let mut speed = [0.0; 8];
        let (mut lower, mut upper, mut half) = ([0.0; 8], [0.0; 8], [0.0; 8]);
        for j in 0..8 {
            let (p, bend) = (dq[j].abs(), ddq[j].abs());
            // Where q' changes its sign next to the node, the limits at the node alone would leave x
            // and u free, and speed and acceleration beside it with them: q' of one and a half
            // intervals away bounds the one, of half an interval, in both directions, the other.
            let beside = 1.5 * h * bend;
            speed[j] = velocity[j] * if p < beside { beside } else { p };
            let nearby = 0.5 * h * bend;
            let turns = p < nearby;
            let inverse = 1.0 / (if turns { nearby } else { p }).max(1.0 / UNLIMITED);
            let slope = -ddq[j] * inverse.copysign(dq[j]);
            lower[j] = if turns { bend * inverse } else { slope };
            upper[j] = if turns { -bend * inverse } else { slope };
            half[j] = inverse;
        }
        let fastest = max(&speed);
        let cap = if fastest > 1e-15 { 1.0 / (fastest * fastest) } else { UNLIMITED };
        // x (1 + h lower) <= c + h half, and the same with upper; without a limit for a factor of 0.
        let (mut start, mut end) = ([[0.0; 8]; 2], [[0.0; 8]; 2]);
        for j in 0..8 {
            for (solved, factor) in
                [(&mut start, 1.0 + h * lower[j]), (&mut end, 1.0 - h * upper[j])]
            {
                let limits = factor > 1e-9;
                let inverse = if limits { 1.0 / factor } else { 0.0 };
                solved[0][j] = inverse;
                solved[1][j] = if limits { h * half[j] * inverse } else { UNLIMITED };
            }
        }
        Self { lower, upper, half, cap, start, end }
    }

    /// Largest u at `x`.
    #[inline(always)]
    fn most(&self, x: f64) -> f64 {
        let mut u = [0.0; 8];
        for j in 0..8 {
            u[j] = self.upper[j] * x + self.half[j];
        }
        min(&u)
    }

    /// Smallest u at `x`.
    #[inline(always)]
    fn least(&self, x: f64) -> f64 {
        let mut u = [0.0; 8];
        for j in 0..8 {
            u[j] = self.lower[j] * x - self.half[j];
        }
        max(&u)
    }

    /// Largest x, not above `x`, at which some u keeps all limits.
    ///
    /// The width of the band common to all joints is a concave function of x, made of straight
    /// pieces. Newton's method comes down on its root from the right, and ends after a few pieces.
    #[inline(always)]
    fn possible(&self, mut x: f64) -> f64 {
        const STEPS: usize = 64;
        for _ in 0..STEPS {
            let (mut most, mut least) = ([0.0; 8], [0.0; 8]);
            for j in 0..8 {
                most[j] = self.upper[j] * x + self.half[j];
                least[j] = self.lower[j] * x - self.half[j];
            }
            let (lowest, highest) = (min(&most), max(&least));
            // The slopes of the two that meet; of several, those to the left of x.
            let (mut rise, mut fall) = ([0.0; 8], [0.0; 8]);
            for j in 0..8 {
                rise[j] = if most[j] == lowest { self.upper[j] } else { -UNLIMITED };
                fall[j] = if least[j] == highest { self.lower[j] } else { UNLIMITED };
            }
            let (width, change) = (lowest - highest, max(&rise) - min(&fall));
            let lower = x - width / change;
            if width >= 0.0 || change >= 0.0 || lower >= x || lower <= 0.0 {
                break;
            }
            x = lower;
        }
        x
    }

    /// Largest x with `x + h least(x) <= c`.
    #[inline(always)]
    fn largest_start(&self, c: f64) -> f64 {
        let mut x = [0.0; 8];
        for j in 0..8 {
            x[j] = c * self.start[0][j] + self.start[1][j];
        }
        min(&x)
    }

    /// Largest x with `x - h most(x) <= c`.
    #[inline(always)]
    fn largest_end(&self, c: f64) -> f64 {
        let mut x = [0.0; 8];
        for j in 0..8 {
            x[j] = c * self.end[0][j] + self.end[1][j];
        }
        min(&x)
    }
}

/// An interval between two nodes.
#[derive(Clone, Copy)]
struct Interval<'a> {
    h: f64,
    /// Whether u has to be the same at both ends.
    even: bool,
    start: &'a Bounds,
    end: &'a Bounds,
}

impl Interval<'_> {
    /// Largest x at the start, not above `x`, from which something up to `end` is reached.
    ///
    /// The room between the smallest and the largest x reached is a concave function of x, and there
    /// is some at 0. A chord over its root meets zero before the root, where there still is room.
    #[inline(never)]
    fn search(&self, end: f64, x: f64) -> f64 {
        const STEPS: usize = 100;
        // The cap of velocities may be far above what accelerations allow.
        let x = self.start.possible(x);
        let room = |x: f64| {
            let (low, high) = self.reachable(x, end);
            high - low
        };
        let (mut high, mut lack) = (x, room(x));
        if lack >= 0.0 {
            return x;
        }
        let (mut low, mut spare) = (0.0, room(0.0));
        for step in 0..STEPS {
            if high - low <= 1e-14 * x || spare <= 0.0 {
                break;
            }
            let chord = low + (high - low) * spare / (spare - lack);
            let middle = if step % 2 == 1 { 0.5 * (low + high) } else { chord };
            let found = room(middle);
            if found >= 0.0 {
                (low, spare) = (middle, found);
            } else {
                (high, lack) = (middle, found);
            }
        }
        low
    }

    /// Smallest and largest x at the end, not above `cap`, that are reached from `x` at the start;
    /// none if the first is above the second.
    #[inline(never)]
    fn reachable(&self, x: f64, cap: f64) -> (f64, f64) {
        let (least, most) = (self.start.least(x), self.start.most(x));
        // With u the same at both ends, each end's band has to hold it alone, over both halves.
        let (h, brake, drive, mut low, mut high) = if self.even {
            let h = 2.0 * self.h;
            (h, x, x, x + h * least, (x + h * most).min(cap))
        } else {
            (self.h, x + self.h * least, x + self.h * most, 0.0, cap)
        };
        for j in 0..7 {
            // y - h (upper y + half) <= drive.
            let factor = 1.0 - h * self.end.upper[j];
            let half = h * self.end.half[j];
            if factor > 1e-9 {
                high = high.min((drive + half) / factor);
            }
            // y - h (lower y - half) >= brake.
            let factor = 1.0 - h * self.end.lower[j];
            if factor > 1e-9 {
                low = low.max((brake - half) / factor);
            } else if factor < -1e-9 {
                high = high.min((brake - half) / factor);
            }
        }
        (low.max(0.0), high)
    }
}

#[inline(always)]
fn min(values: &Row) -> f64 {
    fold(values, |a, b| if a < b { a } else { b })
}

#[inline(always)]
fn max(values: &Row) -> f64 {
    fold(values, |a, b| if a > b { a } else { b })
}

/// Halves the row until one number is left: each step is one vector instruction.
#[inline(always)]
fn fold(values: &Row, pick: impl Fn(f64, f64) -> f64) -> f64 {
    let mut v = *values;
    for half in [4, 2, 1] {
        for k in 0..half {
            v[k] = pick(v[k], v[k + half]);
        }
    }
    v[0]
}

/// A node of the sweep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// (ds/dt)^2, in 1/s^2.
    pub(crate) x: f64,
    /// d2s/dt2 at the start and at the end of the interval that begins here, in 1/s^2.
    pub(crate) u: [f64; 2],
    /// Whether u has to be the same at both ends of the interval that begins here.
    pub(crate) even: bool,
    /// Largest x here, beside what the limits at this node allow.
    pub(crate) x_max: f64,
}

impl Default for Sample {
    fn default() -> Self {
        Self { x: 0.0, u: [0.0; 2], even: false, x_max: UNLIMITED }
    }
}

/// What the limits leave at each node of a segment: fills `bounds`.
///
/// `dq` and `ddq` hold the derivatives at the nodes over the acceleration limits; `velocity` the
/// acceleration limits over the velocity limits, in 1/s.
#[inline(always)]
pub(crate) fn bounds(dq: &[Row], ddq: &[Row], velocity: &Row, bounds: &mut [Bounds]) {
    let h = 1.0 / (bounds.len() - 1) as f64;
    for ((dq, ddq), bounds) in dq.iter().zip(ddq).zip(bounds) {
        *bounds = Bounds::new(dq, ddq, velocity, h);
    }
}

/// The nodes of a segment, as [`backward`] and [`forward`] take them; all slices are as long.
#[derive(Clone, Copy)]
pub(crate) struct Nodes<'a> {
    pub(crate) dq: &'a [Row],
    pub(crate) ddq: &'a [Row],
    pub(crate) velocity: &'a Row,
    pub(crate) bounds: &'a [Bounds],
}

/// Sets the `x` of `samples` to the largest at each node from which all that follows can be kept,
/// given the largest x at the last node.
#[inline(always)]
pub(crate) fn backward(nodes: Nodes<'_>, end: f64, samples: &mut [Sample]) {
    let Nodes { dq, ddq, velocity, bounds } = nodes;
    let n = samples.len() - 1;
    let h = 1.0 / n as f64;
    let calm = calm(ddq, h);
    let next = &bounds[n];
    let mut x = next.possible(next.cap.min(end).min(samples[n].x_max));
    let (mut next_least, mut next_most) = (next.least(x), next.most(x));
    samples[n].x = x;
    for i in (0..n).rev() {
        let (start, next) = (&bounds[i], &bounds[i + 1]);
        let cap = start.cap.min(samples[i].x_max);
        let interval = Interval { h, even: samples[i].even, start, end: next };
        let end = x;
        let brake = end - h * next_least;
        // Arriving at `end` while speeding up is strange: arriving slower may allow for more.
        let strange = interval.even || brake < 0.5 * end;
        x = start.largest_start(brake).min(cap);
        let (mut least, mut most) = (start.least(x), start.most(x));
        if least > most && !strange {
            x = start.possible(x);
            (least, most) = (start.least(x), start.most(x));
        }
        let drive = x + h * most;
        let arrives = end - h * next_most <= drive;
        let swings = || {
            let u = split((end - x) / h, [least, most], [next_least, next_most]);
            (u[1] - u[0]).abs() > calm
                && half_way(&dq[i..i + 2], &ddq[i..i + 2], velocity, h, x, u).0 > 1.0 + SWING
        };
        let found = if strange || x < 0.0 {
            Some(interval.search(end, cap))
        } else if !arrives {
            // Out of reach: it will arrive slower, and has to be able to.
            let slower = next.largest_end(drive);
            let able = slower - h * next.least(slower) >= x + h * least;
            (!able).then(|| interval.search(end, x))
        } else if swings() {
            samples[i].even = true;
            Some(Interval { even: true, ..interval }.search(end, x))
        } else {
            None
        };
        if let Some(found) = found {
            x = found;
            (least, most) = (start.least(x), start.most(x));
        }
        samples[i].x = x;
        (next_least, next_most) = (least, most);
    }
}

/// Lowers the `x` of `samples`, as [`backward`] left it, to what is reached from `start` at the
/// first node, and finds u.
///
/// Where a joint exceeds a limit half-way, the interval is tightened: u has to be the same at both
/// ends, or x lower. True if there are any for which that has to be swept again.
#[inline(always)]
fn forward(nodes: Nodes<'_>, start: f64, samples: &mut [Sample]) -> bool {
    let Nodes { dq, ddq, velocity, bounds } = nodes;
    let n = samples.len() - 1;
    let h = 1.0 / n as f64;
    let mut tightened = false;
    let mut x = samples[0].x.min(start);
    let (mut least, mut most) = (bounds[0].least(x), bounds[0].most(x));
    samples[0].x = x;
    for i in 0..n {
        let next = &bounds[i + 1];
        let even = samples[i].even;
        let interval = Interval { h, even, start: &bounds[i], end: next };
        let cap = samples[i + 1].x;
        let half_way = |u| half_way(&dq[i..i + 2], &ddq[i..i + 2], velocity, h, x, u);
        let mut y = next.largest_end(x + h * most).min(cap).max(0.0);
        let mut next_least = next.least(y);
        if even || y - h * next_least < x + h * least - 1e-12 * x {
            y = interval.reachable(x, cap).1.max(0.0);
            next_least = next.least(y);
        }
        let mut next_most = next.most(y);
        let sum = (y - x) / h;
        let mut u =
            if even { [0.5 * sum; 2] } else { split(sum, [least, most], [next_least, next_most]) };
        let (mut acceleration, mut square) = half_way(u);
        if acceleration > 1.0 + SWING {
            // On the way up it can often be mended here: arriving slower, with u the same.
            let (low, high) = Interval { even: true, ..interval }.reachable(x, cap);
            if !even && low <= high {
                (y, u) = (high, [0.5 * (high - x) / h; 2]);
                (next_least, next_most) = (next.least(y), next.most(y));
                (acceleration, square) = half_way(u);
            }
            samples[i].even = true;
        }
        samples[i].u = u;
        samples[i + 1].x = y;
        if square > 1.0 + SWING {
            samples[i].x_max = x / square;
            samples[i + 1].x_max = y / square;
            tightened = true;
        }
        if acceleration > 1.0 + SWING {
            if even {
                samples[i].x_max = x / acceleration;
                samples[i + 1].x_max = y / acceleration;
            }
            tightened = true;
        }
        (x, least, most) = (y, next_least, next_most);
    }
    tightened
}

/// A change of u within an interval that is too small to exceed a limit half-way: the acceleration
/// there differs from the mean of the ends by no more than `h |q''| |change| / 2`.
#[inline(always)]
fn calm(ddq: &[Row], h: f64) -> f64 {
    let mut bend = [0.0; 8];
    for row in ddq {
        for j in 0..8 {
            let value = row[j].abs();
            bend[j] = if value > bend[j] { value } else { bend[j] };
        }
    }
    2.0 * SWING / (h * max(&bend)).max(1.0 / UNLIMITED)
}

/// What one interval is at half-way: the largest share of an acceleration limit, and the largest
/// squared share of a velocity limit.
#[inline(always)]
fn half_way(dq: &[Row], ddq: &[Row], velocity: &Row, h: f64, x: f64, u: [f64; 2]) -> (f64, f64) {
    let u_half = 0.5 * (u[0] + u[1]);
    let x_half = x + h * (0.75 * u[0] + 0.25 * u[1]);
    let (mut acceleration, mut speed) = ([0.0; 8], [0.0; 8]);
    for j in 0..8 {
        // Of the cubic with the same values of q' and q'' at both ends.
        let rise = dq[1][j] - dq[0][j];
        let p = dq[0][j] + 0.5 * rise + 0.125 * h * (ddq[0][j] - ddq[1][j]);
        let r = 1.5 * rise / h - 0.25 * (ddq[0][j] + ddq[1][j]);
        acceleration[j] = (p * u_half + r * x_half).abs();
        speed[j] = p.abs() * velocity[j];
    }
    let speed = max(&speed);
    (max(&acceleration), speed * speed * x_half)
}

/// Sweeps forwards until no interval of the segment has to be tightened, and backwards in between.
/// False if that makes what came before the segment too fast: then all has to be swept again.
#[inline(always)]
pub(crate) fn settle(nodes: Nodes<'_>, start: f64, samples: &mut [Sample]) -> bool {
    const ROUNDS: usize = 30;
    let end = samples[samples.len() - 1].x;
    for _ in 0..ROUNDS {
        if samples[0].x < start * (1.0 - 1e-12) {
            return false;
        }
        if !forward(nodes, start, samples) {
            return true;
        }
        backward(nodes, end, samples);
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
