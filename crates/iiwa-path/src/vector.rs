//! Vectors in joint space.

use iiwa_kin::Joints;

#[inline(always)]
pub(crate) fn sub(a: &Joints, b: &Joints) -> Joints {
    std::array::from_fn(|j| a[j] - b[j])
}

/// `a + k b`.
#[inline(always)]
pub(crate) fn add_scaled(a: &Joints, k: f64, b: &Joints) -> Joints {
    std::array::from_fn(|j| a[j] + k * b[j])
}

#[inline(always)]
pub(crate) fn scale(k: f64, a: &Joints) -> Joints {
    a.map(|v| k * v)
}

#[inline(always)]
pub(crate) fn dot(a: &Joints, b: &Joints) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(crate) fn norm(a: &Joints) -> f64 {
    dot(a, a).sqrt()
}

/// Angle between two unit vectors, in rad: 0 straight on, pi turned back (Larsen 2019, Eq. 28).
///
/// Half the angle from the lengths of sum and difference is exact near 0 and pi, where the inverse
/// cosine loses half of the digits.
pub(crate) fn angle(a: &Joints, b: &Joints) -> f64 {
    let sum = add_scaled(a, 1.0, b);
    2.0 * norm(&sub(a, b)).atan2(norm(&sum))
}
