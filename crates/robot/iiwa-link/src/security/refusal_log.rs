//! Rate limiting of log messages about refused clients.

use std::time::{Duration, Instant};

use super::key::PublicKey;

/// Interval within which each refused client is logged once: refused clients retry several times
/// per second.
const LOG_INTERVAL: Duration = Duration::from_mins(1);

/// Capacity. Clients that keep changing their key replace other entries, and are logged each time.
const CAPACITY: usize = 64;

/// Clients that were refused recently.
#[derive(Default)]
pub(super) struct RefusalLog {
    entries: Vec<(String, Option<PublicKey>, Instant)>,
}

impl RefusalLog {
    /// Records a refusal. Returns true if it is to be logged: the first refusal of this key at this
    /// address within the interval.
    pub(super) fn record(&mut self, address: &str, key: Option<PublicKey>) -> bool {
        let now = Instant::now();
        self.entries.retain(|(.., when)| now.duration_since(*when) < LOG_INTERVAL);
        if self.entries.iter().any(|(a, k, _)| a == address && *k == key) {
            return false;
        }
        if self.entries.len() == CAPACITY {
            // The oldest: entries are in the order of their time.
            self.entries.remove(0);
        }
        self.entries.push((address.to_owned(), key, now));
        true
    }
}
