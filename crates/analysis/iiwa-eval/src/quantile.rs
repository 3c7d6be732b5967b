//! Medians and other quantiles.

/// Returns the median of some numbers and reorders them; 0 for an empty slice.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    quantile(values, 0.5)
}

/// Returns the value below which a share of the numbers is, and reorders them; 0 for an empty
/// slice.
pub(crate) fn quantile(values: &mut [f64], share: f64) -> f64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "share <= 1")]
    let index = (share * values.len() as f64) as usize;
    let index = index.min(values.len().saturating_sub(1));
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(index, f64::total_cmp).1
}
