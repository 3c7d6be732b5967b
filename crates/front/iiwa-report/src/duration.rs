//! Long durations as text.

use std::time::Duration;

/// Formats a long duration, given in s, to the second: `11 days 13 h 46 min 40 s`.
#[must_use]
pub fn long_duration(time_s: f64) -> String {
    let time = Duration::try_from_secs_f64(time_s.round()).unwrap_or(Duration::MAX);
    let text = humantime::format_duration(time).to_string();
    let parts = text.split(' ').map(|part| {
        let (count, unit) = part.split_at(part.trim_end_matches(char::is_alphabetic).len());
        format!("{count} {}", if unit == "m" { "min" } else { unit })
    });
    parts.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_set_apart() {
        assert_eq!(long_duration(6.6), "7 s");
        assert_eq!(long_duration(1e6), "11 days 13 h 46 min 40 s");
        assert_eq!(long_duration(86_460.0), "1 day 1 min");
    }
}
