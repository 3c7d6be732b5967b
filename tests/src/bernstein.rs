//! Maxima of polynomials of degree eight on [0, 1], from their Bernstein form, exact up to
//! rounding.
//!
//! The values of a polynomial are between its smallest and its largest coefficient, and its first
//! and last coefficients are its values at 0 and 1. Bisecting the interval moves the coefficients
//! towards the curve: parts that cannot contain the maximum are dropped, the others are bisected.

use std::{f64::consts::PI, sync::LazyLock};

/// Number of coefficients.
pub(crate) const COEFFICIENTS: usize = DEGREE + 1;

const DEGREE: usize = 8;

/// Relative precision of the maxima.
const PRECISION: f64 = 1e-10;

/// Maximum number of bisections: further ones would only resolve rounding errors.
const HALVINGS: u32 = 40;

/// Polynomial of degree eight or less, by its coefficients in the Bernstein basis of degree eight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bernstein(pub(crate) [f64; COEFFICIENTS]);

/// Maximum, and its position in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Largest {
    pub(crate) value: f64,
    pub(crate) parameter: f64,
}

impl Bernstein {
    /// Creates the polynomial with the coefficients `powers` of 1, t, t^2 and so on, at most nine.
    pub(crate) fn from_powers(powers: &[f64]) -> Self {
        Self(std::array::from_fn(|i| {
            let terms = powers.iter().enumerate().take(i + 1);
            terms.map(|(k, c)| c * binomial(i, k) / binomial(DEGREE, k)).sum()
        }))
    }

    /// Returns the largest value of `key` of the polynomial, if it is above `floor`. `key` must be
    /// convex.
    ///
    /// The result is infinite if a coefficient is NaN.
    pub(crate) fn largest(&self, key: impl Fn(f64) -> f64 + Copy, floor: f64) -> Option<Largest> {
        let bound = bound(&self.0, key);
        if bound <= floor {
            return None;
        }
        if !bound.is_finite() {
            return Some(Largest { value: f64::INFINITY, parameter: 0.0 });
        }
        let mut best = Largest { value: floor, parameter: f64::NAN };
        // A polynomial that is close to zero everywhere is not worth a search.
        let rounding = PRECISION * self.0.iter().fold(0.0_f64, |max, c| max.max(c.abs()));
        search(&self.0, key, [0.0, 1.0], rounding, &mut best);
        best.parameter.is_finite().then_some(best)
    }
}

/// Returns the largest `key` of the coefficients; infinite if one is NaN.
fn bound(coefficients: &[f64; COEFFICIENTS], key: impl Fn(f64) -> f64) -> f64 {
    coefficients.iter().fold(f64::NEG_INFINITY, |max, &c| {
        let value = key(c);
        if value.is_nan() { f64::INFINITY } else { max.max(value) }
    })
}

fn search(
    coefficients: &[f64; COEFFICIENTS],
    key: impl Fn(f64) -> f64 + Copy,
    [from, width]: [f64; 2],
    rounding: f64,
    best: &mut Largest,
) {
    for (end, value) in [(from, coefficients[0]), (from + width, coefficients[DEGREE])] {
        if key(value) > best.value {
            *best = Largest { value: key(value), parameter: end };
        }
    }
    let enough = best.value + PRECISION * best.value.abs() + rounding;
    if bound(coefficients, key) <= enough || width < 0.5_f64.powi(HALVINGS.cast_signed()) {
        return;
    }
    let [left, right] = halves(coefficients);
    let half = 0.5 * width;
    // The more promising half first: it may make the other one unnecessary.
    if key(right[DEGREE]) > key(left[0]) {
        search(&right, key, [from + half, half], rounding, best);
        search(&left, key, [from, half], rounding, best);
    } else {
        search(&left, key, [from, half], rounding, best);
        search(&right, key, [from + half, half], rounding, best);
    }
}

/// Returns the polynomial on both halves of its interval: de Casteljau's algorithm.
fn halves(coefficients: &[f64; COEFFICIENTS]) -> [[f64; COEFFICIENTS]; 2] {
    let mut row = *coefficients;
    let (mut left, mut right) = (row, row);
    for level in 1..COEFFICIENTS {
        for i in 0..COEFFICIENTS - level {
            row[i] = 0.5 * (row[i] + row[i + 1]);
        }
        left[level] = row[0];
        right[DEGREE - level] = row[DEGREE - level];
    }
    [left, right]
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product()
}

/// Values of eight functions: seven joints, and one more to fill a vector register.
pub(crate) type Octet = [f64; 8];

/// Interpolation of eight functions by polynomials of degree eight at the nine nodes `places`.
#[derive(Debug)]
pub(crate) struct Interpolation {
    /// Nodes in [0, 1]: the extrema of the Chebyshev polynomial of degree eight.
    pub(crate) places: [f64; COEFFICIENTS],
    /// Matrix from values to Bernstein coefficients.
    to_bernstein: [[f64; COEFFICIENTS]; COEFFICIENTS],
    /// Matrix from values to the last three Chebyshev coefficients.
    to_tail: [[f64; COEFFICIENTS]; 3],
}

pub(crate) static INTERPOLATION: LazyLock<Interpolation> = LazyLock::new(Interpolation::new);

impl Interpolation {
    fn new() -> Self {
        let n = DEGREE as f64;
        let angle = |k: usize| PI * k as f64 / n;
        let end = |k: usize| if k == 0 || k == DEGREE { 0.5 } else { 1.0 };
        // Weight of the value at node k in Chebyshev coefficient m, nodes from 0 to 1.
        let chebyshev =
            |m: usize, k: usize| 2.0 / n * end(m) * end(k) * (angle(DEGREE - k) * m as f64).cos();
        // Chebyshev polynomial of degree m in the Bernstein basis of degree m, then of degree
        // eight.
        let basis: [[f64; COEFFICIENTS]; COEFFICIENTS] = std::array::from_fn(|m| {
            let mut c = [0.0; COEFFICIENTS];
            for (i, c) in c.iter_mut().enumerate().take(m + 1) {
                let sign = if (m - i) % 2 == 0 { 1.0 } else { -1.0 };
                *c = sign * binomial(2 * m, 2 * i) / binomial(m, i);
            }
            for degree in m..DEGREE {
                let low = c;
                for i in 0..=degree + 1 {
                    let share = i as f64 / (degree + 1) as f64;
                    let before = if i > 0 { low[i - 1] } else { 0.0 };
                    c[i] = share * before + (1.0 - share) * low[i];
                }
            }
            c
        });
        Self {
            places: std::array::from_fn(|k| 0.5 * (1.0 + angle(DEGREE - k).cos())),
            to_bernstein: std::array::from_fn(|i| {
                std::array::from_fn(|k| {
                    (0..COEFFICIENTS).map(|m| basis[m][i] * chebyshev(m, k)).sum()
                })
            }),
            to_tail: std::array::from_fn(|m| std::array::from_fn(|k| chebyshev(DEGREE - 2 + m, k))),
        }
    }

    /// Returns true if each function is a polynomial of degree eight to `precision`: its last
    /// Chebyshev coefficients are that small. False if a value is NaN.
    pub(crate) fn is_exact(&self, values: &[Octet; COEFFICIENTS], precision: f64) -> bool {
        self.to_tail
            .iter()
            .all(|weights| combine(weights, values).iter().all(|c| c.abs() <= precision))
    }

    /// Returns the polynomials of all functions.
    pub(crate) fn polynomials(&self, values: &[Octet; COEFFICIENTS]) -> [Bernstein; 8] {
        let rows: [Octet; COEFFICIENTS] =
            std::array::from_fn(|i| combine(&self.to_bernstein[i], values));
        std::array::from_fn(|j| Bernstein(std::array::from_fn(|i| rows[i][j])))
    }
}

fn combine(weights: &[f64; COEFFICIENTS], values: &[Octet; COEFFICIENTS]) -> Octet {
    let mut sum = [0.0; 8];
    for (weight, row) in weights.iter().zip(values) {
        for (sum, value) in sum.iter_mut().zip(row) {
            *sum += weight * value;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(powers: &[f64], t: f64) -> f64 {
        powers.iter().rev().fold(0.0, |sum, c| sum * t + c)
    }

    /// 27 t (1 - t)^2 / 4 is 1 at 1/3, by hand.
    #[test]
    fn a_cubic_is_largest_where_its_derivative_says() {
        let cubic = Bernstein::from_powers(&[0.0, 6.75, -13.5, 6.75]);
        let actual = cubic.largest(f64::abs, 0.0).unwrap();
        assert!(
            (actual.value - 1.0).abs() < 1e-9 && (actual.parameter - 1.0 / 3.0).abs() < 1e-4,
            "{actual:?}"
        );
        assert!(cubic.largest(f64::abs, 1.1).is_none());
        let below = Bernstein::from_powers(&[0.0, -6.75, 13.5, -6.75]);
        assert_eq!(below.largest(f64::abs, 0.0).unwrap().value, actual.value);
        assert!(cubic.largest(|v| -v, 0.0).is_none());
    }

    #[test]
    fn nan_counts_as_infinite() {
        let broken = Bernstein::from_powers(&[0.0, f64::NAN]);
        assert_eq!(broken.largest(f64::abs, 3.0).unwrap().value, f64::INFINITY);
    }

    /// Compares random polynomials with a million samples.
    #[test]
    fn nothing_is_larger_in_between() {
        let mut rng = fastrand::Rng::with_seed(1);
        for _ in 0..20 {
            let powers: [f64; COEFFICIENTS] = std::array::from_fn(|_| rng.f64() - 0.5);
            let actual = Bernstein::from_powers(&powers).largest(f64::abs, 0.0).unwrap();
            let sampled = (0..=1_000_000)
                .map(|i| value(&powers, f64::from(i) * 1e-6).abs())
                .fold(0.0, f64::max);
            assert!((actual.value - sampled).abs() < 1e-9, "{actual:?}, {sampled}");
            assert!((value(&powers, actual.parameter).abs() - actual.value).abs() < 1e-12);
        }
    }

    #[test]
    fn interpolation_finds_the_polynomial() {
        let powers = [0.3, -1.0, 2.0, 0.5, -3.0, 1.0, 0.7, -0.2, 0.4];
        let values_at = |t: f64| -> Octet { std::array::from_fn(|j| j as f64 * value(&powers, t)) };
        let values = INTERPOLATION.places.map(values_at);
        assert_eq!([INTERPOLATION.places[0], INTERPOLATION.places[DEGREE]], [0.0, 1.0]);
        let expected = Bernstein::from_powers(&powers);
        for (j, actual) in INTERPOLATION.polynomials(&values).iter().enumerate() {
            for (actual, expected) in actual.0.iter().zip(expected.0) {
                assert!((actual - j as f64 * expected).abs() < 1e-12, "{actual}, {expected}");
            }
        }
        // t^8 shows in the tail, t^5 does not.
        assert!(!INTERPOLATION.is_exact(&values, 1e-6));
        let values = INTERPOLATION.places.map(|t| [t.powi(5); 8]);
        assert!(INTERPOLATION.is_exact(&values, 1e-14));
    }
}
