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
    let length = norm(a);
    a.map(|v| v / length)
}

/// The median of some numbers, which are put into another order; 0 of none.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    quantile(values, 0.5)
}

/// The value below which a share of the numbers is, which are put into another order; 0 of none.
pub(crate) fn quantile(values: &mut [f64], share: f64) -> f64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "share <= 1")]
    let index = (share * values.len() as f64) as usize;
    let index = index.min(values.len().saturating_sub(1));
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(index, f64::total_cmp).1
}
