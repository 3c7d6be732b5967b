//! The sweep over the samples of a curved segment (Larsen 2019, section 2.4.1).
//!
//! Unknown is x = (ds/dt)^2 at the nodes of a uniform grid of step h. In each interval u = d2s/dt2
//! changes linearly with s, from one value at its start to another at its end, so that
//! `x[i+1] = x[i] + h (u_start + u_end)`. The acceleration of joint j is `q'_j u + q''_j x`; its
//! limit leaves u a band at each node, which depends on x there. A sweep backwards finds how fast
//! the arm may be at each node and still slow down in time for all that follows; a sweep forwards
//! then goes as fast as that allows. "At least one joint is always in saturation" is what comes
//! out: the fastest stamps on this grid.
//!
//! The two passes are those of TOPP-RA (Pham and Pham 2018). There u is constant in an interval and
//! both ends have to keep the limits, which wastes half of what the bounds change from node to node
//! and makes the time too long by a share of 1/N. With u linear the error falls with 1/N^2.
//!
//! All numbers are in units of the limits: derivatives are divided by the joint's acceleration
//! limit, so that the limit is 1. The eighth of each row of eight is zero.

type Row = [f64; 8];

/// Above any x or u that a limit leaves.
const UNLIMITED: f64 = 1e30;

/// What the limits leave at one node: x at most `cap`, and for each joint u within the band
/// `slope x - half` to `slope x + half`.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    slope: Row,
    half: Row,
    cap: f64,
}

impl Bounds {
    /// `velocity` holds the acceleration limits over the velocity limits, in 1/s.
    #[inline(always)]
    fn new(dq: &Row, ddq: &Row, velocity: &Row, intervals: f64) -> Self {
        let mut speed = [0.0; 8];
        for j in 0..8 {
            speed[j] = dq[j].abs() * velocity[j];
        }
        let fastest = max(&speed);
        let cap = if fastest > 1e-15 { 1.0 / (fastest * fastest) } else { UNLIMITED };
        // A joint that hardly moves with s leaves u free; it still limits x.
        let hardly = 1e-10 / (cap * intervals);
        let (mut slope, mut half, mut caps) = ([0.0; 8], [0.0; 8], [0.0; 8]);
        for j in 0..8 {
            let inverse = 1.0 / dq[j];
            let free = dq[j].abs() <= hardly;
            slope[j] = if free { 0.0 } else { -ddq[j] * inverse };
            half[j] = if free { UNLIMITED } else { inverse.abs() };
            let bend = ddq[j].abs();
            caps[j] = if free && bend * cap > 1.0 { 1.0 / bend } else { cap };
        }
        let mut bounds = Self { slope, half, cap: min(&caps) };
        if bounds.least(bounds.cap) > bounds.most(bounds.cap) {
            bounds.lower_cap();
        }
        bounds
    }

    /// Largest u at `x`.
    #[inline(always)]
    fn most(&self, x: f64) -> f64 {
        let mut u = [0.0; 8];
        for j in 0..8 {
            u[j] = self.slope[j] * x + self.half[j];
        }
        min(&u)
    }

    /// Smallest u at `x`.
    #[inline(always)]
    fn least(&self, x: f64) -> f64 {
        let mut u = [0.0; 8];
        for j in 0..8 {
            u[j] = self.slope[j] * x - self.half[j];
        }
        max(&u)
    }

    /// Lowers the cap to the largest x at which some u keeps all limits.
    ///
    /// The width of the band common to all joints is a concave function of x, made of straight
    /// pieces. Newton's method comes down on its root from the right, and ends after a few pieces.
    #[inline(never)]
    fn lower_cap(&mut self) {
        const STEPS: usize = 64;
        for _ in 0..STEPS {
            let x = self.cap;
            let (mut most, mut least) = ((f64::INFINITY, 0.0), (f64::NEG_INFINITY, 0.0));
            for j in 0..7 {
                let (slope, half) = (self.slope[j], self.half[j]);
                if slope * x + half < most.0 {
                    most = (slope * x + half, slope);
                }
                if slope * x - half > least.0 {
                    least = (slope * x - half, slope);
                }
            }
            let (width, change) = (most.0 - least.0, most.1 - least.1);
            let lower = x - width / change;
            if width >= 0.0 || change >= 0.0 || lower >= x || lower <= 0.0 {
                return;
            }
            self.cap = lower;
        }
    }

    /// Largest x with `x + h least(x) <= c`.
    #[inline(always)]
    fn largest_start(&self, h: f64, c: f64) -> f64 {
        let mut x = [0.0; 8];
        for j in 0..8 {
            let factor = 1.0 + h * self.slope[j];
            let bound = (c + h * self.half[j]) / factor;
            x[j] = if factor > 1e-9 { bound } else { UNLIMITED };
        }
        min(&x)
    }

    /// Largest x with `x - h most(x) <= c`.
    #[inline(always)]
    fn largest_end(&self, h: f64, c: f64) -> f64 {
        let mut x = [0.0; 8];
        for j in 0..8 {
            let factor = 1.0 - h * self.slope[j];
            let bound = (c + h * self.half[j]) / factor;
            x[j] = if factor > 1e-9 { bound } else { UNLIMITED };
        }
        min(&x)
    }

    /// Largest `y - h least(y)` for y up to `end`: a concave function of y.
    #[inline(never)]
    fn best_end(&self, h: f64, end: f64) -> f64 {
        let value = |y: f64| y - h * self.least(y);
        let (mut low, mut high) = (0.0, end);
        for _ in 0..100 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if value(a) < value(b) { low = a } else { high = b }
        }
        value(0.5 * (low + high))
    }
}

/// Largest x at the start of an interval, not above the start's cap, from which `end` or less is
/// reached at its end.
#[inline(always)]
fn back_step(h: f64, start: &Bounds, next: &Bounds, end: f64) -> f64 {
    let mut brake = end - h * next.least(end);
    if brake < 0.5 * end {
        // Arriving at `end` would take speeding up: arriving slower may allow for more.
        brake = next.best_end(h, end);
    }
    let x = start.largest_start(h, brake).min(start.cap);
    let drive = x + h * start.most(x);
    if end - h * next.most(end) <= drive {
        return x;
    }
    // `end` is out of reach: it will arrive slower, and has to be able to.
    let arrive = next.largest_end(h, drive);
    if arrive - h * next.least(arrive) >= x + h * start.least(x) {
        return x;
    }
    squeeze(h, start, next, end, x)
}

/// [`back_step`] where the limits leave next to nothing. What is possible from one x is possible
/// from any smaller one, in proportion.
#[inline(never)]
fn squeeze(h: f64, start: &Bounds, next: &Bounds, end: f64, x: f64) -> f64 {
    let possible = |x: f64| {
        let arrive = next.largest_end(h, x + h * start.most(x)).min(end);
        arrive - h * next.least(arrive) >= x + h * start.least(x)
    };
    let (mut low, mut high) = (0.0, x);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if possible(middle) { low = middle } else { high = middle }
    }
    low
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
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sample {
    /// (ds/dt)^2, in 1/s^2.
    pub(crate) x: f64,
    /// d2s/dt2 at the start and at the end of the interval that begins here, in 1/s^2.
    pub(crate) u: [f64; 2],
}

/// Sets the `x` of `samples` to the largest at each node from which all that follows can be kept,
/// given the largest x at the last node.
///
/// `dq` and `ddq` hold the derivatives at the nodes over the acceleration limits; `velocity` the
/// acceleration limits over the velocity limits, in 1/s.
#[inline(always)]
pub(crate) fn backward(
    dq: &[Row],
    ddq: &[Row],
    velocity: &Row,
    end: f64,
    samples: &mut [Sample],
) {
    let n = samples.len() - 1;
    let intervals = n as f64;
    let h = 1.0 / intervals;
    let mut next = Bounds::new(&dq[n], &ddq[n], velocity, intervals);
    let mut x = next.cap.min(end);
    samples[n].x = x;
    for i in (0..n).rev() {
        let bounds = Bounds::new(&dq[i], &ddq[i], velocity, intervals);
        x = back_step(h, &bounds, &next, x);
        samples[i].x = x;
        next = bounds;
    }
}

/// Lowers the `x` of `samples`, as [`backward`] left it, to what is reached from `start` at the
/// first node, and finds u.
#[inline(always)]
pub(crate) fn forward(
    dq: &[Row],
    ddq: &[Row],
    velocity: &Row,
    start: f64,
    samples: &mut [Sample],
) {
    let n = samples.len() - 1;
    let intervals = n as f64;
    let h = 1.0 / intervals;
    let bounds = Bounds::new(&dq[0], &ddq[0], velocity, intervals);
    let mut x = samples[0].x.min(start);
    let (mut least, mut most) = (bounds.least(x), bounds.most(x));
    samples[0].x = x;
    for i in 0..n {
        let next = Bounds::new(&dq[i + 1], &ddq[i + 1], velocity, intervals);
        let y = next.largest_end(h, x + h * most).min(samples[i + 1].x).max(0.0);
        let (next_least, next_most) = (next.least(y), next.most(y));
        // The same u at both ends where the limits leave the choice.
        let sum = (y - x) * intervals;
        let u_start = within(0.5 * sum, least, most);
        let u_end = within(sum - u_start, next_least, next_most);
        samples[i].u = [sum - u_end, u_end];
        samples[i + 1].x = y;
        (x, least, most) = (y, next_least, next_most);
    }
}

/// `value`, moved into `low` to `high`; unlike `clamp`, whatever the order of the two.
#[inline(always)]
fn within(value: f64, low: f64, high: f64) -> f64 {
    let value = if value < low { low } else { value };
    if value > high { high } else { value }
}
