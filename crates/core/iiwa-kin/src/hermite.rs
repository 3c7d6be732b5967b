//! Hermite polynomials: cubics and quintics over a share from 0 to 1, with given values and
//! derivatives at both ends. Coefficients start at the lowest power.
//!
//! ```
//! use iiwa_kin::hermite;
//!
//! let from_rest_to_rest = hermite::quintic([0.0; 3], [1.0, 0.0, 0.0]);
//! assert_eq!(from_rest_to_rest, [0.0, 0.0, 0.0, 10.0, -15.0, 6.0]);
//! assert_eq!(hermite::value(&from_rest_to_rest, 0.5), 0.5);
//! ```

/// Cubic with the given end values and slopes.
#[must_use]
#[inline]
pub fn cubic([start, start_slope]: [f64; 2], [end, end_slope]: [f64; 2]) -> [f64; 4] {
    let by = end - start;
    [
        start,
        start_slope,
        3.0 * by - 2.0 * start_slope - end_slope,
        start_slope + end_slope - 2.0 * by,
    ]
}

/// Quintic with the given end values, slopes and second derivatives.
#[must_use]
#[inline]
pub fn quintic([p0, v0, a0]: [f64; 3], [p1, v1, a1]: [f64; 3]) -> [f64; 6] {
    let by = p1 - p0;
    [
        p0,
        v0,
        0.5 * a0,
        10.0 * by - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1,
        -15.0 * by + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1,
        6.0 * by - 3.0 * (v0 + v1) + 0.5 * (a1 - a0),
    ]
}

/// Value of a polynomial at `share`.
#[must_use]
#[inline]
pub fn value<const N: usize>(coefficients: &[f64; N], share: f64) -> f64 {
    let Some((highest, rest)) = coefficients.split_last() else { return 0.0 };
    rest.iter().rev().fold(*highest, |sum, c| sum * share + c)
}

/// First derivative of a polynomial at `share`.
#[must_use]
#[inline]
pub fn slope<const N: usize>(coefficients: &[f64; N], share: f64) -> f64 {
    let add = |(value, slope), c: &f64| (value * share + c, slope * share + value);
    coefficients.iter().rev().fold((0.0, 0.0), add).1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The given end values and derivatives are reproduced, by evaluation and by finite
    /// differences.
    #[test]
    fn ends_are_met() {
        let (a, b) = ([0.3, -1.2, 4.0], [2.0, 0.7, -3.0]);
        let polynomials = [cubic([a[0], a[1]], [b[0], b[1]]).to_vec(), quintic(a, b).to_vec()];
        for polynomial in polynomials {
            let mut c = [0.0; 6];
            c[..polynomial.len()].copy_from_slice(&polynomial);
            for (x, end) in [(0.0, a), (1.0, b)] {
                assert!((value(&c, x) - end[0]).abs() < 1e-12);
                assert!((slope(&c, x) - end[1]).abs() < 1e-12);
                let difference = (value(&c, x + 1e-6) - value(&c, x - 1e-6)) / 2e-6;
                assert!((difference - end[1]).abs() < 1e-6);
            }
        }
        let c = quintic(a, b);
        for (x, end) in [(0.0, a), (1.0, b)] {
            let bend = (slope(&c, x + 1e-6) - slope(&c, x - 1e-6)) / 2e-6;
            assert!((bend - end[2]).abs() < 1e-6);
        }
    }

    #[test]
    fn polynomials_of_their_degree_are_themselves() {
        let c = [0.5, -1.0, 2.0, 3.0, -4.0, 1.5];
        let bend = |x: f64| 4.0 + 18.0 * x - 48.0 * x * x + 30.0 * x * x * x;
        let at = |x: f64| [value(&c, x), slope(&c, x), bend(x)];
        for (actual, expected) in quintic(at(0.0), at(1.0)).iter().zip(c) {
            assert!((actual - expected).abs() < 1e-12);
        }
    }
}
