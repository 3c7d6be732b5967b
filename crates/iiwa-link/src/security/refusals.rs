//! Which refusals are told.

use std::time::{Duration, Instant};

use crate::security::PublicKey;

/// A refused client tries again every tenth of a second: that is told once in a while.
const AGAIN: Duration = Duration::from_mins(1);

/// Clients that are remembered. Somebody who makes up keys pushes others out, and is told anyway.
const MOST: usize = 64;

/// The clients that were refused of late.
#[derive(Default)]
pub(super) struct Refusals {
    told: Vec<(String, Option<PublicKey>, Instant)>,
}

impl Refusals {
    /// Whether a client is to be told of: its key, at its address, has not been for a while.
    pub(super) fn is_news(&mut self, address: &str, key: Option<PublicKey>) -> bool {
        let now = Instant::now();
        self.told.retain(|(.., when)| now.duration_since(*when) < AGAIN);
        if self.told.iter().any(|(a, k, _)| a == address && *k == key) {
            return false;
        }
        if self.told.len() == MOST {
            self.told.remove(0);
        }
        self.told.push((address.to_owned(), key, now));
        true
    }
}
