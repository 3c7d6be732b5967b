//! kappa over gamma, from the observed blends.

use crate::estimate::{Estimate, Linear, LinearRow};

/// kappa as a polynomial of gamma (Larsen 2019, Eq. 38).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kappa {
    polynomial: Linear<3>,
    /// Smallest and largest observed angle, in degrees.
    pub gamma_deg: [f64; 2],
    /// Root mean square difference between the observed kappa and the polynomial.
    pub residual: f64,
    /// Root mean square difference between the observed kappa and the model's.
    pub residual_of_model: f64,
}

impl Kappa {
    /// Returns the coefficients for gamma in degrees, the constant first.
    #[must_use]
    pub fn coefficients(&self) -> &[f64; 3] {
        &self.polynomial.coefficients
    }

    /// Returns kappa at an angle.
    #[must_use]
    pub fn at(&self, gamma_deg: f64) -> Estimate {
        self.polynomial.at(powers(gamma_deg))
    }
}

fn powers(gamma_deg: f64) -> [f64; 3] {
    [1.0, gamma_deg, gamma_deg * gamma_deg]
}

/// Minimum range of the angles, in degrees, for a fit of kappa.
const SPREAD_DEG: f64 = 45.0;

/// Observed blend: gamma in degrees, kappa and its standard deviation.
pub(super) type KappaAt = (f64, (f64, f64));

impl Kappa {
    /// Fits the polynomial to `blends`, of a robot that is assumed to have the kappa of `model`;
    /// none if the range of their angles is too small.
    pub(super) fn fit(blends: &[KappaAt], model: impl Fn(f64) -> f64) -> Option<Self> {
        let rows: Vec<_> = blends
            .iter()
            .map(|&(gamma_deg, (value, deviation))| LinearRow {
                by: powers(gamma_deg),
                value,
                deviation,
            })
            .collect();
        let angles = || blends.iter().map(|(gamma_deg, _)| *gamma_deg);
        let gamma_deg = [angles().fold(f64::MAX, f64::min), angles().fold(0.0, f64::max)];
        if gamma_deg[1] - gamma_deg[0] < SPREAD_DEG {
            return None;
        }
        let polynomial = Linear::fit(&rows)?;
        let mean_square = |kappa: &dyn Fn(f64) -> f64| {
            let off = |(gamma, (value, _)): &KappaAt| (value - kappa(*gamma)).powi(2);
            (blends.iter().map(off).sum::<f64>() / blends.len() as f64).sqrt()
        };
        Some(Self {
            polynomial,
            gamma_deg,
            residual: mean_square(&|gamma| polynomial.at(powers(gamma)).value),
            residual_of_model: mean_square(&model),
        })
    }
}
