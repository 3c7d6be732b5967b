//! Which joints can limit a curve that lies in a plane.
//!
//! There, each limit reads `|a e_j + b t_j| <= 1` in two numbers a and b that all joints share, with `e_j` and `t_j` the
//! parts of joint j along two directions of the plane, over its limit. The points (a, b) that keep the limits
//! form the polar of the convex hull of the 14 points `+-(e_j, t_j)`: a joint whose point is no corner of the hull
//! never limits alone. Leaving it out changes nothing.

/// Joints (0 to 6) that can be at their limit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LimitingJoints {
    joints: [usize; 7],
    /// Their points.
    points: [[f64; 2]; 7],
    count: usize,
}

impl LimitingJoints {
    pub(crate) const ALL: Self =
        Self { joints: [0, 1, 2, 3, 4, 5, 6], points: [[0.0; 2]; 7], count: 7 };

    /// The corners of the convex hull of `points` and their opposites.
    pub(crate) fn new(points: &[[f64; 2]; 7]) -> Self {
        let square = |[a, b]: [f64; 2]| a * a + b * b;
        let by_distance = |&i: &usize, &j: &usize| square(points[i]).total_cmp(&square(points[j]));
        // The farthest point is a corner. The corners from there around to its opposite are all others, or theirs.
        let farthest = (0..7).max_by(by_distance).unwrap_or_default();
        let from = points[farthest];
        let mut left: Vec<_> = (0..7)
            .filter(|&j| j != farthest)
            .map(|j| {
                let right = cross(from, points[j]) < 0.0;
                (j, if right { points[j].map(|v| -v) } else { points[j] })
            })
            .collect();
        left.push((farthest, from.map(|v| -v)));
        let mut limiting = Self { joints: [0; 7], points: [[0.0; 2]; 7], count: 0 };
        let mut corner = (farthest, from);
        loop {
            let (joint, point) = corner;
            limiting.joints[limiting.count] = joint;
            limiting.points[limiting.count] = points[joint];
            limiting.count += 1;
            // Gift wrapping: all others are to the left of the way to the next corner. Of some in one direction it is
            // the farthest, whichever rounding prefers.
            let to = |other: [f64; 2]| [other[0] - point[0], other[1] - point[1]];
            let mut next = left.len() - 1;
            for other in 0..left.len() - 1 {
                let [best, way] = [next, other].map(|place| to(left[place].1));
                let side = cross(best, way);
                if side < 0.0 || side == 0.0 && square(way) > square(best) {
                    next = other;
                }
            }
            corner = left.remove(next);
            if corner.0 == farthest {
                return limiting;
            }
        }
    }

    pub(crate) fn get(&self) -> &[usize] {
        &self.joints[..self.count]
    }

    /// The points of these joints in the plane.
    pub(crate) fn points(&self) -> &[[f64; 2]] {
        &self.points[..self.count]
    }
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The others are never nearer to their limits than those that are kept.
        #[test]
        fn the_others_limit_nothing(
            points in prop::array::uniform7(prop::array::uniform2(-1.0..1.0_f64)),
            equal in 0..7_usize,
            factor in -2.0..2.0_f64,
            angles in prop::collection::vec(0.0..std::f64::consts::TAU, 50),
        ) {
            let mut points = points;
            // Joints that do not move along one direction, or at all, and joints that move alike.
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
                let kept = limiting.get().iter().map(|&j| value(j)).fold(0.0, f64::max);
                prop_assert!(all <= kept * (1.0 + 1e-12), "{all} {kept} {limiting:?}");
            }
        }
    }

    /// All joints but one move in proportion.
    #[test]
    fn the_largest_of_proportional_joints() {
        let points = [
            [-0.0007070155993254299, 1.6273147192234487e-5],
            [-0.0028006239711400524, 6.446104747327476e-5],
            [0.0017949684729800103, -4.131420324260653e-5],
            [-3.919993786090194e-5, 9.022521700306685e-7],
            [-0.002319949786422209, 5.339752671519828e-5],
            [0.03473593643336644, 0.003262039244813337],
            [-0.010277804378863864, 0.0002365608674402951],
        ];
        assert_eq!(LimitingJoints::new(&points).get(), [5, 6]);
    }

    #[test]
    fn corners_only() {
        let square =
            [[1.0, 1.0], [1.0, -1.0], [0.5, 0.5], [0.9, 0.0], [0.0; 2], [1.0, 0.0], [0.1, 0.9]];
        let mut found = LimitingJoints::new(&square).get().to_vec();
        found.sort_unstable();
        assert_eq!(found, [0, 1]);
    }
}
