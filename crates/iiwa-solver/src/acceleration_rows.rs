//! Limits of acceleration as rows: `-1 <= (q''_j x + q'_j V / (2 h)) / a_j <= 1`, h the length of a cell.

use iiwa_path::Coordinates;
use pulp::Simd;

use crate::{
    functionals::Functional,
    geometry::SigmaDerivatives,
    lanes::{Lanes, Vector},
    limited_segment::largest_share,
    quadratic::Terms,
    slack_pair::{Contribution, Decreases, InteriorStart, InteriorSteps, Sides},
};

/// The row of one coordinate at one place of eight cells. Functions take the rows of all coordinates at the place. With `LINE`, the cells
/// are on lines: all joints move in proportion, and the row is that of the first joint at its limit.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct AccelerationRow {
    x: Lanes,
    v: Lanes,
    sides: Sides,
}

impl AccelerationRow {
    /// Number of sides of the limit.
    pub(crate) const SIDES: usize = Sides::COUNT;

    /// Sets the rows of a cell of this `length` for some `coordinates`, from one over the limits (s^2/rad).
    pub(crate) fn set(
        rows: &mut [Self],
        lane: usize,
        coordinates: &[usize],
        [dq, ddq, _]: &SigmaDerivatives,
        length: f64,
        inverse: &Coordinates,
    ) {
        // dx/dsigma = V / length.
        let half = 0.5 / length;
        if let [line] = rows {
            line.v.0[lane] = largest_share(dq, inverse) * half;
            return;
        }
        for (row, &j) in rows.iter_mut().zip(coordinates) {
            row.x.0[lane] = ddq[j] * inverse[j];
            row.v.0[lane] = dq[j] * inverse[j] * half;
        }
    }

    /// Lowers the limits of a cell by the factor `by`.
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
        // Lines do not bend.
        if LINE { along } else { self.x.load(simd, r).mul_add(x, along) }
    }

    #[inline(always)]
    pub(crate) fn start<const LINE: bool, X: Functional, V: Functional, S: Simd>(
        rows: &mut [Self],
        start: &InteriorStart<S>,
        y: &[Vector<S>; 4],
    ) {
        let place = [X::of(y), V::of(y)];
        for row in rows {
            let value = row.value::<LINE, S>(start.simd, start.register, place);
            row.sides.start(start, value, bounds(start.simd), [start.least; 2]);
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
        let one = Vector::splat(simd, 1.0);
        let place = [X::of(y), V::of(y)];
        let [mut xx, mut xv, mut vv, mut gx, mut gv] = [zero; 5];
        for row in rows {
            let (px, pv) = (row.x.load(simd, r), row.v.load(simd, r));
            let value = row.value::<LINE, S>(simd, r, place);
            let Contribution { weights: [a, b], slopes: [up, down], .. } =
                row.sides.advance(steps, value, bounds(simd), one, sum);
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

    /// `y` is the state after a full step.
    #[inline(always)]
    pub(crate) fn find_steps<const LINE: bool, X: Functional, V: Functional, S: Simd>(
        rows: &mut [Self],
        r: usize,
        y: &[Vector<S>; 4],
        mu: Vector<S>,
        decreases: &mut Decreases<S>,
    ) {
        let place = [X::of(y), V::of(y)];
        for row in rows {
            let value = row.value::<LINE, S>(mu.simd(), r, place);
            row.sides.find_steps(r, value, bounds(mu.simd()), mu, decreases);
        }
    }
}

#[inline(always)]
fn bounds<S: Simd>(simd: S) -> [Vector<S>; 2] {
    [-1.0, 1.0].map(|bound| Vector::splat(simd, bound))
}
