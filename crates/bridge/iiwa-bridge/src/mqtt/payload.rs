//! How often samples are sent.

use std::{
    sync::{Mutex, PoisonError},
    time::{Duration, Instant},
};

/// Lets samples pass at a rate.
#[derive(Debug)]
pub(super) struct Pace {
    period: Option<Duration>,
    /// When the next one is due.
    next: Mutex<Option<Instant>>,
}

impl Pace {
    /// At most so many per second; `None` for all.
    pub(super) fn new(rate_hz: Option<f64>) -> Self {
        let period = rate_hz.and_then(|rate_hz| Duration::try_from_secs_f64(1.0 / rate_hz).ok());
        Self { period, next: Mutex::default() }
    }

    /// Whether a sample that has just arrived is sent.
    pub(super) fn is_due(&self) -> bool {
        let Some(period) = self.period else { return true };
        let now = Instant::now();
        let mut next = self.next.lock().unwrap_or_else(PoisonError::into_inner);
        match *next {
            Some(at) if now < at => false,
            // The mean rate is kept, unless samples were missing.
            Some(at) if now - at < period => {
                *next = Some(at + period);
                true
            }
            _ => {
                *next = Some(now + period);
                true
            }
        }
    }
}
