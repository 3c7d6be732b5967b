//! Two-sided rows: `lower <= b x + a V / (2 h) <= upper`, with h the length of the cell.
//!
//! An acceleration limit is the case `-1 <= (q''_j x + q'_j V / (2 h)) / a_j <= 1`. Rows with an
//! offset c, such as the gravity part of a torque limit, have the bounds `-1 - c` and `1 - c`.

use iiwa_path::Coordinates;
use pulp::Simd;

use crate::{
    cell_functions::{Functional, Terms},
    geometry::SigmaDerivatives,
    lanes::{LANES, Lanes, Vector},
    limited_segment::largest_share,
    row_limit::PathRow,
    slack_pair::{Contribution, Decreases, InteriorStart, InteriorSteps, Sides},
};

/// One row at one place of eight cells. Functions take all rows of the place. With `LINE`, rows
/// limit acceleration and the cells are on lines: all joints move in proportion, and the single row
/// is that of the first joint to reach its limit.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BoundedRow {
    x: Lanes,
    v: Lanes,
    lower: Lanes,
    upper: Lanes,
    pub(crate) sides: Sides,
}

impl BoundedRow {
    /// Number of sides of the limit.
    pub(crate) const SIDES: usize = Sides::COUNT;

    /// Sets the bounds to -1 and 1: a row without coefficients is always feasible.
    pub(crate) fn set_bounds(rows: &mut [Self]) {
        for row in rows {
            (row.lower, row.upper) = (Lanes([-1.0; LANES]), Lanes([1.0; LANES]));
        }
    }

    /// Sets the acceleration rows of a cell of this `length` for some `coordinates`, from the
    /// reciprocals of the limits (s^2/rad). Other rows get zero coefficients.
    pub(crate) fn set_accelerations(
        rows: &mut [Self],
        lane: usize,
        coordinates: &[usize],
        [dq, ddq, _]: &SigmaDerivatives,
        length: f64,
        inverse: &Coordinates,
    ) {
        if let [line] = rows {
            return line.set_on_line(lane, largest_share(dq, inverse), length);
        }
        // dx/dsigma = V / length.
        let half = 0.5 / length;
        let (used, unused) = rows.split_at_mut(coordinates.len());
        for (row, &j) in used.iter_mut().zip(coordinates) {
            row.x.0[lane] = ddq[j] * inverse[j];
            row.v.0[lane] = dq[j] * inverse[j] * half;
        }
        for row in unused {
            (row.x.0[lane], row.v.0[lane]) = (0.0, 0.0);
        }
    }

    /// Sets the acceleration row of a cell on a line, from the largest share of a limit for an
    /// acceleration of sigma of 1 rad/s^2.
    pub(crate) fn set_on_line(&mut self, lane: usize, share: f64, length: f64) {
        self.v.0[lane] = share * (0.5 / length);
    }

    /// Sets the row of a cell of this `length` to that of a limit.
    pub(crate) fn set(&mut self, lane: usize, row: &PathRow, length: f64) {
        self.x.0[lane] = row.square;
        self.v.0[lane] = row.acceleration * (0.5 / length);
        self.lower.0[lane] = -1.0 - row.offset;
        self.upper.0[lane] = 1.0 - row.offset;
    }

    /// Multiplies the limits of a cell, minus their offsets, by the factor `by`.
    pub(crate) fn scale(&mut self, lane: usize, by: f64) {
        for coefficient in [&mut self.x, &mut self.v] {
            coefficient.0[lane] /= by;
        }
    }

    #[inline(always)]
    fn value<const LINE: bool, S: Simd>(
        &self,
        simd: S,
        r: usize,
        [x, v]: [Vector<S>; 2],
    ) -> Vector<S> {
        let along = self.v.load(simd, r) * v;
        // q'' is zero on lines.
        if LINE { along } else { self.x.load(simd, r).mul_add(x, along) }
    }

    #[inline(always)]
    fn bounds<S: Simd>(&self, simd: S, r: usize) -> [Vector<S>; 2] {
        [self.lower.load(simd, r), self.upper.load(simd, r)]
    }

    #[inline(always)]
    pub(crate) fn start<const LINE: bool, X: Functional, V: Functional, S: Simd>(
        rows: &mut [Self],
        start: &InteriorStart<S>,
        y: &[Vector<S>; 4],
    ) {
        let place = [X::of(y), V::of(y)];
        for row in rows {
            let (simd, r) = (start.simd, start.register);
            let value = row.value::<LINE, S>(simd, r, place);
            let [lower, upper] = row.bounds(simd, r);
            let min_slack = [start.min_slack * upper, -(start.min_slack * lower)];
            row.sides.start(start, value, [lower, upper], min_slack);
        }
    }

    #[inline(always)]
    pub(crate) fn add<const LINE: bool, X: Functional, V: Functional, S: Simd>(
        rows: &mut [Self],
        steps: &InteriorSteps<S>,
        y: &[Vector<S>; 4],
        sum: &mut Terms<S>,
    ) {
        let InteriorSteps { simd, register: r, .. } = *steps;
        let zero = Vector::splat(simd, 0.0);
        let place = [X::of(y), V::of(y)];
        let [mut xx, mut xv, mut vv, mut gx, mut gv] = [zero; 5];
        for row in rows {
            let (px, pv) = (row.x.load(simd, r), row.v.load(simd, r));
            let value = row.value::<LINE, S>(simd, r, place);
            let bounds = row.bounds(simd, r);
            let Contribution { weights: [a, b], slopes: [up, down], residual, .. } =
                row.sides.advance(steps, value, bounds, sum);
            sum.residual = sum.residual.max(residual);
            let (both, slope) = (a + b, up - down);
            let bv = both * pv;
            vv = bv.mul_add(pv, vv);
            gv = slope.mul_add(pv, gv);
            if !LINE {
                let bx = both * px;
                xx = bx.mul_add(px, xx);
                xv = bx.mul_add(pv, xv);
                gx = slope.mul_add(px, gx);
            }
        }
        sum.add_square::<V>(vv);
        sum.add_linear::<V>(gv);
        if !LINE {
            sum.add_square::<X>(xx);
            sum.add_product::<X, V>(xv);
            sum.add_linear::<X>(gx);
        }
    }

    /// Finds the steps of the slacks, where `y` is the state after a full step.
    #[inline(always)]
    pub(crate) fn find_steps<const LINE: bool, X: Functional, V: Functional, S: Simd>(
        rows: &mut [Self],
        r: usize,
        y: &[Vector<S>; 4],
        decreases: &mut Decreases<S>,
    ) {
        let simd = y[0].simd();
        let place = [X::of(y), V::of(y)];
        for row in rows {
            let value = row.value::<LINE, S>(simd, r, place);
            let bounds = row.bounds(simd, r);
            row.sides.find_steps(r, value, bounds, decreases);
        }
    }
}

#[cfg(test)]
mod tests {
    use pulp::Scalar;

    use super::*;
    use crate::known_motion::{INVERSE, KnownMotion, PLACES, assert_near, splat};

    fn value<const LINE: bool>(row: &BoundedRow, lane: usize, [x, v, _]: [f64; 3]) -> f64 {
        row.value::<LINE, _>(Scalar::new(), lane, splat([x, v])).largest()
    }

    #[test]
    fn acceleration_rows_are_differences_of_velocities() {
        for motion in [KnownMotion::SLOW, KnownMotion::FAST] {
            let joints = [6, 0, 3, 5];
            let (mut rows, mut line) = ([BoundedRow::default(); 4], [BoundedRow::default()]);
            for (lane, (t_s, length)) in PLACES.into_iter().enumerate() {
                let place = motion.place(t_s, length);
                let [dq, ddq, dddq] = motion.curve(t_s);
                let curve = [dq, ddq, dddq];
                BoundedRow::set_accelerations(&mut rows, lane, &joints, &curve, length, &INVERSE);
                let [_, acceleration, _] = motion.differences(t_s);
                for (row, j) in rows.iter_mut().zip(joints) {
                    let share = acceleration[j] * INVERSE[j];
                    assert_near(value::<false>(row, lane, place), share, &format!("{t_s} s, {j}"));
                    row.scale(lane, 0.8);
                    assert_near(value::<false>(row, lane, place), share / 0.8, "lowered");
                }
                // On a line with this direction.
                BoundedRow::set_accelerations(&mut line, lane, &[0], &curve, length, &INVERSE);
                let u = 0.5 * place[1] / length;
                let shares = (0..8).map(|j| (dq[j] * u * INVERSE[j]).abs()).fold(0.0, f64::max);
                assert_near(value::<true>(&line[0], lane, place).abs(), shares, "line");
            }
        }
    }

    /// Torque with parts from inertia, a velocity product and gravity.
    #[test]
    fn torque_rows_are_those_of_the_motion() {
        let (inertia, product, gravity, inverse) = (1.7, -0.6, 0.35, 0.4);
        let motion = KnownMotion::FAST;
        for (lane, (t_s, length)) in PLACES.into_iter().enumerate() {
            let [dq, ddq, _] = motion.curve(t_s).map(|derivative| derivative[2]);
            let row = PathRow {
                acceleration: inverse * inertia * dq,
                square: inverse * (inertia * ddq + product * dq * dq),
                offset: inverse * gravity,
            };
            let mut bounded = BoundedRow::default();
            bounded.set(lane, &row, length);
            let [velocity, acceleration, _] = motion.differences(t_s).map(|all| all[2]);
            let share =
                inverse * (inertia * acceleration + product * velocity * velocity + gravity);
            let place = motion.place(t_s, length);
            let actual = value::<false>(&bounded, lane, place);
            assert_near(actual + row.offset, share, &format!("{t_s} s"));
            let u = 0.5 * place[1] / length;
            assert_near(row.at(place[0].sqrt(), u), share, "share");
            // The distances from both bounds equal those of the torque.
            let [lower, upper] = bounded.bounds(Scalar::new(), lane).map(Vector::largest);
            assert_near(upper - actual, 1.0 - share, "upper");
            assert_near(actual - lower, 1.0 + share, "lower");
        }
    }
}
