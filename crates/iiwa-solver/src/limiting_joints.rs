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
    count: usize,
}

impl LimitingJoints {
    pub(crate) const ALL: Self = Self { joints: [0, 1, 2, 3, 4, 5, 6], count: 7 };

    /// The corners of the convex hull of `points` and their opposites.
    pub(crate) fn new(points: &[[f64; 2]; 7]) -> Self {
        let square = |[a, b]: [f64; 2]| a * a + b * b;
        let by_distance = |&i: &usize, &j: &usize| square(points[i]).total_cmp(&square(points[j]));
        // The farthest point is a corner. The corners from there around to its opposite are all others, or theirs.
        let farthest = (0..7).max_by(by_distance).unwrap_or_default();
        let from = points[farthest];
        let mut left: Vec<(usize, [f64; 2])> = (0..7)
            .filter_map(|j| {
                let side = cross(from, points[j]);
                let point = if side < 0.0 { points[j].map(|v| -v) } else { points[j] };
                (side != 0.0).then_some((j, point))
            })
            .collect();
        left.sort_by(|a, b| 0.0_f64.total_cmp(&cross(a.1, b.1)));
        left.push((farthest, from.map(|v| -v)));
        let mut corners = vec![(farthest, from)];
        for (j, point) in left {
            while let [.., (_, before), (_, last)] = corners[..]
                && turn(before, last, point) <= 0.0
            {
                corners.pop();
            }
            corners.push((j, point));
        }
        corners.pop();
        let mut joints = [0; 7];
        for (place, (j, _)) in joints.iter_mut().zip(&corners) {
            *place = *j;
        }
        Self { joints, count: corners.len() }
    }

    pub(crate) fn get(&self) -> &[usize] {
        &self.joints[..self.count]
    }
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Above zero where the way from `a` over `b` to `c` turns to the left.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    cross([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]])
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
            angles in prop::collection::vec(0.0..std::f64::consts::TAU, 50),
        ) {
            let mut points = points;
            // Joints that do not move along one direction, or at all, and joints that move alike.
            points[equal] = points[0];
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

    #[test]
    fn corners_only() {
        let square =
            [[1.0, 1.0], [1.0, -1.0], [0.5, 0.5], [0.9, 0.0], [0.0; 2], [1.0, 0.0], [0.1, 0.9]];
        let mut found = LimitingJoints::new(&square).get().to_vec();
        found.sort_unstable();
        assert_eq!(found, [0, 1]);
    }
}
