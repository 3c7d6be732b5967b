//! Planned path as a curve through the nodes of its trajectory.

use iiwa_kin::{
    Joints, hermite,
    vector::{add_scaled, dot, norm, scale, sub},
};
use iiwa_log::PlanNode;

/// Piecewise polynomial between nodes: of degree five with continuous position, velocity and
/// acceleration, as in jerk-limited plans; or cubic without the acceleration, if it jumps.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    knots: Vec<PlanNode>,
    /// Chord length up to each node, in rad.
    arc_rad: Vec<f64>,
    smooth: bool,
}

/// Point on the curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CurvePoint {
    /// Interval between nodes.
    pub(crate) interval: usize,
    /// Planned time, in s.
    pub(crate) t_s: f64,
    /// Length up to the point, in rad.
    pub(crate) arc_rad: f64,
    /// Distance of the query from the point, in rad.
    pub(crate) distance_rad: f64,
}

/// Number of steps after which a root is exact to the last digit.
const STEPS: usize = 80;

impl Curve {
    /// Creates the curve through at least two nodes in increasing time; `smooth` if the
    /// acceleration is continuous.
    pub(crate) fn new(knots: Vec<PlanNode>, smooth: bool) -> Self {
        let mut arc = 0.0;
        let mut arc_rad = Vec::with_capacity(knots.len());
        arc_rad.push(0.0);
        for pair in knots.windows(2) {
            arc += norm(&sub(&pair[1].q, &pair[0].q));
            arc_rad.push(arc);
        }
        Self { knots, arc_rad, smooth }
    }

    pub(crate) fn knots(&self) -> &[PlanNode] {
        &self.knots
    }

    pub(crate) fn intervals(&self) -> usize {
        self.knots.len() - 1
    }

    /// Returns the length up to a node, in rad.
    pub(crate) fn arc(&self, knot: usize) -> f64 {
        self.arc_rad[knot]
    }

    /// Returns the total length, in rad.
    pub(crate) fn length(&self) -> f64 {
        self.arc_rad[self.knots.len() - 1]
    }

    /// Returns the interval that contains a time.
    pub(crate) fn interval_at(&self, t_s: f64) -> usize {
        self.knots.partition_point(|knot| knot.t_s <= t_s).clamp(1, self.knots.len() - 1) - 1
    }

    /// Returns the interval that contains a length.
    pub(crate) fn interval_at_arc(&self, arc_rad: f64) -> usize {
        self.arc_rad.partition_point(|arc| *arc <= arc_rad).clamp(1, self.knots.len() - 1) - 1
    }

    /// Returns the length up to a time, in rad.
    pub(crate) fn arc_at(&self, t_s: f64) -> f64 {
        let interval = self.interval_at(t_s);
        let q = self.in_interval(interval, t_s).0;
        self.arc_rad[interval] + norm(&sub(&q, &self.knots[interval].q))
    }

    /// Returns the position at a length.
    pub(crate) fn at_arc(&self, arc_rad: f64) -> Joints {
        let interval = self.interval_at_arc(arc_rad);
        let (a, b) = (&self.knots[interval], &self.knots[interval + 1]);
        let length = self.arc_rad[interval + 1] - self.arc_rad[interval];
        if length <= 0.0 {
            return a.q;
        }
        let unit = scale(1.0 / length, &sub(&b.q, &a.q));
        let x = self.along(interval, &unit).solve(arc_rad - self.arc_rad[interval]);
        self.in_interval(interval, a.t_s + x * (b.t_s - a.t_s)).0
    }

    /// Returns position and velocity at a time.
    pub(crate) fn at(&self, t_s: f64) -> (Joints, Joints) {
        self.in_interval(self.interval_at(t_s), t_s)
    }

    /// Returns position and velocity at a time in a known interval.
    pub(crate) fn in_interval(&self, interval: usize, t_s: f64) -> (Joints, Joints) {
        let (a, b) = (&self.knots[interval], &self.knots[interval + 1]);
        let h = b.t_s - a.t_s;
        let x = ((t_s - a.t_s) / h).clamp(0.0, 1.0);
        let mut state = ([0.0; 7], [0.0; 7]);
        for j in 0..7 {
            let ends = [a, b].map(|knot| [knot.q[j], knot.dq[j], knot.ddq[j]]);
            let polynomial = UnitPolynomial::new(ends[0], ends[1], h, self.smooth);
            (state.0[j], state.1[j]) = (polynomial.at(x), polynomial.slope(x) / h);
        }
        state
    }

    /// Returns the displacement along a direction in an interval, from its first node.
    fn along(&self, interval: usize, unit: &Joints) -> UnitPolynomial {
        let (a, b) = (&self.knots[interval], &self.knots[interval + 1]);
        let ends =
            [a, b].map(|k| [dot(&sub(&k.q, &a.q), unit), dot(&k.dq, unit), dot(&k.ddq, unit)]);
        UnitPolynomial::new(ends[0], ends[1], b.t_s - a.t_s, self.smooth)
    }

    /// Returns the squared distance of `q` from the chord of an interval, beyond the length
    /// `from_rad`, and the position of the nearest point along the chord.
    pub(crate) fn to_chord(&self, interval: usize, q: &Joints, from_rad: f64) -> (f64, f64) {
        let (a, b) = (&self.knots[interval], &self.knots[interval + 1]);
        let (chord, to) = (sub(&b.q, &a.q), sub(q, &a.q));
        let length = self.arc_rad[interval + 1] - self.arc_rad[interval];
        if length <= 0.0 {
            return (dot(&to, &to), 0.0);
        }
        let start = (from_rad - self.arc_rad[interval]).max(0.0).min(length);
        let along = (dot(&to, &chord) / length).clamp(start, length);
        let off = add_scaled(&to, -along / length, &chord);
        (dot(&off, &off), along)
    }

    /// Returns the point of an interval nearest to `q`, given its approximate position along the
    /// chord.
    pub(crate) fn refine(&self, interval: usize, q: &Joints, along_rad: f64) -> CurvePoint {
        let (a, b) = (&self.knots[interval], &self.knots[interval + 1]);
        let h = b.t_s - a.t_s;
        let length = self.arc_rad[interval + 1] - self.arc_rad[interval];
        let mut x = 0.0;
        if length > 0.0 {
            let unit = scale(1.0 / length, &sub(&b.q, &a.q));
            x = self.along(interval, &unit).solve(along_rad);
        }
        // On a blend, the nearest point of the curve is not exactly above that of its chord.
        let mut t_s = a.t_s + x * h;
        let (mut position, mut v) = self.in_interval(interval, t_s);
        for _ in 0..3 {
            let speed = dot(&v, &v);
            let slow = 1e-2 * length / h;
            let ahead = dot(&sub(q, &position), &v);
            if x <= 0.0 || x >= 1.0 || speed <= slow * slow || ahead.abs() <= 1e-15 * speed * h {
                break;
            }
            t_s = (t_s + (ahead / speed).clamp(-0.25 * h, 0.25 * h)).clamp(a.t_s, b.t_s);
            (position, v) = self.in_interval(interval, t_s);
        }
        CurvePoint {
            interval,
            t_s,
            arc_rad: self.arc_rad[interval] + norm(&sub(&position, &a.q)).min(length),
            distance_rad: norm(&sub(q, &position)),
        }
    }

    /// Returns the time at which the plan, forwards or backwards from `knot`, has moved by
    /// `along_rad` in the direction `unit`; none if the path turns away before.
    pub(crate) fn time_along(
        &self,
        knot: usize,
        forward: bool,
        unit: &Joints,
        along_rad: f64,
    ) -> Option<f64> {
        let origin = self.knots[knot].q;
        let mut knot_index = knot;
        let mut distance_rad = 0.0;
        loop {
            let next = if forward { knot_index + 1 } else { knot_index.checked_sub(1)? };
            let to = dot(&sub(&self.knots.get(next)?.q, &origin), unit);
            let (first, second) = if forward { (knot_index, next) } else { (next, knot_index) };
            if (to - distance_rad).abs() <= 0.0 && knot_index != knot {
                return None;
            }
            // Beyond a turn of 8 degrees, the displacement along the direction is no longer a
            // measure of the way.
            let chord = self.arc_rad[second] - self.arc_rad[first];
            if (to - distance_rad).abs() < 0.99 * chord {
                return None;
            }
            if (along_rad - distance_rad) * (along_rad - to) <= 0.0 {
                let (a, b) = (&self.knots[first], &self.knots[second]);
                let h = b.t_s - a.t_s;
                let from = if forward { distance_rad } else { to };
                return Some(a.t_s + h * self.along(first, unit).solve(along_rad - from));
            }
            (knot_index, distance_rad) = (next, to);
        }
    }
}

/// Polynomial over 0..=1, lowest power first.
struct UnitPolynomial([f64; 6]);

impl UnitPolynomial {
    /// Creates the polynomial with the given positions, velocities and, if smooth, accelerations at
    /// both ends.
    fn new(a: [f64; 3], b: [f64; 3], h: f64, smooth: bool) -> Self {
        let [a, b] = [a, b].map(|[q, dq, ddq]| [q, h * dq, h * h * ddq]);
        if smooth {
            return Self(hermite::quintic(a, b));
        }
        let [c0, c1, c2, c3] = hermite::cubic([a[0], a[1]], [b[0], b[1]]);
        Self([c0, c1, c2, c3, 0.0, 0.0])
    }

    fn at(&self, x: f64) -> f64 {
        hermite::value(&self.0, x)
    }

    fn slope(&self, x: f64) -> f64 {
        hermite::slope(&self.0, x)
    }

    /// Finds the argument of a value between those at the ends, by Newton's method within a
    /// bracket.
    fn solve(&self, value: f64) -> f64 {
        let (first, last) = (self.at(0.0), self.at(1.0));
        let sign = (last - first).signum();
        let miss = |x: f64| sign * (self.at(x) - value);
        if last == first || miss(0.0) >= 0.0 {
            return 0.0;
        }
        if miss(1.0) <= 0.0 {
            return 1.0;
        }
        let (mut low, mut high) = (0.0, 1.0);
        let mut x = ((value - first) / (last - first)).clamp(0.0, 1.0);
        for _ in 0..STEPS {
            let f = miss(x);
            if f == 0.0 {
                break;
            }
            if f > 0.0 {
                high = x;
            } else {
                low = x;
            }
            let newton = x - f / (sign * self.slope(x));
            if (newton - x).abs() <= 1e-15 * x {
                break;
            }
            x = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        }
        x
    }
}
