//! Values of options for commands with a robot, and their ranges.

use iiwa_link::message::IoValue;

use super::values::within;

/// Of samples of a virtual robot, in Hz.
pub(super) fn sampling_rate(text: &str) -> Result<f64, String> {
    within(text, 50.0, 10_000.0, " Hz")
}

/// Speed relative to real time.
pub(super) fn speed(text: &str) -> Result<f64, String> {
    within(text, 0.01, 100.0, "")
}

/// A lag in ms.
pub(super) fn lag(text: &str) -> Result<f64, String> {
    within(text, 0.0, 1000.0, " ms")
}

/// A standard deviation in rad.
pub(super) fn noise(text: &str) -> Result<f64, String> {
    within(text, 0.0, 0.1, " rad")
}

pub(super) fn percent(text: &str) -> Result<f64, String> {
    within(text, 0.0, 100.0, " %")
}

pub(super) fn percent_above_zero(text: &str) -> Result<f64, String> {
    within(text, 0.1, 100.0, " %")
}

/// A period in s.
pub(super) fn period(text: &str) -> Result<f64, String> {
    within(text, 0.1, 1e6, " s")
}

/// A signal with its value, `NAME=VALUE`.
pub(super) fn signal(text: &str) -> Result<(String, IoValue), String> {
    let (name, value) = text.split_once('=').ok_or("give NAME=VALUE")?;
    Ok((name.to_owned(), io_value(value)?))
}

/// The value of an output.
pub(super) fn io_value(text: &str) -> Result<IoValue, String> {
    serde_json::from_str(text).map_err(|_| format!("`{text}` is not true, false or a number"))
}
