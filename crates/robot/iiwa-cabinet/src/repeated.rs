//! Periodic faults.

use std::time::{Duration, Instant};

/// Schedule of a periodic fault, in real time.
#[derive(Clone, Copy, Debug)]
pub struct Repeated {
    every: Option<Duration>,
    last: Instant,
}

impl Repeated {
    /// Creates a schedule with a period, in s, from now on; `None` means never.
    #[must_use]
    pub fn new(every_s: Option<f64>) -> Self {
        let every = every_s.map(|s| Duration::try_from_secs_f64(s).unwrap_or(Duration::MAX));
        Self { every, last: Instant::now() }
    }

    /// Returns true if a period has passed since the fault was last due.
    pub fn is_due(&mut self) -> bool {
        let due = self.every.is_some_and(|every| self.last.elapsed() >= every);
        if due {
            self.last = Instant::now();
        }
        due
    }
}
