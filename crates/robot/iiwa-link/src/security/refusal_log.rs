//! Rate limiting of log messages about refused clients.

use std::time::{Duration, Instant};

use super::key::PublicKey;

/// Refused clients retry several times a second: each is logged once in this time.
const LOG_INTERVAL: Duration = Duration::from_mins(1);

/// Capacity. Clients with ever new keys replace others, and are logged each time.
const CAPACITY: usize = 64;

/// Clients that were refused recently.
#[derive(Default)]
pub(super) struct RefusalLog {
    entries: Vec<(String, Option<PublicKey>, Instant)>,
}

impl RefusalLog {
    /// Records a refusal. Returns whether it is to be logged: the first of this key at this address in a
    /// while.
    pub(super) fn record(&mut self, address: &str, key: Option<PublicKey>) -> bool {
        let now = Instant::now();
        self.entries.retain(|(.., when)| now.duration_since(*when) < LOG_INTERVAL);
        if self.entries.iter().any(|(a, k, _)| a == address && *k == key) {
            return false;
        }
        if self.entries.len() == CAPACITY {
            self.entries.remove(0);
        }
        self.entries.push((address.to_owned(), key, now));
        true
    }
}
