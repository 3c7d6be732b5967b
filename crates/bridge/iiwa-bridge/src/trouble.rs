//! Warnings about persistent problems: the first one immediately, then one per minute.

use std::{
    fmt,
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

/// Interval between warnings about the same problem.
const EVERY: Duration = Duration::from_mins(1);

/// A problem that may persist or recur.
#[derive(Debug, Default)]
pub(crate) struct Trouble {
    warned: Option<Instant>,
}

impl Trouble {
    /// Logs a warning, unless a warning about the same problem is recent.
    pub(crate) fn warn(&mut self, message: fmt::Arguments<'_>) {
        if self.warned.is_none_or(|instant| instant.elapsed() >= EVERY) {
            self.warned = Some(Instant::now());
            tracing::warn!("{message}");
        }
    }

    /// Marks the problem as solved: the next one is a new problem. Returns true if there was a
    /// problem.
    pub(crate) fn clear(&mut self) -> bool {
        self.warned.take().is_some()
    }
}

/// Waits for a shutdown.
#[cfg(feature = "tls")]
pub(crate) async fn until_shutdown(shutdown: &AtomicBool) {
    while !shutdown.load(Ordering::Relaxed) {
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
}

/// Sleeps, or returns early at a shutdown.
pub(crate) fn pause(duration: Duration, shutdown: &AtomicBool) {
    const STEP: Duration = Duration::from_millis(50);
    let since = Instant::now();
    while since.elapsed() < duration && !shutdown.load(Ordering::Relaxed) {
        thread::sleep(STEP.min(duration.saturating_sub(since.elapsed())));
    }
}
