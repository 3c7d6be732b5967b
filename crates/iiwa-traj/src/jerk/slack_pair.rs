//! Slacks and duals of limits, and how they go along with a step.

use pulp::Simd;

use crate::lanes::{Lanes, Vector};

/// A step: the product that slacks and duals were to have, and the shares of it that they go.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct InteriorStep {
    pub(crate) mu: f64,
    pub(crate) primal: f64,
    pub(crate) dual: f64,
}

/// The last step and the next, for one register of lanes.
pub(crate) struct InteriorSteps<S: Simd> {
    pub(crate) simd: S,
    pub(crate) register: usize,
    last_mu: Vector<S>,
    primal: Vector<S>,
    dual: Vector<S>,
    mu: Vector<S>,
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
        }
    }
}

/// Slack and dual of one slack of a limit.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SlackPair {
    s: Lanes,
    z: Lanes,
    /// One over the slack: dividing is slow.
    inverse: Lanes,
    /// Step of the slack, which the dual's follows from.
    ds: Lanes,
}

/// A slack after its last step.
pub(crate) struct Advanced<S: Simd> {
    pub(crate) s: Vector<S>,
    pub(crate) z: Vector<S>,
    inverse: Vector<S>,
    /// z / s.
    pub(crate) weight: Vector<S>,
}

impl<S: Simd> Advanced<S> {
    /// What the slack contributes to the slope when its limit is missed by `miss`.
    #[inline(always)]
    pub(crate) fn slope(&self, steps: &InteriorSteps<S>, miss: Vector<S>) -> Vector<S> {
        steps.mu.mul_add(self.inverse, self.weight * miss)
    }
}

impl SlackPair {
    /// The slack is the room that is left, but not less than `least`.
    #[inline(always)]
    pub(crate) fn start<S: Simd>(
        &mut self,
        r: usize,
        room: Vector<S>,
        least: Vector<S>,
        mu: Vector<S>,
    ) {
        let s = room.max(least);
        let inverse = s.inverse();
        self.s.store(r, s);
        self.inverse.store(r, inverse);
        self.z.store(r, mu * inverse);
        self.ds = Lanes::default();
    }

    #[inline(always)]
    pub(crate) fn advance<S: Simd>(&mut self, steps: &InteriorSteps<S>) -> Advanced<S> {
        let InteriorSteps { simd, register: r, .. } = *steps;
        let (s, z) = (self.s.load(simd, r), self.z.load(simd, r));
        let (ds, inverse) = (self.ds.load(simd, r), self.inverse.load(simd, r));
        let dz = (steps.last_mu - z * ds).mul_add(inverse, -z);
        let s = steps.primal.mul_add(ds, s);
        let z = steps.dual.mul_add(dz, z);
        let inverse = s.inverse();
        self.s.store(r, s);
        self.z.store(r, z);
        self.inverse.store(r, inverse);
        Advanced { s, z, inverse, weight: z * inverse }
    }

    /// Sets the slack's step so that it becomes `room`. The relative ratios of slack and dual that go with
    /// it.
    #[inline(always)]
    pub(crate) fn direct<S: Simd>(
        &mut self,
        r: usize,
        room: Vector<S>,
        mu: Vector<S>,
    ) -> [Vector<S>; 2] {
        let simd = mu.simd();
        let (s, z) = (self.s.load(simd, r), self.z.load(simd, r));
        let ds = room - s;
        self.ds.store(r, ds);
        let inverse = self.inverse.load(simd, r);
        let ratio = -(ds * inverse);
        // dz = (mu - z ds) / s - z.
        let one = Vector::splat(simd, 1.0);
        [ratio, one - ratio - mu * inverse * z.inverse()]
    }
}
