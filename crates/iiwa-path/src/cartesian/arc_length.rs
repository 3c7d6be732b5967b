//! Curves of the TCP with the arc length as their parameter.

use iiwa_kin::{
    Number, Taylor,
    rotation::{Vec3, dot, norm},
};

use super::quintic::Quintic;

/// A part of a spline's position between two knots, by the share of its arc length.
#[derive(Clone, Debug)]
pub(crate) struct ArcLengthCurve {
    shape: Shape,
    /// Ends of intervals in x and the arc lengths up to there, in m.
    nodes: Vec<Node>,
}

/// A place on a curve: the parameter of its shape and the arc length up to there, in m.
#[derive(Clone, Copy, Debug)]
struct Node {
    x: f64,
    length_m: f64,
}

/// A polynomial curve by a parameter x from 0 to 1 in which its tangent is not zero.
#[derive(Clone, Debug)]
struct Shape {
    curve: Quintic<3>,
    /// The end where the TCP reverses.
    cusp: Option<Cusp>,
}

/// The end of a curve where its first derivative is zero: the TCP reverses its direction there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cusp {
    Start,
    End,
}

/// Share of the chord next to a cusp in which the curve is made regular.
///
/// With v the share of the chord from the cusp, the curve is a2 v^2 + a3 v^3 + ...: by x = v^2, its tangent is not zero, but
/// the second derivative of sqrt(x)^3 is infinite at 0. Below the square of this share, a polynomial takes the place of
/// sqrt(x). It moves the curve by at most 0.02 REGULAR^3 a3: 0.1 micrometres with a3 = 40 mm.
const REGULAR: f64 = 0.05;

/// sqrt(y) near 1, zero at 0: value and three derivatives agree at 1.
const ROOT: [f64; 5] = [0.0, 35.0 / 16.0, -35.0 / 16.0, 21.0 / 16.0, -5.0 / 16.0];

impl Shape {
    fn at(&self, x: Taylor) -> Vec3<Taylor> {
        let x = match self.cusp {
            None => return self.curve.at(x),
            Some(Cusp::Start) => x,
            Some(Cusp::End) => Taylor::constant(1.0) - x,
        };
        let threshold = REGULAR * REGULAR;
        let v = if x.value() < threshold {
            let y = x * (1.0 / threshold);
            ROOT.iter().rev().fold(Taylor::constant(0.0), |sum, c| sum * y + *c) * REGULAR
        } else {
            x.sqrt()
        };
        let [start, _, rest @ ..] = &self.curve.0;
        std::array::from_fn(|i| {
            let sum = rest.iter().rev().fold(Taylor::constant(0.0), |sum, c| sum * v + c[i]);
            sum * x + start[i]
        })
    }

    fn speed(&self, x: f64) -> f64 {
        norm(&self.at(Taylor::variable(x)).map(|Taylor([_, rate, ..])| rate))
    }

    /// Arc length of an interval of x, in m.
    fn length_m(&self, [from, to]: [f64; 2]) -> f64 {
        let half = 0.5 * (to - from);
        let middle = f64::midpoint(from, to);
        let pairs = GAUSS.iter().map(|[node, weight]| {
            weight * (self.speed(middle - half * node) + self.speed(middle + half * node))
        });
        half * pairs.sum::<f64>()
    }
}

/// Nodes and weights of Gauss's quadrature with 8 points, which are symmetric.
const GAUSS: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_3],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_48],
    [0.960_289_856_497_536_3, 0.101_228_536_290_376_26],
];

/// Intervals before any is halved.
const INTERVALS: u32 = 4;

/// Relative error of an interval's length above which it is halved.
const TOLERANCE: f64 = 1e-13;

/// Most halvings of an interval: then it is short next to rounding of the others.
const MAX_HALVINGS: u32 = 40;

/// Newton steps to the parameter of an arc length. From a cubic, two are enough; more where the curve is nearly a cusp.
const NEWTON_STEPS: u32 = 40;

impl ArcLengthCurve {
    /// The curve of a polynomial whose first derivative is zero at most at the end `cusp`.
    pub(crate) fn new(curve: Quintic<3>, cusp: Option<Cusp>) -> Self {
        let shape = Shape {
            curve: if cusp == Some(Cusp::End) { curve.part([1.0, 0.0]) } else { curve },
            cusp,
        };
        let even = (0..=INTERVALS).map(|i| f64::from(i) / f64::from(INTERVALS));
        let mut breaks: Vec<f64> = even.collect();
        match cusp {
            None => {}
            Some(Cusp::Start) => breaks.insert(1, REGULAR * REGULAR),
            Some(Cusp::End) => breaks.insert(breaks.len() - 1, 1.0 - REGULAR * REGULAR),
        }
        let mut curve = Self { nodes: vec![Node { x: 0.0, length_m: 0.0 }], shape };
        for ends in breaks.windows(2) {
            let range = [ends[0], ends[1]];
            curve.add(range, curve.shape.length_m(range), 0);
        }
        curve
    }

    /// Adds the nodes of an interval whose length is `whole_m` by one quadrature.
    fn add(&mut self, [from, to]: [f64; 2], whole_m: f64, halvings: u32) {
        let half = f64::midpoint(from, to);
        let parts = [[from, half], [half, to]];
        let lengths = parts.map(|part| self.shape.length_m(part));
        let [first, second] = lengths;
        let is_near = (first + second - whole_m).abs() <= TOLERANCE * (self.length_m() + whole_m);
        for (part, length_m) in parts.into_iter().zip(lengths) {
            if is_near || halvings == MAX_HALVINGS {
                let length_m = self.length_m() + length_m;
                self.nodes.push(Node { x: part[1], length_m });
            } else {
                self.add(part, length_m, halvings + 1);
            }
        }
    }

    pub(crate) fn length_m(&self) -> f64 {
        self.nodes[self.nodes.len() - 1].length_m
    }

    /// Position at the share `s` of the arc length.
    pub(crate) fn at(&self, s: Taylor) -> Vec3<Taylor> {
        let Taylor([share, s1, s2, s3]) = s;
        let length_m = self.length_m();
        let x = self.x_at(share * length_m);
        // The series of the arc length by x, from that of the speed, and its inverse.
        let rate = self
            .shape
            .at(Taylor::variable(x))
            .map(|Taylor([_, one, two, three])| Taylor([one, 2.0 * two, 3.0 * three, 0.0]));
        let Taylor([speed, speed1, speed2, _]) = dot(&rate, &rate).sqrt();
        let (a1, a2, a3) = (speed, 0.5 * speed1, speed2 / 3.0);
        let per = 1.0 / a1;
        let b1 = per;
        let b2 = -a2 * per * per * per;
        let b3 = (2.0 * a2 * a2 - a1 * a3) * per * per * per * per * per;
        let by = Taylor([0.0, length_m * s1, length_m * s2, length_m * s3]);
        let x = by * (by * (by * b3 + b2) + b1) + x;
        self.shape.at(x)
    }

    /// The parameter of the shape at an arc length.
    fn x_at(&self, length_m: f64) -> f64 {
        let last = self.nodes.len() - 1;
        let index = self.nodes[1..last].partition_point(|node| node.length_m <= length_m);
        let [start, end] = [self.nodes[index], self.nodes[index + 1]];
        let target = length_m - start.length_m;
        let whole = end.length_m - start.length_m;
        let [mut low, mut high] = [start.x, end.x];
        let mut x = start.x + (target / whole).clamp(0.0, 1.0) * (end.x - start.x);
        for _ in 0..NEWTON_STEPS {
            let excess = self.shape.length_m([start.x, x]) - target;
            if excess > 0.0 {
                high = x;
            } else {
                low = x;
            }
            let next = x - excess / self.shape.speed(x);
            let next = if (low..=high).contains(&next) { next } else { f64::midpoint(low, high) };
            let step = next - x;
            x = next;
            if step.abs() <= f64::EPSILON {
                break;
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (u, u^2, 0) for u from 0 to 1: its length is sqrt(5)/2 + asinh(2)/4.
    #[test]
    fn the_length_of_a_parabola_is_found() {
        let mut powers = [[0.0; 3]; 6];
        (powers[1], powers[2]) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        let curve = ArcLengthCurve::new(Quintic(powers), None);
        let expected = 0.5 * 5.0_f64.sqrt() + 0.25 * 2.0_f64.asinh();
        assert!((curve.length_m() - expected).abs() < 1e-14);
        for i in 0..=10 {
            let [x, y, _] =
                curve.at(Taylor::variable(f64::from(i) / 10.0)).map(Taylor::derivatives);
            assert!((x[1].hypot(y[1]) - expected).abs() < 1e-13);
            // d|p'|^2/ds = 0: the second derivative is across the first.
            assert!((x[1] * x[2] + y[1] * y[2]).abs() < 1e-12);
            assert!((y[0] - x[0] * x[0]).abs() < 1e-14);
        }
    }

    /// (v^2 / 2, v^3 / 3, 0): dp = v (1, v), so that the length up to v is ((1 + v^2)^1.5 - 1) / 3.
    #[test]
    fn a_cusp_has_a_regular_parameter() {
        let mut powers = [[0.0; 3]; 6];
        (powers[2], powers[3]) = ([0.5, 0.0, 0.0], [0.0, 1.0 / 3.0, 0.0]);
        let whole = (2.0_f64.powf(1.5) - 1.0) / 3.0;
        for (cusp, powers) in
            [(Cusp::Start, Quintic(powers)), (Cusp::End, Quintic(powers).part([1.0, 0.0]))]
        {
            let curve = ArcLengthCurve::new(powers, Some(cusp));
            assert!((curve.length_m() - whole).abs() < 2e-7);
            for i in 0..=100 {
                let v = f64::from(i) / 100.0;
                let length = ((1.0 + v * v).powf(1.5) - 1.0) / 3.0;
                let length = if cusp == Cusp::Start { length } else { whole - length };
                let share = length / whole;
                let [x, y, _] = curve.at(Taylor::variable(share)).map(Taylor::derivatives);
                assert!((x[0] - 0.5 * v * v).abs() < 1e-6, "{cusp:?} {v}");
                assert!((y[0] - v * v * v / 3.0).abs() < 3e-6, "{cusp:?} {v}");
                assert!((x[1].hypot(y[1]) - curve.length_m()).abs() < 1e-12);
                assert!(x.iter().chain(&y).all(|value| value.is_finite()));
            }
        }
    }
}
