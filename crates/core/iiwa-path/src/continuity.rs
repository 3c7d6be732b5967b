//! Polynomials of blends, one set for each order of continuity.

/// Order of the derivative up to which a blend continues its neighbours: N of Larsen 2019, Eq. 14.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Continuity {
    /// N = 1: continuous direction.
    First,
    /// N = 2: continuous curvature. k = 15/2 and kappa(gamma) of Larsen 2019 apply to this order.
    #[default]
    Second,
    /// N = 3: continuous rate of change of curvature.
    Third,
}

/// Polynomial in s up to degree 8, lowest power first.
pub(crate) type Polynomial = [f64; 9];

impl Continuity {
    /// alpha of Larsen 2019, Eq. 18.
    pub(crate) const fn alpha(self) -> Polynomial {
        match self {
            Self::First => [0.0, 0.0, 3.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            Self::Second => [0.0, 0.0, 0.0, 10.0, -15.0, 6.0, 0.0, 0.0, 0.0],
            Self::Third => [0.0, 0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0, 0.0],
        }
    }

    /// `s + alpha`.
    pub(crate) const fn along(self) -> Polynomial {
        let mut along = self.alpha();
        along[1] += 1.0;
        along
    }

    /// `s alpha - kappa beta`.
    pub(crate) fn across(self, kappa: f64) -> Polynomial {
        let (alpha, beta) = (self.alpha(), self.beta());
        std::array::from_fn(|i| if i == 0 { 0.0 } else { alpha[i - 1] - kappa * beta[i] })
    }

    /// beta of Larsen 2019, Eq. 21 with k = 1. Its sign for N = 2 differs from the other two.
    pub(crate) const fn beta(self) -> Polynomial {
        match self {
            Self::First => [0.0, 0.0, 1.0, -2.0, 1.0, 0.0, 0.0, 0.0, 0.0],
            Self::Second => [0.0, 0.0, 0.0, -1.0, 3.0, -3.0, 1.0, 0.0, 0.0],
            Self::Third => [0.0, 0.0, 0.0, 0.0, 1.0, -4.0, 6.0, -4.0, 1.0],
        }
    }

    /// Largest value of |beta| on [0, 1], at s = 1/2.
    pub(crate) const fn beta_peak(self) -> f64 {
        match self {
            Self::First => 1.0 / 16.0,
            Self::Second => 1.0 / 64.0,
            Self::Third => 1.0 / 256.0,
        }
    }

    /// Upper bounds of the second derivatives of `s + alpha`, `s alpha` and `beta` on [0, 1],
    /// rounded up.
    pub(crate) const fn bend_peaks(self) -> [f64; 3] {
        match self {
            Self::First => [6.0, 6.0, 2.0],
            Self::Second => [5.774, 4.622, 0.375],
            Self::Third => [7.514, 5.812, 0.125],
        }
    }
}

/// Evaluates a polynomial and its first three derivatives.
#[inline(always)]
pub(crate) fn evaluate(polynomial: &Polynomial, s: f64) -> [f64; 4] {
    // Horner's scheme for the value and, one step behind each, for the derivatives over their
    // factorials.
    let [mut p, mut p1, mut p2, mut p3] = [0.0; 4];
    for c in polynomial.iter().rev() {
        p3 = p3 * s + p2;
        p2 = p2 * s + p1;
        p1 = p1 * s + p;
        p = p * s + c;
    }
    [p, p1, 2.0 * p2, 6.0 * p3]
}

/// Parts of a blend that do not depend on its size and angle, at one s: value and derivatives of
/// `s + alpha`, `s alpha` and `beta`.
#[derive(Clone, Copy, Debug)]
pub struct BlendBasis {
    /// s + alpha.
    pub along: [f64; 4],
    /// s alpha.
    pub across: [f64; 4],
    /// beta.
    pub bulge: [f64; 4],
}

impl BlendBasis {
    /// Evaluates the polynomials of this order at `s`.
    #[must_use]
    pub fn at(continuity: Continuity, s: f64) -> Self {
        Self {
            along: evaluate(&continuity.along(), s),
            across: evaluate(&continuity.across(0.0), s),
            bulge: evaluate(&continuity.beta(), s),
        }
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
                let basis = BlendBasis::at(continuity, f64::from(i) / 100_000.0);
                let bends = [basis.along[2], basis.across[2], basis.bulge[2]];
                largest = std::array::from_fn(|k| largest[k].max(bends[k].abs()));
            }
            for (actual, bound) in largest.into_iter().zip(continuity.bend_peaks()) {
                let close = 0.999 * bound..=bound * (1.0 + 1e-14);
                assert!(close.contains(&actual), "{continuity:?}: {actual}, {bound}");
            }
        }
    }
}
