//! Rotations in space by rotation vectors: exponential map and its inverse, also for Taylor series.
//!
//! ```
//! use iiwa_kin::rotation::{apply, exp, log};
//!
//! // A quarter turn about z.
//! let turn = exp(&[0.0, 0.0, std::f64::consts::FRAC_PI_2]);
//! assert!((apply(&turn, &[1.0, 0.0, 0.0])[1] - 1.0).abs() < 1e-15);
//! assert!((log(&turn)[2] - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
//! ```

use crate::{Number, Taylor};

/// A vector in space.
pub type Vec3<T> = [T; 3];
/// A matrix, row by row.
pub type Mat3<T> = [[T; 3]; 3];

/// Matrix product `a b`.
#[must_use]
pub fn product<T: Number>(a: &Mat3<T>, b: &Mat3<T>) -> Mat3<T> {
    a.map(|row| std::array::from_fn(|j| row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j]))
}

/// Transpose; for a rotation, its inverse.
#[must_use]
pub fn transposed<T: Copy>(a: &Mat3<T>) -> Mat3<T> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// Matrix-vector product `a v`.
#[must_use]
pub fn apply<T: Number>(a: &Mat3<T>, v: &Vec3<T>) -> Vec3<T> {
    a.map(|row| dot(&row, v))
}

/// Dot product `a . b`.
#[must_use]
#[inline]
pub fn dot<T: Number>(a: &Vec3<T>, b: &Vec3<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Cross product `a x b`.
#[must_use]
#[inline]
pub fn cross<T: Number>(a: &Vec3<T>, b: &Vec3<T>) -> Vec3<T> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Length of a vector.
#[must_use]
#[inline]
pub fn norm(a: &Vec3<f64>) -> f64 {
    dot(a, a).sqrt()
}

/// Difference `a - b`.
#[must_use]
#[inline]
pub fn sub(a: &Vec3<f64>, b: &Vec3<f64>) -> Vec3<f64> {
    std::array::from_fn(|i| a[i] - b[i])
}

/// Product `k a`.
#[must_use]
#[inline]
pub fn scaled(k: f64, a: &Vec3<f64>) -> Vec3<f64> {
    a.map(|v| k * v)
}

/// Converts a constant matrix to Taylor series.
#[must_use]
#[inline]
pub fn constant(a: &Mat3<f64>) -> Mat3<Taylor> {
    a.map(|row| row.map(Taylor::constant))
}

/// Exponential map `exp [r]`: the rotation about r by the length of r.
///
/// Rodrigues' formula, `1 + sin(t)/t [r] + (1 - cos t)/t^2 [r]^2` with t = |r|. Both factors are
/// smooth functions of t^2, whereas t itself is not smooth at 0.
#[must_use]
pub fn exp<T: Number>(r: &Vec3<T>) -> Mat3<T> {
    let square = dot(r, r);
    let (sinc, versine) = if square.value() < SERIES {
        (series(square, &SINC), series(square, &VERSINE))
    } else {
        let t = square.sqrt();
        let (sin, cos) = t.sin_cos();
        (sin / t, (T::constant(1.0) - cos) / square)
    };
    let one = T::constant(1.0);
    let outer = |i: usize, j: usize| versine * r[i] * r[j];
    // versine [r]^2 = versine (r r^T - t^2)
    let diagonal = |i: usize| one + outer(i, i) - versine * square;
    let s = r.map(|v| sinc * v);
    [
        [diagonal(0), outer(0, 1) - s[2], outer(0, 2) + s[1]],
        [outer(1, 0) + s[2], diagonal(1), outer(1, 2) - s[0]],
        [outer(2, 0) - s[1], outer(2, 1) + s[0], diagonal(2)],
    ]
}

/// Rotation vector of a rotation by less than half a turn: the inverse of [`exp`].
#[must_use]
pub fn log<T: Number>(a: &Mat3<T>) -> Vec3<T> {
    let half = T::constant(0.5);
    // sin(t) times the axis.
    let v = [half * (a[2][1] - a[1][2]), half * (a[0][2] - a[2][0]), half * (a[1][0] - a[0][1])];
    let cos = half * (a[0][0] + a[1][1] + a[2][2] - T::constant(1.0));
    let square = dot(&v, &v);
    if cos.value() > 0.0 && square.value() < SERIES_OF_ARCSINE {
        let factor = series(square, &ARCSINE);
        return v.map(|v| factor * v);
    }
    let sin = square.sqrt();
    let factor = T::atan2(sin, cos) / sin;
    v.map(|v| factor * v)
}

/// Rotation vector; `None` for a rotation by half a turn, whose direction is not defined.
#[must_use]
pub fn log_or_half_turn(a: &Mat3<f64>) -> Option<Vec3<f64>> {
    /// Margin below half a turn, in rad, that counts as half a turn: 0.0001 deg.
    const MARGIN_RAD: f64 = 1.8e-6;
    let r = log(a);
    let angle = norm(&r);
    (angle.is_finite() && angle < std::f64::consts::PI - MARGIN_RAD).then_some(r)
}

/// Largest squared angle, in rad^2, for which the series are used.
const SERIES: f64 = 0.25;
/// Largest squared sine for which the arc sine series is used; that series converges more slowly.
const SERIES_OF_ARCSINE: f64 = 0.01;

/// Series of sin(t)/t and (1 - cos t)/t^2 in t^2.
const SINC: [f64; 9] = alternating_factorials(1);
const VERSINE: [f64; 9] = alternating_factorials(2);

/// Coefficients (-1)^k / (2k + first)!
const fn alternating_factorials(first: usize) -> [f64; 9] {
    let mut terms = [0.0; 9];
    let (mut k, mut term) = (0, if first == 1 { 1.0 } else { 0.5 });
    while k < 9 {
        terms[k] = term;
        let n = (2 * k + first) as f64;
        term = -term / ((n + 1.0) * (n + 2.0));
        k += 1;
    }
    terms
}

/// Series of asin(x)/x in x^2.
const ARCSINE: [f64; 9] = {
    let mut terms = [0.0; 9];
    // binomial(2k, k) / 4^k
    let (mut k, mut binomial) = (0, 1.0);
    while k < 9 {
        terms[k] = binomial / (2 * k + 1) as f64;
        binomial *= (2 * k + 1) as f64 / (2 * k + 2) as f64;
        k += 1;
    }
    terms
};

fn series<T: Number>(x: T, terms: &[f64; 9]) -> T {
    let [rest @ .., last] = terms;
    rest.iter().rev().fold(T::constant(*last), |sum, term| sum * x + T::constant(*term))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_length_is_that_of_a_known_vector() {
        assert!((norm(&[2.0, -3.0, 6.0]) - 7.0).abs() < 1e-15);
    }

    proptest! {
        #[test]
        fn logarithm_and_exponential_are_inverse(
            axis in prop::array::uniform3(-1.0..1.0_f64),
            angle in prop_oneof![0.0..3.1_f64, 0.0..0.2_f64, 0.0..1e-8_f64],
        ) {
            let length = norm(&axis).max(1e-3);
            let r = scaled(angle / length, &axis);
            let turn = exp(&r);
            let unit = product(&turn, &transposed(&turn));
            for (i, row) in unit.iter().enumerate() {
                for (j, value) in row.iter().enumerate() {
                    prop_assert!((value - f64::from(u8::from(i == j))).abs() < 1e-14);
                }
            }
            // Near half a turn, the sine loses digits.
            let tolerance = 1e-15 / (std::f64::consts::PI - norm(&r)).min(1.0) * 10.0;
            prop_assert!(norm(&sub(&log(&turn), &r)) < tolerance.max(1e-14));
        }

        /// The derivatives of the series match those of the rotation.
        #[test]
        fn a_turning_frame_comes_back(
            from in prop::array::uniform3(-0.8..0.8_f64),
            by in prop::array::uniform3(-0.5..0.5_f64),
            s in -1.0..1.0_f64,
        ) {
            let s = Taylor::variable(s);
            let r: Vec3<Taylor> = std::array::from_fn(|i| {
                Taylor::constant(from[i]) + s * by[i] + s * s * s * (0.1 * by[i])
            });
            let back = log(&exp(&r));
            for i in 0..3 {
                for (actual, expected) in std::iter::zip(back[i].0, r[i].0) {
                    prop_assert!((actual - expected).abs() < 1e-11, "{actual} {expected}");
                }
            }
        }
    }
}
