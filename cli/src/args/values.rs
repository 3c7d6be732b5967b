//! Parsers and ranges of option values.

use std::time::{Duration, UNIX_EPOCH};

use iiwa_program::{MAX_FLANGE_M, MAX_TORQUE_LIMIT, MIN_OVERRIDE, MIN_TORQUE_LIMIT};

/// A number.
pub(super) fn number(text: &str) -> Result<f64, String> {
    let value: f64 = text.trim().parse().map_err(|_| format!("`{text}` is not a number"))?;
    if value.is_finite() { Ok(value) } else { Err(format!("`{text}` is not finite")) }
}

pub(super) fn within(text: &str, low: f64, high: f64, unit: &str) -> Result<f64, String> {
    let value = number(text)?;
    let inside = (low..=high).contains(&value);
    if inside { Ok(value) } else { Err(format!("the range is {low} to {high}{unit}")) }
}

/// A whole number, with its range.
pub(super) fn whole<T: TryFrom<i64>, const LOW: i64, const HIGH: i64>(
    text: &str,
) -> Result<T, String> {
    let value: i64 = text.trim().parse().map_err(|_| format!("`{text}` is not a whole number"))?;
    let inside = Some(value).filter(|value| (LOW..=HIGH).contains(value));
    inside
        .and_then(|value| T::try_from(value).ok())
        .ok_or_else(|| format!("the range is {LOW} to {HIGH}"))
}

/// A time, a distance or a gate's limit.
pub(super) fn at_least_0(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if value >= 0.0 { Ok(value) } else { Err("it cannot be negative".to_owned()) }
}

/// Of samples in a file, in Hz.
pub(super) fn rate(text: &str) -> Result<f64, String> {
    within(text, 0.1, 100_000.0, " Hz")
}

/// A torque limit.
pub(super) fn torque_percent(text: &str) -> Result<f64, String> {
    within(text, 100.0 * MIN_TORQUE_LIMIT, 100.0 * MAX_TORQUE_LIMIT, " %")
}

/// An override.
pub(super) fn override_percent(text: &str) -> Result<f64, String> {
    within(text, 100.0 * MIN_OVERRIDE, 100.0, " %")
}

/// A length of the robot, in mm.
pub(super) fn length_mm(text: &str) -> Result<f64, String> {
    within(text, 1.0, 1e3 * MAX_FLANGE_M, " mm")
}

/// Seven numbers with commas in between.
pub(super) fn seven(text: &str) -> Result<[f64; 7], String> {
    let values = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
    let count = values.len();
    values.try_into().map_err(|_| format!("there are {count} numbers, and seven joints"))
}

/// An instant, as the time since 1970.
pub(super) fn epoch(text: &str) -> Result<Duration, String> {
    // The end of 2037. Messages count seconds in 31 bits, to 19 January 2038.
    let last = Duration::from_secs(2_145_916_799);
    humantime::parse_rfc3339(text)
        .ok()
        .and_then(|instant| instant.duration_since(UNIX_EPOCH).ok())
        .filter(|epoch| *epoch <= last)
        .ok_or_else(|| "an instant from 1970 to 2037 is needed, as 2020-01-01T00:00:00Z".to_owned())
}
