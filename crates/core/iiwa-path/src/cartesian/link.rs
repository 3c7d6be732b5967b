//! Link of orientation and E1 of a spline to the arc length of its position.
//!
//! Orientation and E1 are splines in their own chords. The link w(s) is a quintic from the arc
//! length s of a segment to the chord length w, with rates m = w' and c = w'' at the knots. With h
//! the arc lengths, d the chords and t = d / h before (1) and after (2) a knot,
//! ```text
//! 1/m = (h2/t1 + h1/t2) / (h1 + h2)      c = -2 m^2 (1/t2 - 1/t1) / (h1 + h2)
//! ```
//!
//! Then (m, c) is projected onto the region in which the link does not turn back, in mm:
//!
//! ```text
//! 2 m + c h2/4 <= 2.5 t2,   m + c h2/4 >= 0,   2 m - c h1/4 <= 2.5 t1,   m - c h1/4 >= 0
//! ```
//!
//! At both ends of the spline, m = t and c = 0. Source: recordings of an LBR iiwa 7 R800 under
//! Sunrise, see docs/cartesian.md.

use super::quintic::Rates;

/// Unit of the distance to the region, on which the nearest point depends.
const MM_PER_M: f64 = 1e3;

/// Tolerance of the region, as a share of the rate of a secant.
const ROUNDING: f64 = 1e-9;

/// Rates of the link at an inner knot, by arc length in m; `arcs_m` and `chords` are those before
/// and after the knot.
pub(crate) fn link_rates(arcs_m: [f64; 2], chords: [f64; 2]) -> Rates<1> {
    let [h1, h2] = arcs_m.map(|arc| MM_PER_M * arc);
    let [t1, t2] = [chords[0] / h1, chords[1] / h2];
    let m = (h1 + h2) / (h2 / t1 + h1 / t2);
    let c = -2.0 * m * m * (1.0 / t2 - 1.0 / t1) / (h1 + h2);
    let region = [
        HalfPlane { normal: [2.0, 0.25 * h2], bound: 2.5 * t2 },
        HalfPlane { normal: [-1.0, -0.25 * h2], bound: 0.0 },
        HalfPlane { normal: [2.0, -0.25 * h1], bound: 2.5 * t1 },
        HalfPlane { normal: [-1.0, 0.25 * h1], bound: 0.0 },
    ];
    let [m, c] = nearest(&region, [m, c], ROUNDING * t1.max(t2));
    Rates { first: [MM_PER_M * m], second: [MM_PER_M * MM_PER_M * c] }
}

/// The points x with `normal . x <= bound`.
#[derive(Clone, Copy, Debug)]
struct HalfPlane {
    normal: [f64; 2],
    bound: f64,
}

impl HalfPlane {
    fn excess(&self, [x, y]: [f64; 2]) -> f64 {
        self.normal[0] * x + self.normal[1] * y - self.bound
    }

    /// Nearest point of the boundary.
    fn foot(&self, point: [f64; 2]) -> [f64; 2] {
        let [a, b] = self.normal;
        let share = self.excess(point) / (a * a + b * b);
        [point[0] - share * a, point[1] - share * b]
    }

    /// Point on both boundaries, or `None` if they are parallel.
    fn crossing(&self, other: &Self) -> Option<[f64; 2]> {
        let ([a, b], [c, d]) = (self.normal, other.normal);
        let determinant = a * d - b * c;
        let point = [
            (self.bound * d - b * other.bound) / determinant,
            (a * other.bound - self.bound * c) / determinant,
        ];
        point.iter().all(|x| x.is_finite()).then_some(point)
    }
}

/// Returns the point of a convex region that is nearest to `point`: the point itself inside the
/// region, otherwise a foot on a boundary or a vertex.
fn nearest(region: &[HalfPlane; 4], point: [f64; 2], tolerance: f64) -> [f64; 2] {
    let inside = |x: &[f64; 2]| region.iter().all(|half| half.excess(*x) <= tolerance);
    let distance = |x: &[f64; 2]| (x[0] - point[0]).hypot(x[1] - point[1]);
    let feet = region.iter().map(|half| half.foot(point));
    let corners = region
        .iter()
        .enumerate()
        .flat_map(|(i, half)| region[..i].iter().filter_map(|other| half.crossing(other)));
    let all = [point].into_iter().filter(&inside).chain(feet.chain(corners).filter(&inside));
    all.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(point)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equal rates before and after the knot: the link is straight.
    #[test]
    fn equal_rates_go_on() {
        let Rates { first: [m], second: [c] } = link_rates([0.1, 0.3], [0.2, 0.6]);
        assert!((m - 2.0).abs() < 1e-14 && c.abs() < 1e-12);
    }
}
