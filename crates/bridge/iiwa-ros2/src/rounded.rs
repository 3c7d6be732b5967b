//! A smooth curve along a polyline: a B-spline of degree 5 with control points on the polyline.
//!
//! The curve has four continuous derivatives, and stays within the convex hull of six consecutive
//! control points: on straight parts it coincides with the line, and at a corner it passes inside
//! by half the distance of the control points.

use std::sync::Arc;

use iiwa_kin::{Joints, vector};
use iiwa_path::{Derivatives, Segment};

use super::{polyline::Polyline, spacing::Spacing};

/// Number of control points that a point of the curve depends on.
const ORDER: usize = 6;

/// Polynomials of a uniform B-spline of degree 5, with ascending powers, times 120.
const BASIS: [[f64; 6]; ORDER] = [
    [1.0, -5.0, 10.0, -10.0, 5.0, -1.0],
    [26.0, -50.0, 20.0, 20.0, -20.0, 5.0],
    [66.0, 0.0, -60.0, 0.0, 30.0, -10.0],
    [26.0, 50.0, 20.0, -20.0, -20.0, 10.0],
    [1.0, 5.0, 10.0, 10.0, 5.0, -5.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
];

/// Number of spans per segment, as fine as the planner's cells in a blend.
const SPANS_A_SEGMENT: usize = 4;

/// Minimum number of spans of a curve.
const MIN_SPANS: usize = 8;

/// Maximum distance of the control points, in rad, and as a share of the length.
const MAX_RAD: f64 = 0.2;
const MAX_SHARE: f64 = 0.1;

/// Minimum distance of the control points, as a share of the tolerance. The curve is closer to a
/// corner than this distance.
const MIN_SHARE: f64 = 0.25;

/// A curve along a polyline from its start to its end.
#[derive(Clone, Debug)]
pub(super) struct Rounded {
    control: Arc<[Joints]>,
    /// Mean distance of the control points, in rad.
    unit_rad: f64,
}

impl Rounded {
    /// Returns the smoothest curve that passes all points within `tolerance`, in rad, and through
    /// the first and the last one, and its maximum distance from a point.
    pub(super) fn along(polyline: &Polyline, tolerance: f64) -> (Self, f64) {
        let max_distance = MAX_RAD.min(MAX_SHARE * polyline.length());
        let min_distance = MIN_SHARE * tolerance;
        let mut spacing = Spacing::even(polyline.ways(), max_distance.max(min_distance));
        loop {
            spacing.grade();
            let places = spacing.samples(MIN_SPANS);
            let curve = Self::with_control(&polyline.at(&places), polyline.length());
            let off = curve.distances(polyline, &places);
            // Each halving reduces the distance from a point; the minimum spacing terminates the
            // loop.
            let mut changed = false;
            for (i, off) in off.iter().enumerate() {
                if *off > tolerance {
                    changed |= spacing.halve(i, min_distance);
                }
            }
            if !changed {
                return (curve, off.into_iter().fold(0.0, f64::max));
            }
        }
    }

    /// Creates the curve with these control points. Two additional control points at each end
    /// mirror their neighbours, so that the curve starts at the first and ends at the last given
    /// one.
    fn with_control(points: &[Joints], length: f64) -> Self {
        let count = points.len();
        let mirror = |i: usize, center: usize| -> Joints {
            std::array::from_fn(|j| 2.0 * points[center][j] - points[i][j])
        };
        let mut control = Vec::with_capacity(count + 4);
        control.extend([mirror(2, 0), mirror(1, 0)]);
        control.extend_from_slice(points);
        control.extend([mirror(count - 2, count - 1), mirror(count - 3, count - 1)]);
        Self { control: control.into(), unit_rad: length / (count - 1) as f64 }
    }

    fn spans(&self) -> usize {
        self.control.len() - (ORDER - 1)
    }

    /// Returns the curve in parts.
    pub(super) fn segments(&self) -> Vec<Arc<dyn Segment>> {
        let spans = self.spans();
        let count = spans.div_ceil(SPANS_A_SEGMENT);
        (0..count)
            .map(|k| {
                let [first, end] = [k, k + 1].map(|k| k * spans / count);
                let (control, unit_rad) = (Arc::clone(&self.control), self.unit_rad);
                Arc::new(CurvePart { control, first, spans: end - first, unit_rad })
                    as Arc<dyn Segment>
            })
            .collect()
    }

    /// Returns the distances of the curve, with control points at `places`, from the points of the
    /// polyline, in rad.
    fn distances(&self, polyline: &Polyline, places: &[f64]) -> Vec<f64> {
        const STEPS_A_SPAN: usize = 8;
        let spans = self.spans();
        let mut span = 0;
        std::iter::zip(polyline.points(), polyline.ways())
            .map(|(point, way)| {
                while span + 1 < spans && places[span + 1] <= *way {
                    span += 1;
                }
                // The nearest point is close to the one with the same arc length.
                let from = span.saturating_sub(1) * STEPS_A_SPAN;
                let to = ((span + 2) * STEPS_A_SPAN).min(spans * STEPS_A_SPAN);
                let at = |step: usize| self.at(step as f64 / STEPS_A_SPAN as f64);
                let near = (from..=to)
                    .map(at)
                    .min_by(|a, b| {
                        let off = |at: &Derivatives| vector::distance(&at.q, point);
                        off(a).total_cmp(&off(b))
                    })
                    .unwrap_or_else(|| at(from));
                // One further step along the tangent.
                let off = vector::sub(point, &near.q);
                let square = vector::dot(&near.dq, &near.dq).max(f64::MIN_POSITIVE);
                let max_step = 1.0 / STEPS_A_SPAN as f64;
                let step = (vector::dot(&off, &near.dq) / square).clamp(-max_step, max_step);
                vector::norm(&vector::sub(&off, &vector::scale(step, &near.dq)))
            })
            .collect()
    }

    /// Returns position and derivatives at the parameter `u`, in spans.
    fn at(&self, u: f64) -> Derivatives {
        evaluate(&self.control, self.spans(), u)
    }
}

/// Returns position and derivatives at the parameter `u`, in spans, of a curve with `spans` spans.
fn evaluate(control: &[Joints], spans: usize, u: f64) -> Derivatives {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number of spans, not below 0"
    )]
    let span = (u.max(0.0) as usize).min(spans - 1);
    let t = u - span as f64;
    let [mut q, mut dq, mut ddq, mut dddq] = [[0.0; 7]; 4];
    for (weights, point) in BASIS.iter().zip(&control[span..span + ORDER]) {
        // Horner's scheme for the value and, one step behind each other, for the derivatives
        // divided by their factorials.
        let mut w = [0.0; 4];
        for power in weights.iter().rev() {
            w[3] = w[3] * t + w[2];
            w[2] = w[2] * t + w[1];
            w[1] = w[1] * t + w[0];
            w[0] = w[0] * t + power;
        }
        let w = [w[0] / 120.0, w[1] / 120.0, w[2] / 60.0, w[3] / 20.0];
        for j in 0..7 {
            q[j] += w[0] * point[j];
            dq[j] += w[1] * point[j];
            ddq[j] += w[2] * point[j];
            dddq[j] += w[3] * point[j];
        }
    }
    Derivatives { q, dq, ddq, dddq }
}

/// Some spans of a curve. All parts share the curve's parameter sigma, with respect to which all
/// derivatives are continuous between parts.
#[derive(Debug)]
struct CurvePart {
    control: Arc<[Joints]>,
    first: usize,
    spans: usize,
    unit_rad: f64,
}

impl Segment for CurvePart {
    fn at(&self, s: f64) -> Derivatives {
        let spans = self.spans as f64;
        let all = self.control.len() - (ORDER - 1);
        let Derivatives { q, dq, ddq, dddq } =
            evaluate(&self.control, all, self.first as f64 + s * spans);
        Derivatives {
            q,
            dq: vector::scale(spans, &dq),
            ddq: vector::scale(spans * spans, &ddq),
            dddq: vector::scale(spans * spans * spans, &dddq),
        }
    }

    fn bend_bound_rad(&self) -> Joints {
        // The second derivative is also a spline, whose control points are the second differences
        // of these.
        let mut bound = [0.0_f64; 7];
        let control = &self.control[self.first..self.first + self.spans + ORDER - 1];
        for three in control.windows(3) {
            for j in 0..7 {
                bound[j] = bound[j].max((three[0][j] - 2.0 * three[1][j] + three[2][j]).abs());
            }
        }
        let spans = self.spans as f64;
        vector::scale(spans * spans, &bound)
    }

    fn sigma(&self, s: f64) -> [f64; 4] {
        let spans = self.spans as f64;
        [s * spans, spans, 0.0, 0.0]
    }

    fn sigma_unit_rad(&self) -> f64 {
        self.unit_rad
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(points: &[[f64; 2]]) -> Polyline {
        let points: Vec<Joints> =
            points.iter().map(|[a, b]| [*a, *b, 0.0, 0.0, 0.0, 0.0, 0.0]).collect();
        Polyline::new(&points)
    }

    #[test]
    fn a_corner_is_passed_within_the_tolerance() {
        let corner = plane(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.5]]);
        for tolerance in [0.1, 0.01, 0.001] {
            let (curve, off) = Rounded::along(&corner, tolerance);
            assert!(off <= tolerance && off > 0.2 * tolerance, "{off} of {tolerance}");
            let ends = [0.0, curve.spans() as f64].map(|u| curve.at(u).q);
            let met = |a: &Joints, b: &Joints| vector::distance(a, b) < 1e-12;
            assert!(met(&ends[0], &corner.points()[0]) && met(&ends[1], &corner.points()[2]));
        }
    }

    #[test]
    fn parts_go_on_from_each_other() {
        let zigzag = plane(&[[0.0, 0.0], [1.0, 0.2], [1.1, 0.8], [0.7, 1.0], [0.7, 1.01]]);
        let (curve, _) = Rounded::along(&zigzag, 0.01);
        let parts = curve.segments();
        assert!(parts.len() > 5);
        for two in parts.windows(2) {
            let [end, start] = [two[0].at(1.0).q, two[1].at(0.0).q];
            assert!(vector::distance(&end, &start) < 1e-12);
            let [end, start] = [two[0].sigma_derivatives(1.0), two[1].sigma_derivatives(0.0)];
            for (a, b) in end.iter().zip(&start) {
                assert!(vector::distance(a, b) < 1e-9 * (1.0 + vector::norm(a)));
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_position() {
        let zigzag = plane(&[[0.0, 0.0], [1.0, 0.2], [1.1, 0.8]]);
        let (curve, _) = Rounded::along(&zigzag, 0.02);
        let part = &curve.segments()[1];
        let h = 1e-4;
        for s in [0.1, 0.25, 0.6, 0.9] {
            let [before, middle, after] = [-h, 0.0, h].map(|d| part.at(s + d));
            for j in 0..2 {
                let rate =
                    |of: fn(&Derivatives) -> &Joints| (of(&after)[j] - of(&before)[j]) / (2.0 * h);
                assert!((rate(|middle| &middle.q) - middle.dq[j]).abs() < 1e-5);
                assert!((rate(|middle| &middle.dq) - middle.ddq[j]).abs() < 1e-4);
                assert!((rate(|middle| &middle.ddq) - middle.dddq[j]).abs() < 1e-3);
                assert!(middle.ddq[j].abs() <= part.bend_bound_rad()[j] + 1e-12);
            }
        }
    }
}
