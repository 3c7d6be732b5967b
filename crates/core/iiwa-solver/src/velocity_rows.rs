//! Velocity limits as a row: `0 <= max_j (q'_j / v_j)^2 x <= 1` at a control point of x.
//!
//! One row, the largest, serves all coordinates. Its lower side keeps x positive.

use iiwa_path::Coordinates;
use pulp::Simd;

use crate::{
    cell_functions::{Functional, Terms},
    lanes::{Lanes, Vector},
    limited_segment::largest_share,
    slack_pair::{Contribution, Decreases, InteriorStart, InteriorSteps, Sides},
};

/// Row at one control point of eight cells.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct VelocityRows {
    /// Reciprocal of the largest feasible x.
    x: Lanes,
    pub(crate) sides: Sides,
}

impl VelocityRows {
    /// Number of sides of the limit.
    pub(crate) const SIDES: usize = Sides::COUNT;

    /// Sets the row of a cell from dq/dsigma and the reciprocals of the limits (s/rad).
    pub(crate) fn set(&mut self, lane: usize, dq: &Coordinates, inverse: &Coordinates) {
        self.set_on_line(lane, largest_share(dq, inverse));
    }

    /// Sets the row of a cell on a line, from the largest share of a limit for a speed of sigma of
    /// 1 rad/s.
    pub(crate) fn set_on_line(&mut self, lane: usize, share: f64) {
        self.x.0[lane] = share * share;
    }

    /// Tightens the limit of a cell by the factor `by`.
    pub(crate) fn scale(&mut self, lane: usize, by: f64) {
        // The row is in the square of the speed.
        self.x.0[lane] /= by * by;
    }

    #[inline(always)]
    pub(crate) fn start<X: Functional, S: Simd>(
        &mut self,
        start: &InteriorStart<S>,
        y: &[Vector<S>; 4],
    ) {
        let value = self.x.load(start.simd, start.register) * X::of(y);
        // Near the lower bound, x may change by orders of magnitude: the least slack is a share of
        // x itself.
        let min_slack = [start.min_slack, start.min_slack * value.abs()];
        self.sides.start(start, value, bounds(start.simd), min_slack);
    }

    #[inline(always)]
    pub(crate) fn add<X: Functional, S: Simd>(
        &mut self,
        steps: &InteriorSteps<S>,
        y: &[Vector<S>; 4],
        sum: &mut Terms<S>,
    ) {
        let row = self.x.load(steps.simd, steps.register);
        let value = row * X::of(y);
        let Contribution { weights: [a, b], slopes: [up, down], residual, .. } =
            self.sides.advance(steps, value, bounds(steps.simd), sum);
        sum.residual = sum.residual.max(residual);
        sum.add_square::<X>((a + b) * row * row);
        sum.add_linear::<X>((up - down) * row);
    }

    /// Finds the steps of the slacks, where `y` is the state after a full step.
    #[inline(always)]
    pub(crate) fn find_steps<X: Functional, S: Simd>(
        &mut self,
        r: usize,
        y: &[Vector<S>; 4],
        decreases: &mut Decreases<S>,
    ) {
        let simd = y[0].simd();
        let value = self.x.load(simd, r) * X::of(y);
        self.sides.find_steps(r, value, bounds(simd), decreases);
    }
}

#[inline(always)]
fn bounds<S: Simd>(simd: S) -> [Vector<S>; 2] {
    [0.0, 1.0].map(|bound| Vector::splat(simd, bound))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::known_motion::{INVERSE, KnownMotion, PLACES, assert_near};

    #[test]
    fn rows_are_squares_of_differences_of_positions() {
        let motion = KnownMotion::FAST;
        let mut row = VelocityRows::default();
        for (lane, (t_s, length)) in PLACES.into_iter().enumerate() {
            let [dq, ..] = motion.curve(t_s);
            row.set(lane, &dq, &INVERSE);
            let [velocity, ..] = motion.differences(t_s);
            let share = (0..8).map(|j| (velocity[j] * INVERSE[j]).abs()).fold(0.0, f64::max);
            let [x, ..] = motion.place(t_s, length);
            assert_near(row.x.0[lane] * x, share * share, &format!("{t_s} s"));
            row.scale(lane, 0.8);
            assert_near(row.x.0[lane] * x, (share / 0.8).powi(2), "lowered");
        }
    }
}
