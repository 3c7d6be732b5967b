//! Warnings about what lasts: the first at once, then one a minute.

use std::{
    fmt,
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

/// Time between two warnings about the same trouble.
const EVERY: Duration = Duration::from_mins(1);

/// Trouble that may last, or come again and again.
#[derive(Debug, Default)]
pub(crate) struct Trouble {
    warned: Option<Instant>,
}

impl Trouble {
    /// Warns, unless a warning about the same trouble is recent.
    pub(crate) fn warn(&mut self, what: fmt::Arguments<'_>) {
        if self.warned.is_none_or(|at| at.elapsed() >= EVERY) {
            self.warned = Some(Instant::now());
            tracing::warn!("{what}");
        }
    }

    /// It is over: the next trouble is a new one. Returns whether there was any.
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
