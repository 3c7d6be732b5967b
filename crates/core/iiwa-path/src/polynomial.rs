//! Polynomial blends (Larsen 2019, Eq. 13 to 26, 38 and 39).

use iiwa_kin::{Joints, vector};
use pulp::Simd;

use crate::{
    along_inverse,
    continuity::{BlendBasis, Continuity, evaluate},
    planar_graph::{BlendPolynomials, PLACES, PlanarGraph},
    segment::{Derivatives, Segment, by_sigma},
};

/// k that minimises the mean squared second derivative of a blend of continuity N = 2 (Larsen 2019,
/// Eq. 22 to 26).
pub const KAPPA_MIN_ACCELERATION: f64 = 7.5;

/// A blend that combines its two neighbours by polynomials.
///
/// With d0 the difference from the start of the blend to the target, and d1 that from the target to
/// the end of the blend, Larsen 2019, Eq. 39 (of which Eq. 13 and 26 are special cases) reads
/// `q(s) = start + (s + alpha) d0 + (s alpha - kappa beta) (d1 - d0)`.
///
/// ```
/// use iiwa_path::{Continuity, PolynomialBlend, Segment};
///
/// // From joint 1 to joint 2, 0.1 rad on either side of the corner.
/// let corner = [0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
/// let d0 = [0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
/// let d1 = [0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0];
/// let blend = PolynomialBlend::new(&corner, d0, &d1, 0.0, Continuity::Second);
/// assert_eq!(blend.at(0.0).q[0], 0.4);
/// assert!((blend.at(1.0).q[1] - 0.1).abs() < 1e-15);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PolynomialBlend {
    start: Joints,
    d0: Joints,
    /// d1 - d0, in rad.
    turn: Joints,
    /// Length of d0 and of d1, in rad.
    reach: f64,
    /// Weight of beta; dimensionless.
    kappa: f64,
    continuity: Continuity,
}

impl PolynomialBlend {
    /// Creates the blend that arrives at `target_rad` by `d0_rad` and departs by `d1_rad`. Both
    /// must have the same length; otherwise dq/ds jumps at one end.
    ///
    /// The arguments are differences instead of points, which keeps the precision of tiny blends.
    #[must_use]
    pub fn new(
        target_rad: &Joints,
        d0_rad: Joints,
        d1_rad: &Joints,
        kappa: f64,
        continuity: Continuity,
    ) -> Self {
        Self {
            start: vector::sub(target_rad, &d0_rad),
            turn: vector::sub(d1_rad, &d0_rad),
            reach: vector::norm(&d0_rad),
            d0: d0_rad,
            kappa,
            continuity,
        }
    }

    /// Distance in joint space from the target to the start and to the end of the blend, in rad.
    #[must_use]
    pub fn reach_rad(&self) -> f64 {
        self.reach
    }

    /// Order of continuity with the neighbours.
    #[must_use]
    pub fn continuity(&self) -> Continuity {
        self.continuity
    }

    /// Upper bound of the distance by which the blend leaves the box about start, target and end,
    /// in rad.
    ///
    /// Its alpha part combines points of its two neighbours and stays inside the box.
    pub(crate) fn overshoot_bound(&self, joint: usize) -> f64 {
        self.kappa.abs() * self.continuity.beta_peak() * self.turn[joint].abs()
    }
}

impl PolynomialBlend {
    /// A = s alpha - kappa beta and its first three derivatives by `unit (s + alpha)`.
    #[inline(always)]
    fn across(&self, s: f64, unit: f64) -> [f64; 4] {
        let [one, two, three] = by_sigma(evaluate(&self.continuity.along(), s), unit);
        let [a, a1, a2, a3] = evaluate(&self.continuity.across(self.kappa), s);
        [
            a,
            a1 * one,
            a2 * one * one + a1 * two,
            a3 * one * one * one + 3.0 * a2 * one * two + a1 * three,
        ]
    }
}

/// Graph form: with sigma = reach (s + alpha), q(sigma) = start + sigma / reach d0 + A turn.
impl PlanarGraph for PolynomialBlend {
    fn ahead(&self) -> Joints {
        vector::scale(1.0 / self.reach, &self.d0)
    }

    fn across(&self) -> Joints {
        self.turn
    }

    fn polynomials(&self) -> Option<BlendPolynomials> {
        Some(BlendPolynomials {
            continuity: self.continuity,
            kappa: self.kappa,
            arrival_rad: self.d0,
            turn_rad: self.turn,
        })
    }

    fn derivatives(&self, sigma_rad: &[f64; PLACES]) -> [[f64; PLACES]; 3] {
        pulp::Arch::new().dispatch(DerivativesAcross { blend: self, sigma_rad })
    }
}

/// Computation of the derivatives of A at eight places, with the widest vector instructions of the
/// machine.
struct DerivativesAcross<'a> {
    blend: &'a PolynomialBlend,
    sigma_rad: &'a [f64; PLACES],
}

impl pulp::WithSimd for DerivativesAcross<'_> {
    type Output = [[f64; PLACES]; 3];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { blend, sigma_rad } = self;
        let per_rad = 1.0 / blend.reach;
        let s = along_inverse::each_s_at(blend.continuity, sigma_rad.map(|sigma| sigma * per_rad));
        let mut derivatives = [[0.0; PLACES]; 3];
        for i in 0..PLACES {
            let [_, first, second, third] = blend.across(s[i], blend.reach);
            (derivatives[0][i], derivatives[1][i], derivatives[2][i]) = (first, second, third);
        }
        derivatives
    }
}

impl Segment for PolynomialBlend {
    fn at(&self, s: f64) -> Derivatives {
        let basis = BlendBasis::at(self.continuity, s);
        let [q, dq, ddq, dddq] = std::array::from_fn(|n| {
            let along = basis.along[n];
            let across = basis.across[n] - self.kappa * basis.bulge[n];
            std::array::from_fn(|j| along * self.d0[j] + across * self.turn[j])
        });
        Derivatives { q: vector::add_scaled(&q, 1.0, &self.start), dq, ddq, dddq }
    }

    fn bend_bound_rad(&self) -> Joints {
        let [along, across, bulge] = self.continuity.bend_peaks();
        let across = across + self.kappa.abs() * bulge;
        std::array::from_fn(|j| along * self.d0[j].abs() + across * self.turn[j].abs())
    }

    fn tangent_lengths_rad(&self) -> [f64; 2] {
        [self.reach; 2]
    }

    fn has_continuous_curvature(&self) -> bool {
        self.continuity != Continuity::First
    }

    /// `s + alpha(s)`, which increases from 0 to 2 along the blend, and its first three derivatives
    /// with respect to s.
    ///
    /// At both ends, the third derivative of the path with respect to s jumps along and across its
    /// direction. With this parameter instead of s, only the jump across remains, which is a
    /// physical jump in jerk.
    fn sigma(&self, s: f64) -> [f64; 4] {
        evaluate(&self.continuity.along(), s)
    }

    fn s_at(&self, sigma: f64) -> f64 {
        along_inverse::s_at(self.continuity, sigma)
    }

    fn sigma_derivatives(&self, s: f64) -> [Joints; 3] {
        let [_, first, second, third] = self.across(s, self.reach);
        [
            vector::add_scaled(&self.ahead(), first, &self.turn),
            self.turn.map(|turn| turn * second),
            self.turn.map(|turn| turn * third),
        ]
    }

    /// p is (s + alpha) / 2.
    fn at_share(&self, p: f64) -> Derivatives {
        let [across, first, second, third] = self.across(self.s_at(2.0 * p), 0.5);
        let mix = |along: f64, across: f64| {
            std::array::from_fn(|j| along * self.d0[j] + across * self.turn[j])
        };
        Derivatives {
            q: vector::add_scaled(&mix(2.0 * p, across), 1.0, &self.start),
            dq: mix(2.0, first),
            ddq: self.turn.map(|turn| second * turn),
            dddq: self.turn.map(|turn| third * turn),
        }
    }

    fn as_planar_graph(&self) -> Option<&dyn PlanarGraph> {
        Some(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Larsen 2019 states that k = 15/2 minimises the mean squared second derivative (Eq. 22).
    #[test]
    fn fifteen_halves_minimises_the_acceleration() {
        let cost = |kappa: f64| {
            let (mut d0, mut d1) = ([0.0; 7], [0.0; 7]);
            d0[0] = 0.5;
            (d1[0], d1[1]) = (-0.3, 0.4);
            let blend = PolynomialBlend::new(&[0.0; 7], d0, &d1, kappa, Continuity::Second);
            (0..1000)
                .map(|i| vector::norm(&blend.at((f64::from(i) + 0.5) / 1000.0).ddq).powi(2))
                .sum::<f64>()
        };
        let best = cost(KAPPA_MIN_ACCELERATION);
        assert!(best < cost(7.4) && best < cost(7.6));
    }
}
