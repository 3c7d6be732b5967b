//! Blends by polynomials (Larsen 2019, Eq. 13 to 26, 38 and 39).

use iiwa_kin::Joints;

use crate::{grid::Grid, segment::Derivatives, vector};

/// Up to which derivative a blend continues its neighbours: N of Larsen 2019, Eq. 14.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Continuity {
    /// N = 1: the direction.
    First,
    /// N = 2: the curvature too. k = 15/2 and kappa(gamma) of Larsen 2019 go with it.
    #[default]
    Second,
    /// N = 3: its rate of change too.
    Third,
}

/// Polynomials in s up to degree 8, lowest power first.
type Polynomial = [f64; 9];

impl Continuity {
    /// alpha of Larsen 2019, Eq. 18.
    const fn alpha(self) -> Polynomial {
        match self {
            Self::First => [0.0, 0.0, 3.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            Self::Second => [0.0, 0.0, 0.0, 10.0, -15.0, 6.0, 0.0, 0.0, 0.0],
            Self::Third => [0.0, 0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0, 0.0],
        }
    }

    /// `s + alpha`.
    const fn along(self) -> Polynomial {
        let mut along = self.alpha();
        along[1] += 1.0;
        along
    }

    /// beta of Larsen 2019, Eq. 21 with k = 1. The sign of N = 2 differs from the other two.
    const fn beta(self) -> Polynomial {
        match self {
            Self::First => [0.0, 0.0, 1.0, -2.0, 1.0, 0.0, 0.0, 0.0, 0.0],
            Self::Second => [0.0, 0.0, 0.0, -1.0, 3.0, -3.0, 1.0, 0.0, 0.0],
            Self::Third => [0.0, 0.0, 0.0, 0.0, 1.0, -4.0, 6.0, -4.0, 1.0],
        }
    }

    /// Largest value of |beta| on [0, 1], at s = 1/2.
    const fn beta_peak(self) -> f64 {
        match self {
            Self::First => 1.0 / 16.0,
            Self::Second => 1.0 / 64.0,
            Self::Third => 1.0 / 256.0,
        }
    }

    /// Bounds of the second derivatives of `s + alpha`, `s alpha` and `beta` on [0, 1], rounded up.
    const fn bend_peaks(self) -> [f64; 3] {
        match self {
            Self::First => [6.0, 6.0, 2.0],
            Self::Second => [5.774, 4.622, 0.375],
            Self::Third => [7.514, 5.812, 0.125],
        }
    }
}

/// Value and first three derivatives of a polynomial.
fn evaluate(polynomial: &Polynomial, s: f64) -> [f64; 4] {
    // Horner's scheme on the value and, one step behind each, on the derivatives (over their
    // factorials).
    let [mut p, mut p1, mut p2, mut p3] = [0.0; 4];
    for c in polynomial.iter().rev() {
        p3 = p3 * s + p2;
        p2 = p2 * s + p1;
        p1 = p1 * s + p;
        p = p * s + c;
    }
    [p, p1, 2.0 * p2, 6.0 * p3]
}

/// The parts of a blend that do not depend on its size and angle, at one s: value and derivatives
/// of `s + alpha`, `s alpha` and `beta`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Basis {
    along: [f64; 4],
    across: [f64; 4],
    bulge: [f64; 4],
}

impl Basis {
    pub(crate) fn at(continuity: Continuity, s: f64) -> Self {
        let alpha = continuity.alpha();
        let across: Polynomial = std::array::from_fn(|i| if i == 0 { 0.0 } else { alpha[i - 1] });
        Self {
            along: evaluate(&continuity.along(), s),
            across: evaluate(&across, s),
            bulge: evaluate(&continuity.beta(), s),
        }
    }
}

/// k that minimises the mean squared second derivative of a blend of continuity N = 2 (Larsen 2019,
/// Eq. 22 to 26).
pub const KAPPA_MIN_ACCELERATION: f64 = 7.5;

/// A blend that mixes its two neighbours by polynomials.
///
/// With d0 and d1 the ways from the blend's start to the target that is blended away, and from
/// there to its end, Larsen 2019's Eq. 39 (of which Eq. 13 and 26 are special cases) reads
/// `q(s) = start + (s + alpha) d0 + (s alpha - kappa beta) (d1 - d0)`.
#[derive(Clone, Debug, PartialEq)]
pub struct PolynomialBlend {
    start: Joints,
    d0: Joints,
    turn: Joints,
    reach: f64,
    kappa: f64,
    continuity: Continuity,
}

impl PolynomialBlend {
    /// The blend that arrives by `d0_rad` at `target_rad` and leaves by `d1_rad`; both equally long.
    ///
    /// Taking the ways rather than the points keeps all digits of blends that are tiny.
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

    /// Distance in joint space from the target to the blend's start and to its end, in rad.
    #[must_use]
    pub fn reach_rad(&self) -> f64 {
        self.reach
    }

    /// Up to which derivative it continues its neighbours.
    #[must_use]
    pub fn continuity(&self) -> Continuity {
        self.continuity
    }

    /// `s + alpha(s)`, which rises from 0 to 2 along the blend, and its first three derivatives by s.
    ///
    /// At both ends, the path's third derivative by s jumps along its direction and across. Taken as
    /// the parameter instead of s, this leaves only the jump across, which is what the arm feels.
    #[must_use]
    pub fn progress(&self, s: f64) -> [f64; 4] {
        evaluate(&self.continuity.along(), s)
    }

    /// Position and derivatives at `s` in [0, 1].
    #[must_use]
    pub fn at(&self, s: f64) -> Derivatives {
        let basis = Basis::at(self.continuity, s);
        let [q, dq, ddq, dddq] = std::array::from_fn(|n| {
            let along = basis.along[n];
            let across = basis.across[n] - self.kappa * basis.bulge[n];
            std::array::from_fn(|j| along * self.d0[j] + across * self.turn[j])
        });
        Derivatives { q: vector::add_scaled(&q, 1.0, &self.start), dq, ddq, dddq }
    }

    #[inline(always)]
    pub(crate) fn rates(
        &self,
        grid: &Grid,
        scale: &Joints,
        dq: &mut [[f64; 8]],
        ddq: &mut [[f64; 8]],
    ) {
        let mut d0 = [0.0; 8];
        let mut turn = [0.0; 8];
        for j in 0..7 {
            d0[j] = self.d0[j] * scale[j];
            turn[j] = self.turn[j] * scale[j];
        }
        let basis = grid.basis(self.continuity);
        for ((basis, dq), ddq) in
            basis.iter().zip(&mut dq[..basis.len()]).zip(&mut ddq[..basis.len()])
        {
            let across1 = basis.across[1] - self.kappa * basis.bulge[1];
            let across2 = basis.across[2] - self.kappa * basis.bulge[2];
            for j in 0..8 {
                dq[j] = basis.along[1] * d0[j] + across1 * turn[j];
                ddq[j] = basis.along[2] * d0[j] + across2 * turn[j];
            }
        }
    }

    /// For each joint, a bound of `|d2q/ds2|`, in rad.
    pub(crate) fn bend_bound_rad(&self) -> Joints {
        let [along, across, bulge] = self.continuity.bend_peaks();
        let across = across + self.kappa.abs() * bulge;
        std::array::from_fn(|j| along * self.d0[j].abs() + across * self.turn[j].abs())
    }

    /// How far the blend may go beyond the box about start, target and end, at most, in rad.
    ///
    /// Its alpha part mixes points of its two neighbours and stays inside the box.
    pub(crate) fn overshoot_bound(&self, joint: usize) -> f64 {
        self.kappa.abs() * self.continuity.beta_peak() * self.turn[joint].abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_meet_their_constraints() {
        for (n, continuity) in
            [(1, Continuity::First), (2, Continuity::Second), (3, Continuity::Third)]
        {
            for (polynomial, end) in [(continuity.alpha(), 1.0), (continuity.beta(), 0.0)] {
                let (at0, at1) = (evaluate(&polynomial, 0.0), evaluate(&polynomial, 1.0));
                assert_eq!((at0[0], at1[0]), (0.0, end));
                for k in 1..=n {
                    assert_eq!((at0[k], at1[k]), (0.0, 0.0), "derivative {k} of N = {n}");
                }
            }
            let middle = evaluate(&continuity.beta(), 0.5);
            assert_eq!(middle[0].abs(), continuity.beta_peak());
            assert!(middle[1].abs() < 1e-15);
        }
    }

    #[test]
    fn bends_stay_within_their_bounds_and_come_close() {
        for continuity in [Continuity::First, Continuity::Second, Continuity::Third] {
            let mut largest = [0.0_f64; 3];
            for i in 0..=100_000 {
                let basis = Basis::at(continuity, f64::from(i) / 100_000.0);
                let bends = [basis.along[2], basis.across[2], basis.bulge[2]];
                largest = std::array::from_fn(|k| largest[k].max(bends[k].abs()));
            }
            for (found, bound) in largest.into_iter().zip(continuity.bend_peaks()) {
                let close = 0.999 * bound..=bound * (1.0 + 1e-14);
                assert!(close.contains(&found), "{continuity:?}: {found}, {bound}");
            }
        }
    }

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
