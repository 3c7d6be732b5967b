//! Vectors in joint space, and quantiles.

use iiwa_kin::Joints;

pub(crate) fn sub(a: &Joints, b: &Joints) -> Joints {
    std::array::from_fn(|j| a[j] - b[j])
}

/// a + k b.
pub(crate) fn add_scaled(a: &Joints, k: f64, b: &Joints) -> Joints {
    std::array::from_fn(|j| a[j] + k * b[j])
}

pub(crate) fn scale(k: f64, a: &Joints) -> Joints {
    a.map(|v| k * v)
}

pub(crate) fn dot(a: &Joints, b: &Joints) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(crate) fn norm(a: &Joints) -> f64 {
    dot(a, a).sqrt()
}

pub(crate) fn distance(a: &Joints, b: &Joints) -> f64 {
    norm(&sub(a, b))
}

/// The direction of a vector that is not zero.
pub(crate) fn unit(a: &Joints) -> Joints {
    scale(norm(a).recip(), a)
}
