//! Long durations in words.

use std::time::Duration;

/// A long duration, given in s, to the second: `115days 17h 46m 40s`.
#[must_use]
pub fn long_duration(time_s: f64) -> String {
    let time = Duration::try_from_secs_f64(time_s.round()).unwrap_or(Duration::MAX);
    humantime::format_duration(time).to_string()
}
