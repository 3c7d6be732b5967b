//! Curves in joint space as piecewise polynomials.

use std::sync::Arc;

use iiwa_kin::{Joint, Joints, Limits, Number, Taylor, vector::norm};

use crate::{
    cartesian::{
        joint_curve::{CurveFault, JointCurve, MovingJoints, ToolMotion},
        quintic::powers_within,
        tcp_course::tool_way_of,
    },
    segment::{Derivatives, Segment, ToolWay},
};

/// A curve in joint space as polynomials of degree 7 with three continuous derivatives: the form
/// for timing, sampling, clearance and checks of joint ranges.
#[derive(Clone, Debug)]
pub(crate) struct JointSpline {
    /// Starts of the pieces in s, followed by 1.
    breaks: Vec<f64>,
    pieces: Vec<PieceCoefficients>,
    sigma: Sigma,
    /// Source of the TCP motion, for TCP limits.
    curve: Arc<dyn JointCurve>,
}

/// Coefficients of all joints, lowest power of the share of the piece first.
type PieceCoefficients = [Joints; 8];

/// Largest distance between the polynomials and the curve, in rad.
const TOLERANCE_RAD: f64 = 1e-9;

/// Maximum number of halvings of a piece. Near a singular pose, joints vary with the square root of
/// the distance from it: the length of pieces decreases in proportion to that distance.
const MAX_HALVINGS: u32 = 32;

/// Maximum number of pieces.
const MAX_PIECES: usize = 1 << 12;

/// A place at which the curve cannot be followed, and the cause.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CurveFaultAt {
    pub(crate) s: f64,
    pub(crate) fault: CurveFault,
}

/// The path parameter: `s + alpha` of a blend, with different rates at both ends.
///
/// The neighbours set the rates at the ends: with sigma as the parameter, q' and q'' are continuous
/// from segment to segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sigma {
    /// dsigma/ds at the start and at the end, in rad.
    rates: [f64; 2],
    /// Weight of alpha, in rad.
    middle: f64,
}

impl Sigma {
    /// Linear along the curve, with this length in rad.
    pub(crate) fn even(length_rad: f64) -> Self {
        Self { rates: [length_rad; 2], middle: 0.0 }
    }

    /// Parameter of a blend between curves with these rates.
    pub(crate) fn of_blend(rates: [f64; 2]) -> Self {
        Self { rates, middle: f64::midpoint(rates[0], rates[1]) }
    }

    /// Value and first three derivatives.
    fn at(&self, s: f64) -> [f64; 4] {
        let [from, to] = self.rates;
        let alpha = s * s * s * (10.0 + s * (6.0 * s - 15.0));
        let rate = 30.0 * s * s * (1.0 - s) * (1.0 - s);
        let bend = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s);
        let change = 60.0 * (1.0 - 6.0 * s + 6.0 * s * s);
        let area = s * s * s * s * (2.5 + s * (s - 3.0));
        let by = to - from;
        [
            from * s + by * area + self.middle * alpha,
            from + by * alpha + self.middle * rate,
            by * rate + self.middle * bend,
            by * bend + self.middle * change,
        ]
    }
}

impl JointSpline {
    /// Approximates the image of `curve`.
    pub(crate) fn of(curve: Arc<dyn JointCurve>) -> Result<Self, CurveFaultAt> {
        Self::between(curve, &[None, None])
    }

    /// Approximates the image of `curve`, a blend between two curves. It begins and ends with their
    /// position, first and second derivative, which differ from its own by the tolerance of their
    /// polynomials.
    pub(crate) fn of_blend(
        curve: Arc<dyn JointCurve>,
        neighbours: [&dyn JointCurve; 2],
    ) -> Result<Self, CurveFaultAt> {
        let [a, b] = neighbours;
        let at = |curve: &dyn JointCurve, s| {
            curve.at(Taylor::variable(s)).map_err(|fault| CurveFaultAt { s, fault })
        };
        Self::between(curve, &[Some(at(a, 0.0)?), Some(at(b, 1.0)?)])
    }

    fn between(
        curve: Arc<dyn JointCurve>,
        neighbours: &[Option<MovingJoints>; 2],
    ) -> Result<Self, CurveFaultAt> {
        let mut spline =
            Self { breaks: vec![0.0], pieces: Vec::new(), sigma: Sigma::even(1.0), curve };
        let at = |s| spline.joints(s);
        let mut ends = [at(0.0)?, at(1.0)?];
        for (end, neighbour) in ends.iter_mut().zip(neighbours) {
            for (joint, other) in end.iter_mut().zip(neighbour.iter().flatten()) {
                joint.0[..3].copy_from_slice(&other.0[..3]);
            }
        }
        let middle = at(0.5)?;
        // The ends of a neighbour differ from those of the curve by up to the tolerance.
        let is_own = neighbours.iter().all(Option::is_none);
        let tolerance_rad = if is_own { TOLERANCE_RAD } else { 2.0 * TOLERANCE_RAD };
        spline.halve([0.0, 1.0], &ends, &middle, tolerance_rad, 0)?;
        Ok(spline)
    }

    /// Returns the curve with another path parameter.
    pub(crate) fn with_sigma(self, sigma: Sigma) -> Self {
        Self { sigma, ..self }
    }

    /// Returns the part of the curve between two parameters, with these polynomials. `curve` is
    /// the source of its TCP motion.
    pub(crate) fn part(&self, [from, to]: [f64; 2], curve: Arc<dyn JointCurve>) -> Self {
        let [mut first, mut last] = [self.index(from), self.index(to)];
        let ends = |index: usize| [self.breaks[index], self.breaks[index + 1]];
        let share = |index: usize, s: f64| {
            let [start, end] = ends(index);
            (s - start) / (end - start)
        };
        // A sliver of a piece is left to its neighbour, whose polynomials go on there.
        if first < last && share(first, from) > 1.0 - SLIVER {
            first += 1;
        }
        if first < last && share(last, to) < SLIVER {
            last -= 1;
        }
        let mut part =
            Self { breaks: vec![0.0], pieces: Vec::new(), sigma: Sigma::even(1.0), curve };
        for index in first..=last {
            let start = if index == first { share(index, from) } else { 0.0 };
            let end = if index == last { share(index, to) } else { 1.0 };
            part.pieces.push(powers_within(self.pieces[index], [start, end]));
            part.breaks.push((ends(index)[1] - from) / (to - from));
        }
        if let Some(end) = part.breaks.last_mut() {
            *end = 1.0;
        }
        part
    }

    fn joints(&self, s: f64) -> Result<MovingJoints, CurveFaultAt> {
        self.curve.at(Taylor::variable(s)).map_err(|fault| CurveFaultAt { s, fault })
    }

    /// Adds the pieces of a range, given its ends and its middle.
    fn halve(
        &mut self,
        [from, to]: [f64; 2],
        ends: &[MovingJoints; 2],
        middle: &MovingJoints,
        tolerance_rad: f64,
        halvings: u32,
    ) -> Result<(), CurveFaultAt> {
        let length = to - from;
        let piece = hermite(ends, length);
        let [quarter, three] = [0.25, 0.75].map(|share| self.joints(from + share * length));
        let [quarter, three] = [quarter?, three?];
        let is_near = |share: f64, joints: &MovingJoints| {
            let q = value(&piece, share);
            std::iter::zip(q, joints).all(|(q, joint)| (q - joint.0[0]).abs() <= tolerance_rad)
        };
        if is_near(0.25, &quarter) && is_near(0.5, middle) && is_near(0.75, &three) {
            self.pieces.push(piece);
            self.breaks.push(to);
            return Ok(());
        }
        let half = f64::midpoint(from, to);
        if halvings == MAX_HALVINGS || self.pieces.len() >= MAX_PIECES {
            return Err(CurveFaultAt { s: half, fault: CurveFault::Abrupt });
        }
        // The quarters are the middles of the halves: two evaluations per halving suffice.
        self.halve([from, half], &[ends[0], *middle], &quarter, tolerance_rad, halvings + 1)?;
        self.halve([half, to], &[*middle, ends[1]], &three, tolerance_rad, halvings + 1)
    }

    /// Returns the index of the piece at `s`.
    fn index(&self, s: f64) -> usize {
        self.breaks[1..self.pieces.len()].partition_point(|end| *end <= s)
    }

    /// Returns the piece at `s`, the share of the piece, and its length in s.
    fn piece(&self, s: f64) -> (&PieceCoefficients, f64, f64) {
        let index = self.index(s);
        let [from, to] = [self.breaks[index], self.breaks[index + 1]];
        (&self.pieces[index], (s - from) / (to - from), to - from)
    }

    /// Returns the joint that is farthest outside its range, with the place in s and the position
    /// there.
    pub(crate) fn outside(&self, limits: &Limits) -> Option<(Joint, f64, f64)> {
        let mut worst: Option<(f64, Joint, f64, f64)> = None;
        for (piece, ends) in self.pieces.iter().zip(self.breaks.windows(2)) {
            for joint in Joint::ALL {
                let j = joint.index();
                let range = limits.range_rad(joint);
                let excess = |q: f64| (range[0] - q).max(q - range[1]);
                let control = bernstein(&piece.map(|power| power[j]));
                if control.iter().all(|q| excess(*q) <= 0.0) {
                    continue;
                }
                // The curve is within the hull of its control points, which converge to it by
                // subdivision.
                let mut parts = vec![(control, ends[0], ends[1])];
                while let Some((control, from, to)) = parts.pop() {
                    let excess_of = |worst: &Option<(f64, _, _, _)>| {
                        worst.as_ref().map_or(ROUNDING_RAD, |(max_excess, ..)| *max_excess)
                    };
                    for (s, q) in [(from, control[0]), (to, control[7])] {
                        if excess(q) > excess_of(&worst) {
                            worst = Some((excess(q), joint, s, q));
                        }
                    }
                    let max_excess = control.iter().map(|q| excess(*q)).fold(f64::MIN, f64::max);
                    // Only parts that may exceed the worst place so far are divided further.
                    if max_excess > excess_of(&worst) + ROUNDING_RAD && to - from > f64::EPSILON {
                        let half = f64::midpoint(from, to);
                        let [left, right] = split(&control);
                        parts.extend([(left, from, half), (right, half, to)]);
                    }
                }
            }
        }
        worst.map(|(_, joint, s, q)| (joint, s, q))
    }

    /// Mean of |dq/ds|, in rad.
    pub(crate) fn mean_rate_rad(&self) -> f64 {
        let ends = self.breaks.windows(2);
        let lengths = ends.map(|ends| {
            [0.0, 0.5, 1.0]
                .map(|share| norm(&Segment::at(self, ends[0] + share * (ends[1] - ends[0])).dq))
                .into_iter()
                .zip([1.0, 4.0, 1.0])
                .map(|(rate, weight)| rate * weight / 6.0)
                .sum::<f64>()
                * (ends[1] - ends[0])
        });
        lengths.sum()
    }
}

/// Tolerance of joint ranges, in rad: as in [`Limits::check`].
const ROUNDING_RAD: f64 = 5e-9;

/// Share of a piece that is left to its neighbour at the end of a part of a curve: the polynomials
/// join with three derivatives, so that they differ there by less than rounding.
const SLIVER: f64 = 1e-4;

/// The polynomials as a curve whose values are power series.
impl JointCurve for JointSpline {
    fn at(&self, s: Taylor) -> Result<MovingJoints, CurveFault> {
        let (piece, share, length) = self.piece(s.value());
        let mut share_series = s * (1.0 / length);
        share_series.0[0] = share;
        let [rest @ .., last] = piece;
        Ok(rest.iter().rev().fold(last.map(Taylor::constant), |q, power| {
            std::array::from_fn(|j| q[j] * share_series + Taylor::constant(power[j]))
        }))
    }

    fn tool_motion(&self, s: f64) -> ToolMotion<'_> {
        self.curve.tool_motion(s)
    }

    fn is_even(&self) -> bool {
        self.curve.is_even()
    }
}

impl Segment for JointSpline {
    fn at(&self, s: f64) -> Derivatives {
        let (piece, share, length) = self.piece(s);
        // Horner's scheme for the value and, one step behind each, for the derivatives over their
        // factorials.
        let [mut q, mut dq, mut ddq, mut dddq] = [[0.0; 7]; 4];
        for power in piece.iter().rev() {
            for j in 0..7 {
                dddq[j] = dddq[j] * share + ddq[j];
                ddq[j] = ddq[j] * share + dq[j];
                dq[j] = dq[j] * share + q[j];
                q[j] = q[j] * share + power[j];
            }
        }
        let per = 1.0 / length;
        Derivatives {
            q,
            dq: dq.map(|v| v * per),
            ddq: ddq.map(|v| 2.0 * v * per * per),
            dddq: dddq.map(|v| 6.0 * v * per * per * per),
        }
    }

    fn bend_bound_rad(&self) -> Joints {
        let mut bound = [0.0_f64; 7];
        for (piece, ends) in self.pieces.iter().zip(self.breaks.windows(2)) {
            let per = 1.0 / (ends[1] - ends[0]);
            for (j, bound) in bound.iter_mut().enumerate() {
                let mut second = [0.0; 8];
                for k in 2..8 {
                    second[k - 2] = (k * (k - 1)) as f64 * piece[k][j];
                }
                // The control points of the second derivative bound it.
                let max_second = bernstein(&second).into_iter().map(f64::abs).fold(0.0, f64::max);
                *bound = bound.max(max_second * per * per);
            }
        }
        bound
    }

    fn sigma(&self, s: f64) -> [f64; 4] {
        self.sigma.at(s)
    }

    fn sigma_unit_rad(&self) -> f64 {
        1.0
    }

    fn tool_way(&self, s: f64) -> ToolWay {
        match self.curve.tool_motion(s) {
            ToolMotion::Known(way) => way,
            ToolMotion::OfJoints(robot, tcp_m) => {
                let Derivatives { q, dq, ddq, dddq } = Segment::at(self, s);
                tool_way_of(&robot.tool_rates(&tcp_m, &q, &[dq, ddq, dddq]))
            }
        }
    }

    fn breaks(&self) -> &[f64] {
        &self.breaks
    }

    fn has_even_tool_way(&self) -> bool {
        self.curve.is_even()
    }
}

/// Returns the polynomials with the given values and three derivatives at both ends of a piece of
/// this length in s.
fn hermite(ends: &[MovingJoints; 2], length: f64) -> PieceCoefficients {
    let mut piece = [[0.0; 7]; 8];
    for j in 0..7 {
        let powers = [1.0, length, length * length, length * length * length];
        let [a, b]: [[f64; 4]; 2] =
            ends.each_ref().map(|end| std::array::from_fn(|k| end[j].0[k] * powers[k]));
        // Residuals of the value and of the derivatives over their factorials at the end, after the
        // first four powers.
        let rest = [
            b[0] - (a[0] + a[1] + a[2] + a[3]),
            b[1] - (a[1] + 2.0 * a[2] + 3.0 * a[3]),
            b[2] - (a[2] + 3.0 * a[3]),
            b[3] - a[3],
        ];
        for (k, a) in a.into_iter().enumerate() {
            piece[k][j] = a;
        }
        for (k, weights) in HERMITE.iter().enumerate() {
            piece[4 + k][j] = std::iter::zip(weights, rest).map(|(w, r)| w * r).sum();
        }
    }
    piece
}

/// Matrix from the residuals at the end to the coefficients of the fourth to the seventh power.
const HERMITE: [[f64; 4]; 4] = [
    [35.0, -15.0, 5.0, -1.0],
    [-84.0, 39.0, -14.0, 3.0],
    [70.0, -34.0, 13.0, -3.0],
    [-20.0, 10.0, -4.0, 1.0],
];

fn value(piece: &PieceCoefficients, share: f64) -> Joints {
    let [rest @ .., last] = piece;
    rest.iter().rev().fold(*last, |q, power| std::array::from_fn(|j| q[j] * share + power[j]))
}

/// Returns the control points of a polynomial of degree 7 on [0, 1] (Bernstein form).
fn bernstein(powers: &[f64; 8]) -> [f64; 8] {
    let mut control = [0.0; 8];
    for (i, control) in control.iter_mut().enumerate() {
        // binomial(i, k) / binomial(7, k)
        let mut weight = 1.0;
        for (k, power) in powers.iter().enumerate().take(i + 1) {
            *control += weight * power;
            // After the last power, the weight is not used: no division by zero.
            weight *= (i - k) as f64 / (7 - k).max(1) as f64;
        }
    }
    control
}

/// Returns the control points of both halves (de Casteljau's algorithm).
fn split(control: &[f64; 8]) -> [[f64; 8]; 2] {
    let (mut left, mut right, mut points) = ([0.0; 8], [0.0; 8], *control);
    for k in 0..8 {
        (left[k], right[7 - k]) = (points[0], points[7 - k]);
        for i in 0..7 - k {
            points[i] = f64::midpoint(points[i], points[i + 1]);
        }
    }
    [left, right]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curve of sines, which are not polynomials.
    #[derive(Debug)]
    struct Sines;

    impl JointCurve for Sines {
        fn at(&self, s: Taylor) -> Result<MovingJoints, CurveFault> {
            Ok(std::array::from_fn(|j| {
                let [rate, phase] = [1.0 + j as f64, 0.3 * j as f64];
                (s * rate + phase).sin_cos().0
            }))
        }

        fn tool_motion(&self, _: f64) -> ToolMotion<'_> {
            ToolMotion::Known(ToolWay::default())
        }

        fn is_even(&self) -> bool {
            true
        }
    }

    /// Ends of parts: within pieces, at a break, and beside one.
    #[test]
    fn a_part_is_the_curve_between_its_ends() {
        let curve = Arc::new(Sines);
        let whole = JointSpline::of(Arc::clone(&curve) as Arc<dyn JointCurve>).unwrap();
        assert!(whole.pieces.len() >= 8, "{}", whole.pieces.len());
        let near = whole.breaks[3];
        for [from, to] in [
            [0.0, 0.77],
            [near, 1.0],
            [near - 1e-13, 0.9],
            [near - 1e-11, near + 1e-3],
            [0.05, near + 1e-11],
            [0.1, near + 1e-13],
            [0.4001, 0.4004],
        ] {
            let part = whole.part([from, to], Arc::clone(&curve) as Arc<dyn JointCurve>);
            assert!(part.breaks.windows(2).all(|pair| pair[1] - pair[0] > 1e-7), "{part:?}");
            for i in 0..=40 {
                let share = f64::from(i) / 40.0;
                let s = from + share * (to - from);
                let expected = JointCurve::at(&whole, Taylor::variable(s)).unwrap();
                let actual = JointCurve::at(&part, Taylor::variable(share)).unwrap();
                let [by_segment, scale] = [Segment::at(&part, share), Segment::at(&whole, s)];
                for j in 0..7 {
                    let length = to - from;
                    for (k, power) in [1.0, length, length * length].into_iter().enumerate() {
                        let error = actual[j].0[k] - power * expected[j].0[k];
                        assert!(error.abs() < 1e-12 + 1e-9 * power, "{from} {to} {j} {k}: {error}");
                    }
                    assert!((by_segment.q[j] - scale.q[j]).abs() < 1e-12);
                    let rate = (to - from) * scale.dq[j];
                    assert!((by_segment.dq[j] - rate).abs() < 1e-12 + 1e-9 * (to - from));
                }
            }
        }
    }
}
