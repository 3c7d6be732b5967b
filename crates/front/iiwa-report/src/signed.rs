//! Numbers without a negative zero.

/// A number that is not -0 when it is printed.
pub(crate) fn rounded(value: f64, digits: i32) -> f64 {
    let scale = 10_f64.powi(digits);
    (value * scale).round() / scale + 0.0
}

/// A number with its sign; zero has none.
pub(crate) fn signed(value: f64, digits: u8) -> String {
    let precision = usize::from(digits);
    match rounded(value, i32::from(digits)) {
        0.0 => format!("{:.precision$}", 0.0),
        value => format!("{value:+.precision$}"),
    }
}
