//! Rate limiting of samples.

use std::{
    sync::{Mutex, PoisonError},
    time::{Duration, Instant},
};

/// Rate limiter for samples.
#[derive(Debug)]
pub(super) struct Pace {
    period: Option<Duration>,
    /// Time at which the next sample is due.
    next: Mutex<Option<Instant>>,
}

impl Pace {
    /// Creates a limiter for a maximum rate; `None` for all samples.
    pub(super) fn new(rate_hz: Option<f64>) -> Self {
        let period = rate_hz.and_then(|rate_hz| Duration::try_from_secs_f64(1.0 / rate_hz).ok());
        Self { period, next: Mutex::default() }
    }

    /// Returns true if a sample that has just arrived is to be sent.
    pub(super) fn is_due(&self) -> bool {
        let Some(period) = self.period else { return true };
        let now = Instant::now();
        let mut next = self.next.lock().unwrap_or_else(PoisonError::into_inner);
        match *next {
            Some(due) if now < due => false,
            // The mean rate is maintained, unless samples were missing.
            Some(due) if now - due < period => {
                *next = Some(due + period);
                true
            }
            _ => {
                *next = Some(now + period);
                true
            }
        }
    }
}
