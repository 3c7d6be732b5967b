//! Vectors in joint space.
//!
//! ```
//! use iiwa_kin::vector;
//!
//! let from = [0.0; 7];
//! let to = [0.3, 0.0, 0.0, 0.4, 0.0, 0.0, 0.0];
//! assert_eq!(vector::distance(&from, &to), 0.5);
//! assert_eq!(vector::add_scaled(&from, 0.5, &to)[3], 0.2);
//! ```

use crate::Joints;

/// Difference `a - b`.
#[must_use]
#[inline]
pub fn sub(a: &Joints, b: &Joints) -> Joints {
    std::array::from_fn(|j| a[j] - b[j])
}

/// Sum `a + k b`.
#[must_use]
#[inline]
pub fn add_scaled(a: &Joints, k: f64, b: &Joints) -> Joints {
    std::array::from_fn(|j| a[j] + k * b[j])
}

/// Product `k a`.
#[must_use]
#[inline]
pub fn scale(k: f64, a: &Joints) -> Joints {
    a.map(|v| k * v)
}

/// Scalar product.
#[must_use]
#[inline]
pub fn dot(a: &Joints, b: &Joints) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Euclidean length.
#[must_use]
pub fn norm(a: &Joints) -> f64 {
    dot(a, a).sqrt()
}

/// Euclidean distance between two positions, in rad.
#[must_use]
pub fn distance(a: &Joints, b: &Joints) -> f64 {
    norm(&sub(a, b))
}

/// Unit vector of a nonzero vector.
#[must_use]
pub fn unit(a: &Joints) -> Joints {
    scale(norm(a).recip(), a)
}

/// Largest multiple of `direction` within the limits of every joint; the smallest quotient decides.
/// `f64::MAX` for a zero direction.
#[must_use]
pub fn largest_multiple(direction: &Joints, limits: &Joints) -> f64 {
    direction.iter().zip(limits).map(|(d, limit)| limit / d.abs()).fold(f64::MAX, f64::min)
}

/// Angle between two unit vectors, in rad: 0 straight on, pi reversed (Larsen 2019, Eq. 28).
///
/// Computing half the angle from the lengths of sum and difference is exact near 0 and pi, where
/// the arc cosine loses half of the digits.
#[must_use]
pub fn angle(a: &Joints, b: &Joints) -> f64 {
    let sum = add_scaled(a, 1.0, b);
    2.0 * norm(&sub(a, b)).atan2(norm(&sum))
}
