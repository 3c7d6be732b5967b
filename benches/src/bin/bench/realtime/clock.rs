//! Common clock of all processes.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// System clock, which all processes share.
pub(crate) struct SystemClock {
    now: Instant,
    now_us: i64,
}

impl SystemClock {
    pub(crate) fn new() -> Self {
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        Self { now: Instant::now(), now_us: micros(since) }
    }

    pub(crate) fn us(&self, instant: Instant) -> i64 {
        let ahead = instant.saturating_duration_since(self.now);
        self.now_us + micros(ahead) - micros(self.now.saturating_duration_since(instant))
    }
}

fn micros(time: Duration) -> i64 {
    i64::try_from(time.as_micros()).unwrap_or(i64::MAX)
}
