//! Figures with their uncertainties.

use std::fmt::Write as _;

use iiwa_eval::{Estimate, identify::Kappa};
use serde::Serialize;

#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Figure {
    pub(super) value: f64,
    /// Half of the 95 % confidence interval.
    uncertainty: f64,
    pub(super) count: usize,
}

impl From<Estimate> for Figure {
    fn from(Estimate { value, uncertainty, count, .. }: Estimate) -> Self {
        Self { value, uncertainty, count }
    }
}

impl Figure {
    /// Returns true if the value may be zero, or is smaller than `negligible`.
    pub(super) fn is_zero_within(&self, negligible: f64) -> bool {
        self.value.abs() <= self.uncertainty.max(negligible)
    }
}

impl std::fmt::Display for Figure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let &Self { value, uncertainty, count } = self;
        write!(f, "{}", Estimate { value, uncertainty, count })
    }
}

/// kappa over gamma.
#[derive(Clone, Debug, Serialize)]
pub(super) struct KappaFigure {
    /// Coefficients for gamma in degrees, the constant first.
    coefficients: [f64; 3],
    /// Smallest and largest observed angle.
    gamma_deg: [f64; 2],
    /// Root mean square of the residuals of the fitted polynomial, and of the model's.
    residual: f64,
    residual_of_model: f64,
    count: usize,
    /// kappa and its uncertainty every 10 deg within the observed range.
    at: Vec<KappaPoint>,
}

#[derive(Clone, Debug, Serialize)]
struct KappaPoint {
    gamma_deg: f64,
    value: f64,
    uncertainty: f64,
}

impl KappaFigure {
    /// Creates the figure of kappa, identified from `count` blends.
    pub(super) fn new(kappa: &Kappa, count: usize) -> Self {
        Self {
            coefficients: *kappa.coefficients(),
            gamma_deg: kappa.gamma_deg,
            residual: kappa.residual,
            residual_of_model: kappa.residual_of_model,
            count,
            at: (0..=18)
                .map(|ten| 10.0 * f64::from(ten))
                .filter(|gamma| (kappa.gamma_deg[0]..=kappa.gamma_deg[1]).contains(gamma))
                .map(|gamma_deg| {
                    let Estimate { value, uncertainty, .. } = kappa.at(gamma_deg);
                    KappaPoint { gamma_deg, value, uncertainty }
                })
                .collect(),
        }
    }

    /// Writes two lines on kappa, labelled `name`.
    pub(super) fn write(&self, text: &mut String, name: &str) {
        let [c0, c1, c2] = self.coefficients;
        let _ = writeln!(
            text,
            "{name} = {c0:.5} {c1:+.7} gamma {c2:+.9} gamma^2, gamma from {:.0} to {:.0} deg: {}, \
             residual {:.4} (against the model's {:.4})",
            self.gamma_deg[0],
            self.gamma_deg[1],
            blends(self.count),
            self.residual,
            self.residual_of_model
        );
        let widest = self.at.iter().map(|point| point.uncertainty).fold(0.0, f64::max);
        let _ = writeln!(text, "Uncertainty of {name} within that range: {widest:.4} at most");
    }
}

/// Formats a number of blends.
pub(super) fn blends(count: usize) -> String {
    if count == 1 { "1 blend".to_owned() } else { format!("{count} blends") }
}

/// Distances count as equal if they differ by less than this share of their difference without
/// Algorithm 3: robots do not follow their paths more accurately.
pub(super) const EQUAL_SHARE: f64 = 0.02;
