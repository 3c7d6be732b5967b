//! Slacks and duals of the two bounds of a row, and their update by a step.

use pulp::Simd;

use crate::{
    cell_functions::Terms,
    lanes::{Lanes, Vector},
    settings::InteriorPointSettings,
};

const SETTINGS: InteriorPointSettings = crate::settings::SETTINGS.interior_point;

/// Initial slacks and duals: their products, the least slack as a share of its bound, and the
/// factor by which a dual may differ from mu over its slack.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlackStart {
    pub(crate) mu: f64,
    pub(crate) min_slack: f64,
    pub(crate) kept: f64,
}

/// A step: mu, and the primal and dual step lengths in (0, 1].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct InteriorStep {
    pub(crate) mu: f64,
    pub(crate) primal: f64,
    pub(crate) dual: f64,
}

/// The last step and the next one, for one register of lanes.
pub(crate) struct InteriorSteps<S: Simd> {
    pub(crate) simd: S,
    pub(crate) register: usize,
    last_mu: Vector<S>,
    primal: Vector<S>,
    dual: Vector<S>,
    mu: Vector<S>,
    min_share: Vector<S>,
}

impl<S: Simd> InteriorSteps<S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, register: usize, last: InteriorStep, next: InteriorStep) -> Self {
        let splat = |value| Vector::splat(simd, value);
        Self {
            simd,
            register,
            last_mu: splat(last.mu),
            primal: splat(last.primal),
            dual: splat(last.dual),
            mu: splat(next.mu),
            min_share: splat(SETTINGS.min_share),
        }
    }
}

/// Initial slacks and duals, for one register of lanes.
pub(crate) struct InteriorStart<S: Simd> {
    pub(crate) simd: S,
    pub(crate) register: usize,
    /// Products of slacks and duals.
    pub(crate) mu: Vector<S>,
    /// Least slack, as a share of the bound.
    pub(crate) min_slack: Vector<S>,
    /// Factor by which a dual may differ from mu over its slack, either way; 1 resets the dual.
    pub(crate) kept: f64,
}

impl<S: Simd> InteriorStart<S> {
    #[inline(always)]
    pub(crate) fn new(
        simd: S,
        register: usize,
        SlackStart { mu, min_slack, kept }: SlackStart,
    ) -> Self {
        let [mu, min_slack] = [mu, min_slack].map(|value| Vector::splat(simd, value));
        Self { simd, register, mu, min_slack, kept }
    }
}

/// Slack and dual of one bound of a row.
#[derive(Clone, Copy, Debug, Default)]
struct SlackPair {
    s: Lanes,
    z: Lanes,
    /// Reciprocal of the slack, stored because division is slow.
    inverse: Lanes,
    /// Step of the slack, from which that of the dual follows.
    ds: Lanes,
}

/// A slack pair after its last step.
struct Advanced<S: Simd> {
    s: Vector<S>,
    z: Vector<S>,
    inverse: Vector<S>,
    /// z / s, the weight of the row after elimination of slack and dual.
    weight: Vector<S>,
}

impl<S: Simd> Advanced<S> {
    /// Contribution of the slack to the slope when its row has the residual `miss`.
    #[inline(always)]
    fn slope(&self, steps: &InteriorSteps<S>, miss: Vector<S>) -> Vector<S> {
        steps.mu.mul_add(self.inverse, self.weight * miss)
    }
}

/// Both sides of a row: the slack pairs of its upper and of its lower bound.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sides([SlackPair; 2]);

/// Contributions of both sides of a row to a step: of the upper bound and of the lower one.
pub(crate) struct Contribution<S: Simd> {
    /// z / s.
    pub(crate) weights: [Vector<S>; 2],
    /// Slopes: of the upper side by the value of the row, of the lower side by its negative.
    pub(crate) slopes: [Vector<S>; 2],
    /// Sum of both duals.
    pub(crate) duals: Vector<S>,
    /// Larger one of both residuals.
    pub(crate) residual: Vector<S>,
}

impl Sides {
    /// Number of sides of a row.
    pub(crate) const COUNT: usize = 2;

    /// Sets the slacks to the distances from the bounds `[lower, upper]`, but at least to
    /// `min_slack`; in that array, the upper side is first.
    #[inline(always)]
    pub(crate) fn start<S: Simd>(
        &mut self,
        start: &InteriorStart<S>,
        value: Vector<S>,
        [lower, upper]: [Vector<S>; 2],
        min_slack: [Vector<S>; 2],
    ) {
        let Self([above, below]) = self;
        above.start(start, upper - value, min_slack[0]);
        below.start(start, value - lower, min_slack[1]);
    }

    /// Applies the last step, and adds the row to the gap.
    #[inline(always)]
    pub(crate) fn advance<S: Simd>(
        &mut self,
        steps: &InteriorSteps<S>,
        value: Vector<S>,
        [lower, upper]: [Vector<S>; 2],
        sum: &mut Terms<S>,
    ) -> Contribution<S> {
        let Self([above, below]) = self;
        let (above, below) = (above.advance(steps), below.advance(steps));
        let misses = [value - upper + above.s, below.s - value + lower];
        sum.gap = above.s.mul_add(above.z, below.s.mul_add(below.z, sum.gap));
        Contribution {
            weights: [above.weight, below.weight],
            slopes: [above.slope(steps, misses[0]), below.slope(steps, misses[1])],
            duals: above.z + below.z,
            residual: misses[0].abs().max(misses[1].abs()),
        }
    }

    /// Sets the steps that make the slacks equal to the distances from the bounds at `value`.
    #[inline(always)]
    pub(crate) fn find_steps<S: Simd>(
        &mut self,
        r: usize,
        value: Vector<S>,
        [lower, upper]: [Vector<S>; 2],
        decreases: &mut Decreases<S>,
    ) {
        let Self([above, below]) = self;
        let above = above.find_step(r, upper - value);
        let below = below.find_step(r, value - lower);
        decreases.least_growth = decreases.least_growth.min(above).min(below);
        decreases.largest_growth = decreases.largest_growth.max(above).max(below);
    }

    /// Raises the largest decrease of duals to that of these, after [`Self::find_steps`].
    #[inline(always)]
    pub(crate) fn raise_dual_decrease<S: Simd>(
        &self,
        r: usize,
        mu: Vector<S>,
        decreases: &mut Decreases<S>,
    ) {
        let Self([above, below]) = self;
        let (above, below) = (above.dual_decrease(r, mu), below.dual_decrease(r, mu));
        decreases.dual = decreases.dual.max(above).max(below);
    }
}

impl SlackPair {
    /// Sets the slack to `room`, but at least to `min_slack`.
    #[inline(always)]
    fn start<S: Simd>(&mut self, start: &InteriorStart<S>, room: Vector<S>, min_slack: Vector<S>) {
        let (simd, r) = (start.simd, start.register);
        let s = room.max(min_slack);
        let inverse = s.inverse();
        let balanced = start.mu * inverse;
        // The dual before a reset may be NaN, or belong to another problem: it is not read.
        let z = if start.kept == 1.0 {
            balanced
        } else {
            let z = self.z.load(simd, r);
            z.max(balanced * (1.0 / start.kept)).min(balanced * start.kept)
        };
        self.s.store(r, s);
        self.inverse.store(r, inverse);
        self.z.store(r, z);
        self.ds = Lanes::default();
    }

    /// Applies the last step. Each slack and dual stops at its own boundary, so that a few of them
    /// near to it do not shorten the step of all others.
    #[inline(always)]
    fn advance<S: Simd>(&mut self, steps: &InteriorSteps<S>) -> Advanced<S> {
        let InteriorSteps { simd, register: r, .. } = *steps;
        let (s, z) = (self.s.load(simd, r), self.z.load(simd, r));
        let (ds, inverse) = (self.ds.load(simd, r), self.inverse.load(simd, r));
        // Linearised complementarity: s z + s dz + z ds = mu.
        let dz = (steps.last_mu - z * ds).mul_add(inverse, -z);
        let s = steps.primal.mul_add(ds, s).max(steps.min_share * s);
        let z = steps.dual.mul_add(dz, z).max(steps.min_share * z);
        let inverse = s.inverse();
        self.s.store(r, s);
        self.z.store(r, z);
        self.inverse.store(r, inverse);
        Advanced { s, z, inverse, weight: z * inverse }
    }

    /// Sets the step that makes the slack equal to `room`. Returns the relative growth of the slack
    /// in a full step.
    #[inline(always)]
    fn find_step<S: Simd>(&mut self, r: usize, room: Vector<S>) -> Vector<S> {
        let simd = room.simd();
        let ds = room - self.s.load(simd, r);
        self.ds.store(r, ds);
        ds * self.inverse.load(simd, r)
    }

    /// Relative decrease of the dual in a full step, `1 + ds / s - mu / (s z)`: by linearised
    /// complementarity, `dz = (mu - z ds) / s - z`.
    #[inline(always)]
    fn dual_decrease<S: Simd>(&self, r: usize, mu: Vector<S>) -> Vector<S> {
        let simd = mu.simd();
        let (z, ds) = (self.z.load(simd, r), self.ds.load(simd, r));
        let inverse = self.inverse.load(simd, r);
        let one = Vector::splat(simd, 1.0);
        ds.mul_add(inverse, one) - mu * inverse * z.inverse()
    }
}

/// Largest relative decreases of slacks, duals and x in a full step, for one register of lanes.
pub(crate) struct Decreases<S: Simd> {
    /// Least and largest relative growth of a slack; below zero where a slack decreases.
    least_growth: Vector<S>,
    largest_growth: Vector<S>,
    pub(crate) dual: Vector<S>,
    pub(crate) x: Vector<S>,
}

impl<S: Simd> Decreases<S> {
    /// Largest relative decrease of a slack.
    #[inline(always)]
    pub(crate) fn slack(&self) -> f64 {
        (-self.least_growth).largest()
    }

    /// Upper bound of the relative decrease of any dual, which needs no division: a dual decreases
    /// by at most its own value, and by the relative growth of its slack.
    #[inline(always)]
    pub(crate) fn dual_bound(&self) -> f64 {
        1.0 + self.largest_growth.largest()
    }

    #[inline(always)]
    pub(crate) fn new(simd: S) -> Self {
        let zero = Vector::splat(simd, 0.0);
        Self { least_growth: zero, largest_growth: zero, dual: zero, x: zero }
    }
}
