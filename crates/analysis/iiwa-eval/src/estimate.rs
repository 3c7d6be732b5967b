//! Estimates with their uncertainty.

use std::fmt;

use nalgebra::{SMatrix, SVector};

/// Estimate from observations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Estimated value.
    pub value: f64,
    /// Half-width of the 95 % confidence interval.
    pub uncertainty: f64,
    /// Number of observations.
    pub count: usize,
}

impl Estimate {
    /// Returns the mean of independent observations, each with its standard deviation; none without
    /// observations.
    pub(crate) fn mean(observations: &[(f64, f64)]) -> Option<Self> {
        let rows = observations.iter().map(|&(value, deviation)| LinearRow {
            by: [1.0],
            value,
            deviation,
        });
        let line = Linear::fit(&rows.collect::<Vec<_>>())?;
        Some(line.at([1.0]))
    }

    /// Returns true if `value` is within the uncertainty.
    #[must_use]
    pub fn holds(&self, value: f64) -> bool {
        (value - self.value).abs() <= self.uncertainty
    }

    /// Converts the estimate to another unit.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            uncertainty: self.uncertainty * factor.abs(),
            count: self.count,
        }
    }
}

impl fmt::Display for Estimate {
    /// Prints the value and its uncertainty with two significant digits of the latter.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { value, uncertainty, .. } = self;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 9")]
        let places = (1.0 - uncertainty.log10().floor()).clamp(0.0, 9.0) as usize;
        write!(f, "{value:.places$} +- {uncertainty:.places$}")
    }
}

/// Observation of a sum of unknown coefficients, each times a known factor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LinearRow<const N: usize> {
    pub(crate) by: [f64; N],
    pub(crate) value: f64,
    /// Standard deviation of the observation.
    pub(crate) deviation: f64,
}

/// Coefficients from many observations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Linear<const N: usize> {
    pub(crate) coefficients: [f64; N],
    covariance: SMatrix<f64, N, N>,
    /// Uncertainty in standard deviations.
    factor: f64,
    count: usize,
}

impl<const N: usize> Linear<N> {
    /// Fits by weighted least squares; none if the observations do not determine the coefficients.
    ///
    /// The observations may scatter more than their standard deviations, since the robot itself
    /// does. The variance that explains the excess is added to each of them (Mandel and Paule
    /// 1970).
    pub(crate) fn fit(rows: &[LinearRow<N>]) -> Option<Self> {
        let degrees = rows.len().checked_sub(N)?;
        let solve = |excess: f64| {
            let mut normal = SMatrix::<f64, N, N>::zeros();
            let mut right = SVector::<f64, N>::zeros();
            for row in rows {
                let (by, weight) = (SVector::from(row.by), row.weight(excess));
                normal.ger(weight, &by, &by, 1.0);
                right.axpy(weight * row.value, &by, 1.0);
            }
            let normal = normal.cholesky()?;
            let coefficients = normal.solve(&right);
            let off = |row: &LinearRow<N>| row.value - SVector::from(row.by).dot(&coefficients);
            let scatter: f64 = rows.iter().map(|row| row.weight(excess) * off(row).powi(2)).sum();
            Some((coefficients, normal.inverse(), scatter))
        };
        let mut excess = 0.0;
        let mut best = solve(excess)?;
        let too_much = |scatter: f64| scatter > degrees as f64;
        let scatters = degrees > 0 && too_much(best.2);
        if scatters {
            // The total scatter of all observations is an upper bound.
            let max_variance =
                best.2 * rows.iter().map(|row| row.deviation.powi(2)).fold(0.0, f64::max);
            let mut range = [0.0, max_variance];
            for _ in 0..100 {
                excess = 0.5 * (range[0] + range[1]);
                best = solve(excess)?;
                range[usize::from(!too_much(best.2))] = excess;
            }
        }
        let coefficients: [f64; N] = best.0.into();
        let factor = if scatters { student(degrees) } else { NORMAL_95 };
        let covariance = best.1;
        let finite = coefficients.iter().chain(covariance.iter()).all(|v| v.is_finite());
        finite.then_some(Self { coefficients, covariance, factor, count: rows.len() })
    }

    /// Returns the sum with these factors.
    pub(crate) fn at(&self, by: [f64; N]) -> Estimate {
        let by = SVector::from(by);
        let variance = by.dot(&(self.covariance * by));
        Estimate {
            value: by.dot(&SVector::from(self.coefficients)),
            uncertainty: self.factor * variance.max(0.0).sqrt(),
            count: self.count,
        }
    }
}

impl<const N: usize> LinearRow<N> {
    fn weight(&self, excess: f64) -> f64 {
        (self.deviation.powi(2) + excess).recip()
    }
}

/// Two-sided 95 % quantile of the standard normal distribution.
pub(crate) const NORMAL_95: f64 = 1.959_964;

/// Returns the two-sided 95 % quantile of Student's distribution, by its expansion about the normal
/// distribution; the error is within 1 % from 3 degrees of freedom.
pub(crate) fn student(degrees: usize) -> f64 {
    const Z: f64 = NORMAL_95;
    match degrees {
        0 | 1 => 12.706,
        2 => 4.303,
        _ => {
            let n = 1.0 / degrees as f64;
            let z2 = Z * Z;
            let first = (z2 + 1.0) / 4.0;
            let second = ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0;
            let third = (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0;
            Z * (1.0 + n * (first + n * (second + n * third)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (degrees, expected) in [(1, 12.706), (3, 3.182), (5, 2.571), (10, 2.228), (30, 2.042)] {
            assert!((student(degrees) / expected - 1.0).abs() < 1e-2, "{degrees}");
        }
        assert!((student(usize::MAX) - NORMAL_95).abs() < 1e-9);
    }

    #[test]
    fn consistent_observations_keep_their_uncertainty() {
        let mean = Estimate::mean(&[(1.0, 0.1), (1.0, 0.1), (1.0, 0.1), (1.0, 0.1)]).unwrap();
        assert_eq!(mean.count, 4);
        assert!((mean.value - 1.0).abs() < 1e-12);
        assert!((mean.uncertainty - NORMAL_95 * 0.05).abs() < 1e-12);
        assert_eq!(Estimate::mean(&[]), None);
    }

    /// Unexplained scatter increases the uncertainty, as without standard deviations.
    #[test]
    fn scatter_counts() {
        let values = [1.0, 2.0, 3.0, 4.0, 5.0];
        let mean = Estimate::mean(&values.map(|v| (v, 1e-6))).unwrap();
        assert!((mean.value - 3.0).abs() < 1e-9);
        assert!((mean.uncertainty - 2.776 * (2.5_f64 / 5.0).sqrt()).abs() < 0.01);
    }

    #[test]
    fn figures_have_two_digits_of_their_uncertainty() {
        let estimate = Estimate { value: 98.123_456, uncertainty: 0.0123, count: 3 };
        assert_eq!(estimate.to_string(), "98.123 +- 0.012");
    }
}
