//! Numbers without a negative zero.

/// Rounds a number; the result never prints as -0.
pub(crate) fn rounded(value: f64, digits: i32) -> f64 {
    let scale = 10_f64.powi(digits);
    (value * scale).round() / scale + 0.0
}

/// Formats a number with its sign; zero has no sign.
pub(crate) fn signed(value: f64, digits: u8) -> String {
    let precision = usize::from(digits);
    match rounded(value, i32::from(digits)) {
        0.0 => format!("{:.precision$}", 0.0),
        value => format!("{value:+.precision$}"),
    }
}
