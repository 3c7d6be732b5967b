//! Limits of torque as rows: `-1 - g_j <= c_j x + m_j V / (2 h) <= 1 - g_j`, h the length of a cell, with the parts of the
//! torque of joint j that go with the square of the speed, with acceleration and with neither, over its limit.

use iiwa_kin::PathTorques;
use pulp::Simd;

use crate::{
    functionals::Functional,
    lanes::{Lanes, Vector},
    quadratic::Terms,
    slack_pair::{Contribution, Decreases, InteriorStart, InteriorSteps, Sides},
};

/// The rows of some joints at one place of eight cells.
#[derive(Clone, Debug, Default)]
pub(crate) struct TorqueRows(Vec<TorqueRow>);

/// The row of one joint.
#[derive(Clone, Copy, Debug)]
struct TorqueRow {
    x: Lanes,
    v: Lanes,
    lower: Lanes,
    upper: Lanes,
    sides: Sides,
}

/// A row that nothing reaches.
impl Default for TorqueRow {
    fn default() -> Self {
        let [x, v] = [Lanes::default(); 2];
        let [lower, upper] = [-1.0, 1.0].map(|bound| Lanes::from_fn(|_| bound));
        Self { x, v, lower, upper, sides: Sides::default() }
    }
}

impl TorqueRows {
    /// Rows of so many joints, which limit nothing yet.
    pub(crate) fn new(joints: usize) -> Self {
        Self(vec![TorqueRow::default(); joints])
    }

    /// How many sides limits have.
    pub(crate) fn sides(&self) -> usize {
        Sides::COUNT * self.0.len()
    }

    /// Sets the rows of a cell of this `length` for some `joints`, from the shares of their torques.
    pub(crate) fn set(&mut self, lane: usize, joints: &[usize], shares: &PathTorques, length: f64) {
        // dx/dsigma = V / length.
        let half = 0.5 / length;
        for (row, &j) in self.0.iter_mut().zip(joints) {
            row.x.0[lane] = shares.speed[j];
            row.v.0[lane] = shares.acceleration[j] * half;
            row.lower.0[lane] = -1.0 - shares.gravity[j];
            row.upper.0[lane] = 1.0 - shares.gravity[j];
        }
    }

    /// Lowers what gravity leaves in a cell by the factor `by`.
    pub(crate) fn scale(&mut self, lane: usize, by: f64) {
        for row in &mut self.0 {
            row.lower.0[lane] *= by;
            row.upper.0[lane] *= by;
        }
    }

    #[inline(always)]
    pub(crate) fn start<X: Functional, V: Functional, S: Simd>(
        &mut self,
        start: &InteriorStart<S>,
        y: &[Vector<S>; 4],
    ) {
        let place = [X::of(y), V::of(y)];
        for row in &mut self.0 {
            let (simd, r) = (start.simd, start.register);
            let value = row.value(simd, r, place);
            let [lower, upper] = row.bounds(simd, r);
            let least = [start.least * upper, -(start.least * lower)];
            row.sides.start(start, value, [lower, upper], least);
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
        let one = Vector::splat(simd, 1.0);
        let place = [X::of(y), V::of(y)];
        let [mut xx, mut xv, mut vv, mut gx, mut gv] = [Vector::splat(simd, 0.0); 5];
        for row in &mut self.0 {
            let (px, pv) = (row.x.load(simd, r), row.v.load(simd, r));
            let value = row.value(simd, r, place);
            let bounds = row.bounds(simd, r);
            let Contribution { weights: [a, b], slopes: [up, down], .. } =
                row.sides.advance(steps, value, bounds, one, sum);
            let (both, slope) = (a + b, up - down);
            let [bx, bv] = [both * px, both * pv];
            xx = bx.mul_add(px, xx);
            xv = bx.mul_add(pv, xv);
            vv = bv.mul_add(pv, vv);
            gx = slope.mul_add(px, gx);
            gv = slope.mul_add(pv, gv);
        }
        sum.add_square::<X>(xx);
        sum.add_product::<X, V>(xv);
        sum.add_square::<V>(vv);
        sum.add_linear::<X>(gx);
        sum.add_linear::<V>(gv);
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
        for row in &mut self.0 {
            let value = row.value(mu.simd(), r, place);
            let bounds = row.bounds(mu.simd(), r);
            row.sides.find_steps(r, value, bounds, mu, decreases);
        }
    }
}

impl TorqueRow {
    #[inline(always)]
    fn value<S: Simd>(&self, simd: S, r: usize, [x, v]: [Vector<S>; 2]) -> Vector<S> {
        self.x.load(simd, r).mul_add(x, self.v.load(simd, r) * v)
    }

    #[inline(always)]
    fn bounds<S: Simd>(&self, simd: S, r: usize) -> [Vector<S>; 2] {
        [self.lower.load(simd, r), self.upper.load(simd, r)]
    }
}
