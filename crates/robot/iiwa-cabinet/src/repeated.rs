//! Faults that come again and again.

use std::time::{Duration, Instant};

/// When a fault is due that comes again and again, in real time.
#[derive(Clone, Copy, Debug)]
pub struct Repeated {
    every: Option<Duration>,
    last: Instant,
}

impl Repeated {
    /// With a period, in s, from now on; never without one.
    #[must_use]
    pub fn new(every_s: Option<f64>) -> Self {
        let every = every_s.map(|s| Duration::try_from_secs_f64(s).unwrap_or(Duration::MAX));
        Self { every, last: Instant::now() }
    }

    /// Whether a period has passed since it was due.
    pub fn is_due(&mut self) -> bool {
        let due = self.every.is_some_and(|every| self.last.elapsed() >= every);
        if due {
            self.last = Instant::now();
        }
        due
    }
}
