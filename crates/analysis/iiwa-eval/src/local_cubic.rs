//! Derivatives of noisy samples.

use nalgebra::{SMatrix, SVector};

/// Returns the value and the first three derivatives at `at_s`, from the least-squares cubic
/// through all samples within `half_s` (Savitzky and Golay 1964, for non-uniform time steps).
/// `None` with too few samples.
///
/// Noise with standard deviation sigma leaves some `300 sigma / (n^3.5 step^3)` in the third
/// derivative, with n samples at intervals of `step`; changes faster than the window are smoothed.
#[must_use]
pub fn local_cubic(t_s: &[f64], values: &[f64], at_s: f64, half_s: f64) -> Option<[f64; 4]> {
    let first = t_s.partition_point(|t_s| *t_s < at_s - half_s);
    let last = t_s.partition_point(|t_s| *t_s <= at_s + half_s);
    if last < first + 5 {
        return None;
    }
    let mut normal = SMatrix::<f64, 4, 4>::zeros();
    let mut right = SVector::<f64, 4>::zeros();
    // Relative to the first value, to avoid cancellation.
    let base = values.get(first)?;
    for (t_s, value) in t_s[first..last].iter().zip(values.get(first..last)?) {
        let x = (t_s - at_s) / half_s;
        let by = SVector::from([1.0, x, x * x, x * x * x]);
        normal.ger(1.0, &by, &by, 1.0);
        right.axpy(value - base, &by, 1.0);
    }
    let c = normal.cholesky()?.solve(&right);
    let per_s = half_s.recip();
    Some([c[0] + base, c[1] * per_s, 2.0 * c[2] * per_s.powi(2), 6.0 * c[3] * per_s.powi(3)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_are_met() {
        let t_s: Vec<f64> = (0..40).map(|i| 0.01 * f64::from(i + i % 3)).collect();
        let cubic = |t: f64| 1.0 + 2.0 * t - 3.0 * t * t + 4.0 * t * t * t;
        let values: Vec<f64> = t_s.iter().map(|t| cubic(*t)).collect();
        let [q, dq, ddq, dddq] = local_cubic(&t_s, &values, 0.2, 0.05).unwrap();
        let expected = [cubic(0.2), 2.0 - 1.2 + 12.0 * 0.04, -6.0 + 24.0 * 0.2, 24.0];
        for (actual, expected) in [q, dq, ddq, dddq].iter().zip(expected) {
            assert!((actual - expected).abs() < 1e-6, "{actual} {expected}");
        }
        assert_eq!(local_cubic(&t_s, &values, 5.0, 0.05), None);
    }
}
