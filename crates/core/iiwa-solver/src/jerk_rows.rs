//! Jerk limits as rows, and the duration.
//!
//! The jerk of joint j is `sqrt(x) (q'''_j x + 3/2 q''_j V / h + 1/2 q'_j W / h^2)`, with h the
//! length of the cell. Division by sqrt(x) and by the limit makes the left side linear in the
//! state. The bound becomes `x^(-1/2)`, the integrand of the duration, which is convex in x.

use iiwa_path::Coordinates;
use pulp::Simd;

use crate::{
    cell_functions::{Functional, Terms},
    geometry::SigmaDerivatives,
    lanes::{Lanes, Vector},
    limited_segment::largest_share,
    settings::InteriorPointSettings,
    slack_pair::{Contribution, Decreases, InteriorStart, InteriorSteps, Sides},
};

const SETTINGS: InteriorPointSettings = crate::settings::SETTINGS.interior_point;

/// Row of one coordinate at one place of eight cells. Functions take the rows of all coordinates at
/// the place; with `LINE` there is a single row for all joints.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct JerkRow {
    x: Lanes,
    v: Lanes,
    w: Lanes,
    pub(crate) sides: Sides,
}

impl JerkRow {
    /// Number of sides of the limit.
    pub(crate) const SIDES: usize = Sides::COUNT;

    /// Sets the rows of a cell of this `length` for some `coordinates`, from the reciprocals of the
    /// limits (s^3/rad). Other rows get zero coefficients.
    pub(crate) fn set(
        rows: &mut [Self],
        lane: usize,
        coordinates: &[usize],
        [dq, ddq, dddq]: &SigmaDerivatives,
        length: f64,
        inverse: &Coordinates,
    ) {
        if let [line] = rows {
            return line.set_on_line(lane, largest_share(dq, inverse), length);
        }
        let (one, two) = (1.5 / length, 0.5 / (length * length));
        let (used, unused) = rows.split_at_mut(coordinates.len());
        for (row, &j) in used.iter_mut().zip(coordinates) {
            row.x.0[lane] = dddq[j] * inverse[j];
            row.v.0[lane] = ddq[j] * inverse[j] * one;
            row.w.0[lane] = dq[j] * inverse[j] * two;
        }
        for row in unused {
            (row.x.0[lane], row.v.0[lane], row.w.0[lane]) = (0.0, 0.0, 0.0);
        }
    }

    /// Sets the row of a cell on a line, from the largest share of a limit for a jerk of sigma of
    /// 1 rad/s^3.
    pub(crate) fn set_on_line(&mut self, lane: usize, share: f64, length: f64) {
        self.w.0[lane] = share * (0.5 / (length * length));
    }

    /// Tightens the limits of a cell by the factor `by`.
    pub(crate) fn scale(&mut self, lane: usize, by: f64) {
        for coefficient in [&mut self.x, &mut self.v, &mut self.w] {
            coefficient.0[lane] /= by;
        }
    }

    #[inline(always)]
    fn value<const LINE: bool, S: Simd>(
        &self,
        simd: S,
        r: usize,
        [x, v, w]: [Vector<S>; 3],
    ) -> Vector<S> {
        let along = self.w.load(simd, r) * w;
        // q'' and q''' are zero on lines.
        if LINE {
            return along;
        }
        self.x.load(simd, r).mul_add(x, self.v.load(simd, r).mul_add(v, along))
    }

    #[inline(always)]
    pub(crate) fn start<const LINE: bool, X: Functional, V: Functional, W: Functional, S: Simd>(
        rows: &mut [Self],
        start: &InteriorStart<S>,
        y: &[Vector<S>; 4],
    ) {
        let place = [X::of(y), V::of(y), W::of(y)];
        let bound = place[0].sqrt().inverse();
        for row in rows {
            let value = row.value::<LINE, S>(start.simd, start.register, place);
            let min_slack = [start.min_slack * bound; 2];
            row.sides.start(start, value, [-bound, bound], min_slack);
        }
    }

    /// Adds the rows, and `weight x^(-1/2)` of the duration.
    #[inline(always)]
    pub(crate) fn add<const LINE: bool, X: Functional, V: Functional, W: Functional, S: Simd>(
        rows: &mut [Self],
        steps: &InteriorSteps<S>,
        y: &[Vector<S>; 4],
        weight: Vector<S>,
        sum: &mut Terms<S>,
    ) {
        let InteriorSteps { simd, register: r, .. } = *steps;
        let zero = Vector::splat(simd, 0.0);
        let place = [X::of(y), V::of(y), W::of(y)];
        let root = place[0].sqrt();
        let inverse = place[0].inverse();
        let bound = root * inverse;
        let bound_slope = bound * inverse * -0.5;
        let [mut xx, mut xv, mut xw, mut vv, mut vw, mut ww] = [zero; 6];
        let [mut gx, mut gv, mut gw] = [zero; 3];
        // Factors of the slope of the bound: sums and differences over the two sides.
        let [mut ex, mut ev, mut ew, mut weights, mut slopes, mut duals, mut largest] = [zero; 7];
        for row in rows {
            let (jx, jv, jw) = (row.x.load(simd, r), row.v.load(simd, r), row.w.load(simd, r));
            let value = row.value::<LINE, S>(simd, r, place);
            let Contribution { weights: [a, b], slopes: [up, down], duals: of_row, residual } =
                row.sides.advance(steps, value, [-bound, bound], sum);
            largest = largest.max(residual);
            let (both, apart) = (a + b, a - b);
            let apart_slope = up - down;
            let bw = both * jw;
            ww = bw.mul_add(jw, ww);
            gw = apart_slope.mul_add(jw, gw);
            ew = apart.mul_add(jw, ew);
            if !LINE {
                let (bx, bv) = (both * jx, both * jv);
                xx = bx.mul_add(jx, xx);
                xv = bx.mul_add(jv, xv);
                xw = bx.mul_add(jw, xw);
                vv = bv.mul_add(jv, vv);
                vw = bv.mul_add(jw, vw);
                gx = apart_slope.mul_add(jx, gx);
                gv = apart_slope.mul_add(jv, gv);
                ex = apart.mul_add(jx, ex);
                ev = apart.mul_add(jv, ev);
            }
            weights = weights + both;
            slopes = slopes + up + down;
            duals = duals + of_row;
        }
        // Jerk relative to its limit is root times the value of the row.
        sum.residual = sum.residual.max(largest * root);
        // The curvature of the Lagrangian in x is (weight - duals) 3/4 x^(-5/2), negative where
        // duals are large. The step needs a convex model, so the curvature enters by its magnitude,
        // bounded from below.
        let curvature = (weight - duals).abs().max(weight * SETTINGS.kept_curvature);
        let curvature = bound * inverse * inverse * curvature * 0.75;
        xx = bound_slope.mul_add(bound_slope * weights - ex * 2.0, xx + curvature);
        xw = xw - bound_slope * ew;
        gx = bound_slope.mul_add(weight - slopes, gx);
        sum.add_square::<X>(xx);
        sum.add_product::<X, W>(xw);
        sum.add_square::<W>(ww);
        sum.add_linear::<X>(gx);
        sum.add_linear::<W>(gw);
        if !LINE {
            sum.add_product::<X, V>(xv - bound_slope * ev);
            sum.add_square::<V>(vv);
            sum.add_product::<V, W>(vw);
            sum.add_linear::<V>(gv);
        }
    }

    /// Finds the steps of the slacks, where `before` is the state and `after` the state after
    /// a full step.
    #[inline(always)]
    pub(crate) fn find_steps<
        const LINE: bool,
        X: Functional,
        V: Functional,
        W: Functional,
        S: Simd,
    >(
        rows: &mut [Self],
        r: usize,
        [before, after]: [&[Vector<S>; 4]; 2],
        decreases: &mut Decreases<S>,
    ) {
        let simd = before[0].simd();
        let one = Vector::splat(simd, 1.0);
        let x = X::of(before);
        let place = [X::of(after), V::of(after), W::of(after)];
        let inverse = x.inverse();
        let growth = (place[0] - x) * inverse;
        // The bound, linearised about x.
        let bound = x.sqrt() * inverse * (one - growth * 0.5);
        decreases.x = decreases.x.max(-growth);
        for row in rows {
            let value = row.value::<LINE, S>(simd, r, place);
            row.sides.find_steps(r, value, [-bound, bound], decreases);
        }
    }
}

#[cfg(test)]
mod tests {
    use pulp::Scalar;

    use super::*;
    use crate::known_motion::{INVERSE, KnownMotion, PLACES, assert_near, splat};

    #[test]
    fn rows_are_differences_of_accelerations() {
        for motion in [KnownMotion::SLOW, KnownMotion::FAST] {
            let joints = [1, 4, 2, 7];
            let (mut rows, mut line) = ([JerkRow::default(); 4], [JerkRow::default()]);
            for (lane, (t_s, length)) in PLACES.into_iter().enumerate() {
                let place = motion.place(t_s, length);
                let root = place[0].sqrt();
                let curve = motion.curve(t_s);
                JerkRow::set(&mut rows, lane, &joints, &curve, length, &INVERSE);
                let [_, _, jerk] = motion.differences(t_s);
                for (row, j) in rows.iter_mut().zip(joints) {
                    let row_value = |row: &JerkRow| {
                        row.value::<false, _>(Scalar::new(), lane, splat(place)).largest() * root
                    };
                    let share = jerk[j] * INVERSE[j];
                    assert_near(row_value(row), share, &format!("{t_s} s, {j}"));
                    row.scale(lane, 0.8);
                    assert_near(row_value(row), share / 0.8, "lowered");
                }
                // On a line with this direction, jerk is proportional to half the second derivative
                // of x with respect to sigma.
                JerkRow::set(&mut line, lane, &[0], &curve, length, &INVERSE);
                let rate = 0.5 * place[2] / length.powi(2);
                let share =
                    (0..8).map(|j| (curve[0][j] * rate * INVERSE[j]).abs()).fold(0.0, f64::max);
                let actual = line[0].value::<true, _>(Scalar::new(), lane, splat(place));
                assert_near(actual.largest().abs(), share, "line");
            }
        }
    }
}
