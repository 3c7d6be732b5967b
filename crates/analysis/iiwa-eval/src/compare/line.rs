//! Straight line through weighted points.

/// Line t = zero + slope tau through weighted points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WeightedLine {
    /// t at tau = 0.
    pub(crate) zero: f64,
    slope: f64,
    pub(super) points: usize,
    /// Sum of weighted squared residuals.
    left: f64,
    /// Sums of w, w tau, w tau^2.
    sums: [f64; 3],
}

impl WeightedLine {
    /// Fits a line through points (tau, t, weight); through a single point with slope 1. None
    /// without points, or if t decreases with tau.
    pub(crate) fn fit(points: impl Iterator<Item = (f64, f64, f64)>) -> Option<Self> {
        let points: Vec<_> = points.filter(|point| point.2 > 0.0).collect();
        let [first, .., last] = points[..] else {
            let (tau, t, w) = *points.first()?;
            let sums = [w, w * tau, w * tau * tau];
            return Some(Self { zero: t - tau, slope: 1.0, points: 1, left: 0.0, sums });
        };
        // Relative to the first point: clock times are large.
        let (tau0, t0) = (first.0, first.1);
        let mut s = [0.0; 5];
        for &(tau, t, w) in &points {
            let (tau, t) = (tau - tau0, t - t0);
            for (sum, term) in s.iter_mut().zip([w, w * tau, w * tau * tau, w * t, w * tau * t]) {
                *sum += term;
            }
        }
        let determinant = s[0] * s[2] - s[1] * s[1];
        if determinant <= 1e-12 * s[0] * s[2] || last.0 == first.0 {
            return None;
        }
        let slope = (s[0] * s[4] - s[1] * s[3]) / determinant;
        let offset = (s[3] - slope * s[1]) / s[0];
        if slope <= 0.0 {
            return None;
        }
        let miss =
            |&(tau, t, w): &(f64, f64, f64)| w * (t - t0 - offset - slope * (tau - tau0)).powi(2);
        let residual = points.iter().map(miss).sum();
        let zero = t0 + offset - slope * tau0;
        let moved = [s[0], s[1] + tau0 * s[0], s[2] + 2.0 * tau0 * s[1] + tau0 * tau0 * s[0]];
        Some(Self { zero, slope, points: points.len(), left: residual, sums: moved })
    }

    /// Root mean square residual of the position, in rad.
    pub(super) fn miss(&self) -> f64 {
        (self.left / self.points as f64).sqrt() / self.slope
    }

    /// Returns a bound of the error of the zero: its standard deviation from noise, multiplied for
    /// residuals above the noise, since a wrong law may bend the line, which does not average out.
    pub(super) fn error(&self, sigma: f64) -> f64 {
        let excess = (self.miss() / sigma.max(1e-12)).powi(2) * self.points as f64;
        let allowed = self.points as f64 + 3.0 * (2.0 * self.points as f64).sqrt();
        let systematic = if excess > allowed { (0.5 * self.points as f64).sqrt() } else { 1.0 };
        systematic * self.deviation(sigma)
    }

    /// Returns chi squared minus its expected value, the number of points.
    pub(super) fn misfit(&self, sigma: f64) -> f64 {
        (self.miss() / sigma.max(1e-12)).powi(2) * self.points as f64 - self.points as f64
    }

    /// Returns the standard deviation of the zero for ways with noise `sigma`, in s.
    pub(super) fn deviation(&self, sigma: f64) -> f64 {
        let [w, wt, wtt] = self.sums;
        let sigma = sigma.max(self.miss());
        let determinant = w * wtt - wt * wt;
        if self.points < 2 || determinant <= 0.0 {
            return sigma / w.sqrt();
        }
        sigma * self.slope * (wtt / determinant).sqrt()
    }
}
