//! Delay of stream messages.

use std::time::Instant;

/// Delay of messages relative to the fastest message, because the controller clock is not shared.
///
/// ```
/// use std::time::{Duration, Instant};
///
/// use iiwa_link::Lag;
///
/// let (from, mut lag) = (Instant::now(), Lag::default());
/// assert_eq!(lag.behind_ms(from, 100.0), 0.0);
/// assert!((lag.behind_ms(from + Duration::from_millis(1003), 101.0) - 3.0).abs() < 1e-6);
/// ```
#[derive(Debug, Default)]
pub struct Lag {
    since: Option<Instant>,
    /// Minimum of reception time minus time stamp, in s: in the previous window, and in the current
    /// one.
    min_late_s: [f64; 2],
    window_from_s: f64,
    last_s: f64,
}

impl Lag {
    /// Length of a window: clocks drift, so old messages are not a valid reference.
    const WINDOW_S: f64 = 10.0;

    /// Returns the delay of a message relative to the fastest message of the last seconds, in ms,
    /// for a message with the stamp `t_s` that is received at `now`.
    pub fn behind_ms(&mut self, now: Instant, t_s: f64) -> f64 {
        let now_s = (now - *self.since.get_or_insert(now)).as_secs_f64();
        let late_s = now_s - t_s;
        // Stamps decrease when another drive has started.
        if self.last_s > t_s || self.min_late_s == [0.0; 2] {
            self.min_late_s = [late_s; 2];
            self.window_from_s = now_s;
        }
        self.last_s = t_s;
        if now_s - self.window_from_s > Self::WINDOW_S {
            // With two windows, a new window has a reference from its first message on.
            self.min_late_s = [self.min_late_s[1], late_s];
            self.window_from_s = now_s;
        }
        self.min_late_s[1] = self.min_late_s[1].min(late_s);
        1e3 * (late_s - self.min_late_s[0].min(self.min_late_s[1]))
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn lag_is_next_to_the_fastest() {
        let from = Instant::now();
        let mut lag = Lag::default();
        let mut at = |now_s: f64, t_s| lag.behind_ms(from + Duration::from_secs_f64(now_s), t_s);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "{a} is not {b}");
        near(at(0.0, 100.0), 0.0);
        near(at(1.003, 101.0), 3.0);
        near(at(1.999, 102.0), 0.0);
        near(at(3.0, 103.0), 1.0);
        // A clock that loses 1 ms per second is followed.
        for i in 4..100 {
            let i = f64::from(i);
            assert!(at(1.001 * i, 100.0 + i) < 25.0);
        }
        // Another drive has started.
        near(at(200.0, 0.5), 0.0);
        near(at(200.504, 1.0), 4.0);
    }
}
