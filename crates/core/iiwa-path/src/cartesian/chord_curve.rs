//! Position of a spline between two knots, by chord length, and its arc length.

use iiwa_kin::{
    Number, Taylor,
    rotation::{Vec3, dot, norm},
};

use super::quintic::Quintic;

/// A part of a spline's position between two knots, by a path parameter s from 0 to 1.
///
/// s is the share of the chord, unless the TCP reverses at one end.
#[derive(Clone, Debug)]
pub(crate) struct ChordCurve {
    shape: RegularCurve,
    /// Ends of the intervals in s, with the arc lengths up to them.
    nodes: Vec<CurveNode>,
}

/// A place on a curve: the path parameter and the arc length up to this place, in m.
#[derive(Clone, Copy, Debug)]
struct CurveNode {
    s: f64,
    length_m: f64,
}

/// A curve whose tangent is not zero.
#[derive(Clone, Debug)]
struct RegularCurve {
    curve: Quintic<3>,
    /// The end at which the TCP reverses. The curve starts there.
    cusp: Option<Cusp>,
}

/// The end of a curve where its first derivative is zero: the TCP reverses its direction there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cusp {
    Start,
    End,
}

/// Rate of the share of the chord by s at the end opposite to a cusp. The second and the third
/// derivative are zero there, so that the path continues smoothly by chord length.
pub(crate) const CUSP_RATE: f64 = 0.5;

/// Share of the chord next to a cusp in which the curve is regularised.
///
/// With v the share of the chord from the cusp, the curve is a2 v^2 + a3 v^3 + .... By x = v^2, its
/// tangent is not zero, but the second derivative of sqrt(x)^3 is infinite at 0. Below the square
/// of this share, a polynomial replaces sqrt(x). It moves the curve by at most 0.02 REGULAR^3 a3:
/// 0.1 micrometres for a3 = 40 mm.
const REGULAR: f64 = 0.05;

/// Polynomial close to sqrt(y) near 1 and zero at 0; value and three derivatives agree at 1.
const ROOT: [f64; 5] = [0.0, 35.0 / 16.0, -35.0 / 16.0, 21.0 / 16.0, -5.0 / 16.0];

impl RegularCurve {
    fn at(&self, s: Taylor) -> Vec3<Taylor> {
        let one = Taylor::constant(1.0);
        let s = match self.cusp {
            None => return self.curve.at(s),
            Some(Cusp::Start) => s,
            Some(Cusp::End) => one - s,
        };
        // v^2 = (1 - k (1 - s))^2 - (1 - k)^2 (1 - s)^4 increases from 0, and v is linear near s =
        // 1.
        let rest = one - s;
        let [even, quartic] = [one - rest * CUSP_RATE, rest * rest * (1.0 - CUSP_RATE)];
        let x = even * even - quartic * quartic;
        let threshold = REGULAR * REGULAR;
        let v = if x.value() < threshold {
            let y = x * (1.0 / threshold);
            ROOT.iter().rev().fold(Taylor::constant(0.0), |sum, c| sum * y + *c) * REGULAR
        } else {
            x.sqrt()
        };
        // The linear term is zero at a cusp.
        let [start, _, powers @ ..] = &self.curve.0;
        std::array::from_fn(|i| {
            let sum = powers.iter().rev().fold(Taylor::constant(0.0), |sum, c| sum * v + c[i]);
            sum * x + start[i]
        })
    }

    fn speed(&self, s: f64) -> f64 {
        norm(&self.at(Taylor::variable(s)).map(|Taylor([_, rate, ..])| rate))
    }

    /// Arc length of an interval of s, in m.
    fn length_m(&self, [from, to]: [f64; 2]) -> f64 {
        let half = 0.5 * (to - from);
        let middle = f64::midpoint(from, to);
        let pairs = GAUSS.iter().map(|[node, weight]| {
            weight * (self.speed(middle - half * node) + self.speed(middle + half * node))
        });
        half * pairs.sum::<f64>()
    }
}

/// Nodes and weights of 8-point Gauss quadrature, which are symmetric.
const GAUSS: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_3],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_48],
    [0.960_289_856_497_536_3, 0.101_228_536_290_376_26],
];

/// Number of intervals before bisection.
const INTERVALS: u32 = 4;

/// Relative error of the length of an interval above which the interval is halved.
const TOLERANCE: f64 = 1e-13;

/// Maximum number of halvings of an interval, after which its length is below the rounding error of
/// the others.
const MAX_HALVINGS: u32 = 40;

impl ChordCurve {
    /// Creates the curve of a polynomial whose first derivative may be zero only at the end `cusp`.
    pub(crate) fn new(curve: Quintic<3>, cusp: Option<Cusp>) -> Self {
        let curve = if cusp == Some(Cusp::End) { curve.part([1.0, 0.0]) } else { curve };
        let nodes = vec![CurveNode { s: 0.0, length_m: 0.0 }];
        let mut curve = Self { nodes, shape: RegularCurve { curve, cusp } };
        for i in 0..INTERVALS {
            let range = [i, i + 1].map(|i| f64::from(i) / f64::from(INTERVALS));
            curve.add(range, curve.shape.length_m(range), 0);
        }
        curve
    }

    /// Adds the nodes of an interval with the length `whole_m` by one quadrature.
    fn add(&mut self, [from, to]: [f64; 2], whole_m: f64, halvings: u32) {
        let half = f64::midpoint(from, to);
        let parts = [[from, half], [half, to]];
        let lengths = parts.map(|part| self.shape.length_m(part));
        let [first, second] = lengths;
        // Relative to the length so far, to which the interval is added.
        let is_near = (first + second - whole_m).abs() <= TOLERANCE * (self.length_m() + whole_m);
        for (part, length_m) in parts.into_iter().zip(lengths) {
            if is_near || halvings == MAX_HALVINGS {
                let length_m = self.length_m() + length_m;
                self.nodes.push(CurveNode { s: part[1], length_m });
            } else {
                self.add(part, length_m, halvings + 1);
            }
        }
    }

    pub(crate) fn length_m(&self) -> f64 {
        self.nodes[self.nodes.len() - 1].length_m
    }

    pub(crate) fn at(&self, s: Taylor) -> Vec3<Taylor> {
        self.shape.at(s)
    }

    /// Share of the arc length up to `s`.
    pub(crate) fn arc_share(&self, s: Taylor) -> Taylor {
        let Taylor([s0, s1, s2, s3]) = s;
        let last = self.nodes.len() - 1;
        let index = self.nodes[1..last].partition_point(|node| node.s <= s0);
        let node = self.nodes[index];
        let length_m = node.length_m + self.shape.length_m([node.s, s0]);
        // Series of the length by s, from that of the speed.
        let rate = self
            .shape
            .at(Taylor::variable(s0))
            .map(|Taylor([_, one, two, three])| Taylor([one, 2.0 * two, 3.0 * three, 0.0]));
        let Taylor([speed, speed1, speed2, _]) = dot(&rate, &rate).sqrt();
        let by = Taylor([0.0, s1, s2, s3]);
        let length = by * (by * (by * (speed2 / 3.0) + 0.5 * speed1) + speed) + length_m;
        length * (1.0 / self.length_m())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (u, u^2, 0) for u from 0 to 1: its length up to u is u sqrt(1 + 4 u^2) / 2 + asinh(2 u) / 4.
    #[test]
    fn the_length_of_a_parabola_is_found() {
        let mut powers = [[0.0; 3]; 6];
        (powers[1], powers[2]) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        let curve = ChordCurve::new(Quintic(powers), None);
        let length = |u: f64| 0.5 * u * (1.0 + 4.0 * u * u).sqrt() + 0.25 * (2.0 * u).asinh();
        assert!((curve.length_m() - length(1.0)).abs() < 1e-14);
        for i in 0..=10 {
            let u = f64::from(i) / 10.0;
            let share = curve.arc_share(Taylor::variable(u));
            let [value, one, two, three] = share.derivatives().map(|x| x * length(1.0));
            // The speed w = sqrt(1 + 4 u^2), w' = 4 u / w, w'' = 4 / w^3.
            let w = (1.0 + 4.0 * u * u).sqrt();
            for (actual, expected) in
                [(value, length(u)), (one, w), (two, 4.0 * u / w), (three, 4.0 / w.powi(3))]
            {
                assert!((actual - expected).abs() < 1e-13, "{actual} {expected}");
            }
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
            let curve = ChordCurve::new(powers, Some(cusp));
            assert!((curve.length_m() - whole).abs() < 2e-7);
            for i in 0..=100 {
                let s = Taylor::variable(f64::from(i) / 100.0);
                let [x, y, _] = curve.at(s).map(Taylor::derivatives);
                let v = (2.0 * x[0]).sqrt();
                assert!((y[0] - v * v * v / 3.0).abs() < 1e-6, "{cusp:?} {v}");
                assert!(
                    x[1].hypot(y[1]) > 0.1 && x.iter().chain(&y).all(|value| value.is_finite())
                );
                let length = ((1.0 + v * v).powf(1.5) - 1.0) / 3.0 / whole;
                let length = if cusp == Cusp::Start { length } else { 1.0 - length };
                assert!((curve.arc_share(s).0[0] - length).abs() < 1e-6);
            }
            // At the other end: dv/ds = 1/2, the second and third derivative are zero.
            let other = if cusp == Cusp::Start { 1.0 } else { 0.0 };
            let [x, ..] = curve.at(Taylor::variable(other)).map(Taylor::derivatives);
            for (actual, expected) in x.into_iter().zip([0.5, 0.5, 0.25, 0.0]) {
                assert!((actual.abs() - expected).abs() < 1e-13, "{actual}");
            }
        }
    }
}
