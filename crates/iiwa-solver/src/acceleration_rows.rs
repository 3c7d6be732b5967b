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

/// The rows of `J` coordinates at one place of eight cells. With `J` = 1, the cells are on lines: all joints move in
/// proportion, and the one that comes first at its limit stands for all.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AccelerationRows<const J: usize> {
    x: [Lanes; J],
    v: [Lanes; J],
    sides: [Sides; J],
}

impl<const J: usize> Default for AccelerationRows<J> {
    fn default() -> Self {
        let rows = [Lanes::default(); J];
        Self { x: rows, v: rows, sides: [Sides::default(); J] }
    }
}

impl<const J: usize> AccelerationRows<J> {
    /// How many sides limits have.
    pub(crate) const SIDES: usize = Sides::COUNT * J;

    /// Sets the rows of a cell of this `length` for some `coordinates`, from one over the limits (s^2/rad).
    pub(crate) fn set(
        &mut self,
        lane: usize,
        coordinates: &[usize],
        [dq, ddq, _]: &SigmaDerivatives,
        length: f64,
        inverse: &Coordinates,
    ) {
        // dx/dsigma = V / length.
        let half = 0.5 / length;
        if J == 1 {
            self.v[0].0[lane] = largest_share(dq, inverse) * half;
            return;
        }
        for (row, &j) in coordinates.iter().enumerate() {
            self.x[row].0[lane] = ddq[j] * inverse[j];
            self.v[row].0[lane] = dq[j] * inverse[j] * half;
        }
    }

    /// Lowers the limits of a cell by the factor `by`.
    pub(crate) fn scale(&mut self, lane: usize, by: f64) {
        for row in self.x.iter_mut().chain(&mut self.v) {
            row.0[lane] /= by;
        }
    }

    #[inline(always)]
    fn value<S: Simd>(&self, j: usize, simd: S, r: usize, [x, v]: [Vector<S>; 2]) -> Vector<S> {
        let along = self.v[j].load(simd, r) * v;
        // Lines do not bend.
        if J == 1 { along } else { self.x[j].load(simd, r).mul_add(x, along) }
    }

    #[inline(always)]
    pub(crate) fn start<X: Functional, V: Functional, S: Simd>(
        &mut self,
        start: &InteriorStart<S>,
        y: &[Vector<S>; 4],
    ) {
        let place = [X::of(y), V::of(y)];
        for j in 0..J {
            let value = self.value(j, start.simd, start.register, place);
            self.sides[j].start(start, value, bounds(start.simd), [start.least; 2]);
        }
    }

    #[inline(always)]
    pub(crate) fn add<X: Functional, V: Functional, S: Simd>(
        &mut self,
        steps: &InteriorSteps<S>,
        y: &[Vector<S>; 4],
        sum: &mut Terms<S>,
    ) {
        let InteriorSteps { simd, register: r, .. } = *steps;
        let zero = Vector::splat(simd, 0.0);
        let one = Vector::splat(simd, 1.0);
        let place = [X::of(y), V::of(y)];
        let [mut xx, mut xv, mut vv, mut gx, mut gv] = [zero; 5];
        for j in 0..J {
            let (px, pv) = (self.x[j].load(simd, r), self.v[j].load(simd, r));
            let value = self.value(j, simd, r, place);
            let Contribution { weights: [a, b], slopes: [up, down], .. } =
                self.sides[j].advance(steps, value, bounds(simd), one, sum);
            let (both, slope) = (a + b, up - down);
            let bv = both * pv;
            vv = bv.mul_add(pv, vv);
            gv = slope.mul_add(pv, gv);
            if J > 1 {
                let bx = both * px;
                xx = bx.mul_add(px, xx);
                xv = bx.mul_add(pv, xv);
                gx = slope.mul_add(px, gx);
            }
        }
        sum.add_square::<V>(vv);
        sum.add_linear::<V>(gv);
        if J > 1 {
            sum.add_square::<X>(xx);
            sum.add_product::<X, V>(xv);
            sum.add_linear::<X>(gx);
        }
    }

    /// `y` is the state after a full step.
    #[inline(always)]
    pub(crate) fn find_steps<X: Functional, V: Functional, S: Simd>(
        &mut self,
        r: usize,
        y: &[Vector<S>; 4],
        mu: Vector<S>,
        decreases: &mut Decreases<S>,
    ) {
        let place = [X::of(y), V::of(y)];
        for j in 0..J {
            let value = self.value(j, mu.simd(), r, place);
            self.sides[j].find_steps(r, value, bounds(mu.simd()), mu, decreases);
        }
    }
}

#[inline(always)]
fn bounds<S: Simd>(simd: S) -> [Vector<S>; 2] {
    [-1.0, 1.0].map(|bound| Vector::splat(simd, bound))
}
