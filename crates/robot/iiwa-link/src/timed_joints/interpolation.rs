//! Interpolation between the points of a trajectory.

use iiwa_kin::Joints;

use super::points::TimedJoints;

impl TimedJoints {
    /// Returns joint positions `t_s` after the start, in rad. Times outside the trajectory are
    /// clamped.
    ///
    /// Points are connected by cubics. The slopes are the slopes of parabolas through three points,
    /// and zero where a joint is at rest: at both ends, and beside steps without motion. Beside
    /// rest the slopes are limited so that a joint does not overshoot its stop position, which may
    /// be the end of its range.
    #[must_use]
    pub fn at(&self, t_s: f64) -> Joints {
        // An unchecked trajectory may have a different number of stamps and points.
        let count = self.t_s.len().min(self.joints_rad.len());
        let (stamps, points) = (&self.t_s[..count], &self.joints_rad[..count]);
        let ([first_s, ..], [first, .., last]) = (stamps, points) else {
            return points.first().copied().unwrap_or_default();
        };
        // The start stamp is subtracted first: added to a large stamp, milliseconds would be
        // rounded off.
        let next = stamps.partition_point(|stamp| stamp - first_s <= t_s);
        if next == 0 {
            return *first;
        }
        if next >= count {
            return *last;
        }
        let i = next - 1;
        let h = stamps[next] - stamps[i];
        let x = (t_s - (stamps[i] - first_s)) / h;
        let (from, to) = (&points[i], &points[next]);
        let (before, after) = (self.slope(i), self.slope(next));
        std::array::from_fn(|j| {
            let rise = to[j] - from[j];
            let (a, b) = (before[j] * h - rise, rise - after[j] * h);
            from[j] + x * rise + x * (1.0 - x) * ((1.0 - x) * a + x * b)
        })
    }

    /// Returns the slopes at a point, in rad/s.
    ///
    /// A cubic between two points stays between them if its slopes there have the sign of its
    /// secant and are at most three times as steep (Fritsch and Carlson 1980). This is enforced for
    /// two points beside rest only: elsewhere it would distort the slope near points where a joint
    /// reverses.
    fn slope(&self, i: usize) -> Joints {
        let last = self.t_s.len().min(self.joints_rad.len()) - 1;
        if i == 0 || i >= last {
            return [0.0; 7];
        }
        let (before, after) = (self.t_s[i] - self.t_s[i - 1], self.t_s[i + 1] - self.t_s[i]);
        std::array::from_fn(|j| {
            let [a, b, c] = [i - 1, i, i + 1].map(|k| self.joints_rad[k][j]);
            let (from, to) = ((b - a) / before, (c - b) / after);
            if from == 0.0 || to == 0.0 {
                return 0.0;
            }
            let mut slope = (from * after + to * before) / (before + after);
            if self.rests_before(i, j) {
                slope = within_secant(slope, from);
            }
            if self.rests_from(i, j, last) {
                slope = within_secant(slope, to);
            }
            slope
        })
    }

    /// Returns true if joint `j` was at rest one or two points before point `i`.
    fn rests_before(&self, i: usize, j: usize) -> bool {
        let q = |k: usize| self.joints_rad[k][j];
        i <= 2 || q(i - 2) == q(i - 1) || q(i - 3) == q(i - 2)
    }

    /// Returns true if joint `j` is at rest from one or two points after point `i`; `last` is the
    /// last point.
    fn rests_from(&self, i: usize, j: usize, last: usize) -> bool {
        let q = |k: usize| self.joints_rad[k][j];
        i + 2 >= last || q(i + 1) == q(i + 2) || q(i + 2) == q(i + 3)
    }
}

/// Limits the slope so that a cubic with this slope at one end and zero at the other stays between
/// its ends.
fn within_secant(slope: f64, secant: f64) -> f64 {
    let [low, high] = if secant > 0.0 { [0.0, 3.0 * secant] } else { [3.0 * secant, 0.0] };
    // Not `clamp`, which panics if a bound is NaN.
    slope.max(low).min(high)
}
