//! The limit of velocity as a row: `0 <= max_j (q'_j / v_j)^2 x <= 1` at a control point of x.
//!
//! All joints share one row, the largest. The lower side keeps x positive.

use pulp::Simd;

use crate::{
    functionals::Functional,
    lanes::{Lanes, Vector},
    quadratic::Terms,
    slack_pair::{Decreases, InteriorStart, InteriorSteps, SlackPair},
};

/// The row at one control point of eight cells.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct VelocityRows {
    /// One over the largest x.
    x: Lanes,
    sides: [SlackPair; 2],
}

impl VelocityRows {
    /// How many sides limits have.
    pub(crate) const SIDES: usize = 2;

    /// Sets the row of a cell, from dq/dsigma and one over the limits (s/rad).
    pub(crate) fn set(&mut self, lane: usize, dq: &[f64; 7], inverse: &[f64; 7]) {
        let largest = std::iter::zip(dq, inverse).map(|(d, i)| (d * i).powi(2)).fold(0.0, f64::max);
        self.x.0[lane] = largest;
    }

    /// Lowers the limit of a cell by the factor `by`.
    pub(crate) fn scale(&mut self, lane: usize, by: f64) {
        self.x.0[lane] /= by * by;
    }

    #[inline(always)]
    pub(crate) fn start<X: Functional, S: Simd>(
        &mut self,
        start: &InteriorStart<S>,
        y: &[Vector<S>; 4],
    ) {
        let one = Vector::splat(start.simd, 1.0);
        let value = self.x.load(start.simd, start.register) * X::of(y);
        let [upper, lower] = &mut self.sides;
        upper.start(start, one - value, start.least);
        lower.start(start, value, start.least * value.abs());
    }

    #[inline(always)]
    pub(crate) fn add<X: Functional, S: Simd>(
        &mut self,
        steps: &InteriorSteps<S>,
        y: &[Vector<S>; 4],
        sum: &mut Terms<S>,
    ) {
        let one = Vector::splat(steps.simd, 1.0);
        let row = self.x.load(steps.simd, steps.register);
        let value = row * X::of(y);
        let [a, b] = &mut self.sides;
        let (a, b) = (a.advance(steps), b.advance(steps));
        let miss = [value - one + a.s, b.s - value];
        sum.gap = a.s.mul_add(a.z, b.s.mul_add(b.z, sum.gap));
        sum.residual = sum.residual.max(miss[0].abs()).max(miss[1].abs());
        sum.add_square::<X>((a.weight + b.weight) * row * row);
        sum.add_linear::<X>((a.slope(steps, miss[0]) - b.slope(steps, miss[1])) * row);
    }

    /// `y` is the state after a full step.
    #[inline(always)]
    pub(crate) fn find_steps<X: Functional, S: Simd>(
        &mut self,
        r: usize,
        y: &[Vector<S>; 4],
        mu: Vector<S>,
        decreases: &mut Decreases<S>,
    ) {
        let one = Vector::splat(mu.simd(), 1.0);
        let value = self.x.load(mu.simd(), r) * X::of(y);
        decreases.add(&mut self.sides, r, [one - value, value], mu);
    }
}
