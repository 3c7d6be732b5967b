//! Coordinates that can limit a curve: all of them, unless the curve is planar.
//!
//! In a plane, each limit reads `|a e_j + b t_j| <= 1`, with two numbers a and b that all joints
//! share; `e_j` and `t_j` are the components of joint j along two directions of the plane, over its
//! limit. The feasible points (a, b) form the polar of the convex hull of the 14 points
//! `+-(e_j, t_j)`. A joint whose point is not a vertex of the hull is redundant.

/// Joints (0 to 6) and the tool (7) that can be at their limit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LimitingJoints {
    coordinates: [usize; 8],
    /// Points of the joints, for a planar curve.
    points: [[f64; 2]; 7],
    count: usize,
}

impl LimitingJoints {
    /// All joints.
    pub(crate) const JOINTS: Self =
        Self { coordinates: [0, 1, 2, 3, 4, 5, 6, 7], points: [[0.0; 2]; 7], count: 7 };

    /// All joints and the tool.
    pub(crate) const ALL: Self = Self { count: 8, ..Self::JOINTS };

    /// Returns the vertices of the convex hull of `points` and their opposites.
    pub(crate) fn new(points: &[[f64; 2]; 7]) -> Self {
        let mut areas = [[0.0; 7]; 7];
        // Pairs that span an area above rounding. One direction of the plane may be a thousand
        // million times as long as the other, so rounding is relative to the products, not to the
        // distances.
        let mut spans = [[false; 7]; 7];
        for i in 0..7 {
            for k in 0..i {
                let ([a, b], [c, d]) = (points[i], points[k]);
                let (one, other) = (a * d, b * c);
                let area = (one - other).abs();
                (areas[i][k], areas[k][i]) = (area, area);
                spans[i][k] = area > ROUNDING * (one.abs() + other.abs());
            }
        }
        let mut is_limiting = [true; 7];
        if *spans.as_flattened() == [false; 49] {
            // All points are on one line through the origin: the farthest one limits.
            let square = |j: &usize| points[*j].iter().map(|v| v * v).sum::<f64>();
            let farthest = (0..7).max_by(|i, j| square(i).total_cmp(&square(j)));
            is_limiting = std::array::from_fn(|j| Some(j) == farthest);
        } else {
            for j in 0..7 {
                // The point is a combination of two others with a sum of weights of at most one.
                let is_between = |i: usize, k: usize| {
                    spans[i][k] && areas[j][k] + areas[i][j] <= areas[i][k] * (1.0 + EQUAL)
                };
                // Dropped points do not count, so that one of several equal points remains.
                let others = |i: &usize| is_limiting[*i] && *i != j;
                is_limiting[j] =
                    !(0..7).filter(others).any(|i| (0..i).filter(others).any(|k| is_between(i, k)));
            }
        }
        let mut limiting = Self { coordinates: [0; 8], points: [[0.0; 2]; 7], count: 0 };
        for j in (0..7).filter(|j| is_limiting[*j]) {
            limiting.coordinates[limiting.count] = j;
            limiting.points[limiting.count] = points[j];
            limiting.count += 1;
        }
        limiting
    }

    pub(crate) fn get(&self) -> &[usize] {
        &self.coordinates[..self.count]
    }

    /// Points in the plane of the coordinates that can limit.
    pub(crate) fn points(&self) -> &[[f64; 2]] {
        &self.points[..self.count]
    }
}

/// Share of the products below which their difference is rounding.
const ROUNDING: f64 = 1e-10;

/// Relative difference up to which two points count as equal.
const EQUAL: f64 = 1e-12;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Redundant joints are never nearer to their limits than the others.
        #[test]
        fn the_others_limit_nothing(
            points in prop::array::uniform7(prop::array::uniform2(-1.0..1.0_f64)),
            equal in 0..7_usize,
            factor in -2.0..2.0_f64,
            angles in prop::collection::vec(0.0..std::f64::consts::TAU, 50),
        ) {
            let mut points = points;
            // Joints that do not move along one direction, or at all, and joints that move in
            // proportion.
            points[equal] = points[0];
            points[(equal + 3) % 7] = points[0].map(|v| factor * v);
            points[(equal + 4) % 7] = points[0].map(|v| factor * factor * v);
            points[(equal + 1) % 7][0] = 0.0;
            points[(equal + 2) % 7] = [0.0; 2];
            let limiting = LimitingJoints::new(&points);
            for angle in angles {
                let (b, a) = angle.sin_cos();
                let value = |j: usize| (a * points[j][0] + b * points[j][1]).abs();
                let all = (0..7).map(value).fold(0.0, f64::max);
                let largest = limiting.get().iter().map(|&j| value(j)).fold(0.0, f64::max);
                prop_assert!(all <= largest * (1.0 + 1e-12), "{all} {largest} {limiting:?}");
            }
        }
    }

    /// Six joints on one ray, in a short blend: the direction across the path is a thousand million
    /// times as long as the other one.
    #[test]
    fn rounding_removes_no_corner() {
        let points = [
            [0.000_130_960_940_367_212_9, -109_595.371_571_696_3],
            [0.003_370_867_573_191_455_7, -65_406.913_920_018_56],
            [-0.001_127_229_869_066_937_8, 21_872.300_057_261_073],
            [0.000_563_298_772_724_077_3, -10_930.015_356_234_586],
            [0.000_884_617_092_816_720_6, -17_164.742_543_492_976],
            [0.000_414_151_068_630_548_4, -8_036.015_271_331_289],
            [0.000_862_743_337_873_42, -16_740.313_290_305_35],
        ];
        assert_eq!(LimitingJoints::new(&points).get(), [0, 1]);
        // All points are on one line through the origin, up to rounding: the farthest one has to be
        // kept.
        for rounding in [0.0, 1e-15, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9] {
            let mut sign = 1.0;
            let line = points.map(|[a, _]| {
                sign = -sign;
                [a, a / 3.0 * (1.0 + sign * rounding)]
            });
            let limiting = LimitingJoints::new(&line);
            assert!(limiting.get().contains(&1), "{rounding}: {:?}", limiting.get());
        }
    }

    #[test]
    fn corners_only() {
        let square =
            [[1.0, 1.0], [1.0, -1.0], [0.5, 0.5], [0.9, 0.0], [0.0; 2], [1.0, 0.0], [0.1, 0.9]];
        assert_eq!(LimitingJoints::new(&square).get(), [0, 1]);
    }
}
