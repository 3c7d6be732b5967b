//! The planned path as a curve through the nodes of its trajectory.

use iiwa_kin::Joints;

use super::vector::{add_scaled, dot, norm, scale, sub};

/// Where the arm is to be at a time, and how fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Knot {
    pub(crate) t_s: f64,
    pub(crate) q: Joints,
    pub(crate) dq: Joints,
}

/// A cubic between each two nodes that meets position and velocity at both: exact where the plan has
/// constant jerk or acceleration along a line.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    knots: Vec<Knot>,
    /// Length of the chords up to each node, in rad.
    arc_rad: Vec<f64>,
}

/// A place on the curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    /// Interval between nodes.
    pub(crate) interval: usize,
    /// When the plan is there, in s.
    pub(crate) t_s: f64,
    /// Length up to there, in rad.
    pub(crate) arc_rad: f64,
    /// How far what was looked for is away, in rad.
    pub(crate) distance_rad: f64,
}

/// Steps after which a root is known to the last digit.
const STEPS: usize = 80;

impl Curve {
    /// The curve through some nodes, of which there are at least two, later and later.
    pub(crate) fn new(knots: Vec<Knot>) -> Self {
        let mut arc = 0.0;
        let mut arc_rad = Vec::with_capacity(knots.len());
        arc_rad.push(0.0);
        for pair in knots.windows(2) {
            arc += norm(&sub(&pair[1].q, &pair[0].q));
            arc_rad.push(arc);
        }
        Self { knots, arc_rad }
    }

    pub(crate) fn knots(&self) -> &[Knot] {
        &self.knots
    }

    pub(crate) fn intervals(&self) -> usize {
        self.knots.len() - 1
    }

    /// Length up to a node, in rad.
    pub(crate) fn arc(&self, knot: usize) -> f64 {
        self.arc_rad[knot]
    }

    /// Length of all of it, in rad.
    pub(crate) fn length(&self) -> f64 {
        self.arc_rad[self.knots.len() - 1]
    }

    /// The interval that a time is in.
    pub(crate) fn interval_at(&self, t_s: f64) -> usize {
        self.knots.partition_point(|knot| knot.t_s <= t_s).clamp(1, self.knots.len() - 1) - 1
    }

    /// The interval that a length is in.
    pub(crate) fn interval_at_arc(&self, arc_rad: f64) -> usize {
        self.arc_rad.partition_point(|arc| *arc <= arc_rad).clamp(1, self.knots.len() - 1) - 1
    }

    /// Length up to a time, in rad.
    pub(crate) fn arc_at(&self, t_s: f64) -> f64 {
        let interval = self.interval_at(t_s);
        let q = self.in_interval(interval, t_s).0;
        self.arc_rad[interval] + norm(&sub(&q, &self.knots[interval].q))
    }

    /// Position and velocity at a time.
    pub(crate) fn at(&self, t_s: f64) -> (Joints, Joints) {
        self.in_interval(self.interval_at(t_s), t_s)
    }

    /// The same, in an interval that is known.
    pub(crate) fn in_interval(&self, interval: usize, t_s: f64) -> (Joints, Joints) {
        let (a, b) = (&self.knots[interval], &self.knots[interval + 1]);
        let h = b.t_s - a.t_s;
        let x = ((t_s - a.t_s) / h).clamp(0.0, 1.0);
        let q = std::array::from_fn(|j| Cubic::new(a, b, h, j).at(x));
        let dq = std::array::from_fn(|j| Cubic::new(a, b, h, j).slope(x) / h);
        (q, dq)
    }

    /// How far `q` is from the chord of an interval, beginning at the length `from_rad`, squared;
    /// and how far along the chord the nearest point is.
    pub(crate) fn to_chord(&self, interval: usize, q: &Joints, from_rad: f64) -> (f64, f64) {
        let (a, b) = (&self.knots[interval], &self.knots[interval + 1]);
        let (chord, to) = (sub(&b.q, &a.q), sub(q, &a.q));
        let length = self.arc_rad[interval + 1] - self.arc_rad[interval];
        if length <= 0.0 {
            return (dot(&to, &to), 0.0);
        }
        let least = (from_rad - self.arc_rad[interval]).max(0.0).min(length);
        let along = (dot(&to, &chord) / length).clamp(least, length);
        let off = add_scaled(&to, -along / length, &chord);
        (dot(&off, &off), along)
    }

    /// The place in an interval that is nearest to `q`, given how far along the chord it is about.
    pub(crate) fn refine(&self, interval: usize, q: &Joints, along_rad: f64) -> Place {
        let (a, b) = (&self.knots[interval], &self.knots[interval + 1]);
        let h = b.t_s - a.t_s;
        let length = self.arc_rad[interval + 1] - self.arc_rad[interval];
        let mut x = 0.0;
        if length > 0.0 {
            let unit = scale(1.0 / length, &sub(&b.q, &a.q));
            x = Cubic::along(a, b, h, &unit).solve(along_rad);
        }
        // On a blend the nearest point of the curve is not above that of its chord.
        let mut t_s = a.t_s + x * h;
        let (mut at, mut v) = self.in_interval(interval, t_s);
        for _ in 0..3 {
            let speed = dot(&v, &v);
            let slow = 1e-2 * length / h;
            let ahead = dot(&sub(q, &at), &v);
            if x <= 0.0 || x >= 1.0 || speed <= slow * slow || ahead.abs() <= 1e-15 * speed * h {
                break;
            }
            t_s = (t_s + (ahead / speed).clamp(-0.25 * h, 0.25 * h)).clamp(a.t_s, b.t_s);
            (at, v) = self.in_interval(interval, t_s);
        }
        Place {
            interval,
            t_s,
            arc_rad: self.arc_rad[interval] + norm(&sub(&at, &a.q)).min(length),
            distance_rad: norm(&sub(q, &at)),
        }
    }

    /// When the plan, from `from_s` on (or before it), has gone `along_rad` in the direction `unit`;
    /// none if it turns away before.
    pub(crate) fn time_along(
        &self,
        knot: usize,
        forward: bool,
        unit: &Joints,
        along_rad: f64,
    ) -> Option<f64> {
        let origin = self.knots[knot].q;
        let mut at = knot;
        let mut gone = 0.0;
        loop {
            let next = if forward { at + 1 } else { at.checked_sub(1)? };
            let to = dot(&sub(&self.knots.get(next)?.q, &origin), unit);
            let (first, second) = if forward { (at, next) } else { (next, at) };
            if (to - gone).abs() <= 0.0 && at != knot {
                return None;
            }
            // Turned by 8 degrees, the direction is no measure of the way any more.
            let chord = self.arc_rad[second] - self.arc_rad[first];
            if (to - gone).abs() < 0.99 * chord {
                return None;
            }
            if (along_rad - gone) * (along_rad - to) <= 0.0 {
                let (a, b) = (&self.knots[first], &self.knots[second]);
                let h = b.t_s - a.t_s;
                let from = if forward { gone } else { to };
                return Some(a.t_s + h * Cubic::along(a, b, h, unit).solve(along_rad - from));
            }
            (at, gone) = (next, to);
        }
    }
}

/// A cubic over 0..=1 that is 0 at 0.
struct Cubic {
    /// At 0.
    start: f64,
    /// How much it rises.
    rise: f64,
    slopes: [f64; 2],
}

impl Cubic {
    fn new(a: &Knot, b: &Knot, h: f64, joint: usize) -> Self {
        Self {
            start: a.q[joint],
            rise: b.q[joint] - a.q[joint],
            slopes: [h * a.dq[joint], h * b.dq[joint]],
        }
    }

    /// Of the way along a direction, from the first node on.
    fn along(a: &Knot, b: &Knot, h: f64, unit: &Joints) -> Self {
        Self {
            start: 0.0,
            rise: dot(&sub(&b.q, &a.q), unit),
            slopes: [h * dot(&a.dq, unit), h * dot(&b.dq, unit)],
        }
    }

    fn at(&self, x: f64) -> f64 {
        let [m0, m1] = self.slopes;
        let (c2, c3) = (3.0 * self.rise - 2.0 * m0 - m1, m0 + m1 - 2.0 * self.rise);
        self.start + x * (m0 + x * (c2 + x * c3))
    }

    fn slope(&self, x: f64) -> f64 {
        let [m0, m1] = self.slopes;
        let (c2, c3) = (3.0 * self.rise - 2.0 * m0 - m1, m0 + m1 - 2.0 * self.rise);
        m0 + x * (2.0 * c2 + x * 3.0 * c3)
    }

    /// Where it has a value between those at its ends: Newton's method, kept in a bracket.
    fn solve(&self, value: f64) -> f64 {
        if self.rise == 0.0 {
            return 0.0;
        }
        let sign = self.rise.signum();
        let miss = |x: f64| sign * (self.at(x) - value);
        if miss(0.0) >= 0.0 {
            return 0.0;
        }
        if miss(1.0) <= 0.0 {
            return 1.0;
        }
        let (mut low, mut high) = (0.0, 1.0);
        let mut x = ((value - self.start) / self.rise).clamp(0.0, 1.0);
        for _ in 0..STEPS {
            let f = miss(x);
            if f > 0.0 {
                high = x
            } else {
                low = x
            }
            let newton = x - f / (sign * self.slope(x));
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - x).abs() <= 1e-15 * next.abs() || f == 0.0 {
                return next;
            }
            x = next;
        }
        x
    }
}
