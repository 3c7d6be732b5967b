//! Rate limit for repeated log lines. A peer that repeats a fault must not fill the disk.

use std::{
    collections::HashMap,
    hash::Hash,
    time::{Duration, Instant},
};

/// Maximum number of lines per source within [`WINDOW`].
const MAX_LINES: u64 = 20;

const WINDOW: Duration = Duration::from_secs(10);

/// Counts of lines by their source, such as a place in the program.
#[derive(Debug)]
pub struct Repetition<S>(HashMap<S, WindowLines>);

/// Lines of one source within the current window.
#[derive(Debug)]
struct WindowLines {
    since: Instant,
    count: u64,
}

impl<S> Default for Repetition<S> {
    fn default() -> Self {
        Self(HashMap::new())
    }
}

impl<S: Eq + Hash> Repetition<S> {
    /// Counts a line. Returns true if the line is to be printed, and the number of lines suppressed
    /// in the window before.
    pub fn admit(&mut self, source: S, now: Instant) -> (bool, u64) {
        let lines = self.0.entry(source).or_insert(WindowLines { since: now, count: 0 });
        let mut suppressed = 0;
        if now.saturating_duration_since(lines.since) >= WINDOW {
            suppressed = lines.count.saturating_sub(MAX_LINES);
            *lines = WindowLines { since: now, count: 0 };
        }
        lines.count += 1;
        (lines.count <= MAX_LINES, suppressed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_lines_are_counted() {
        let mut lines = Repetition::default();
        let from = Instant::now();
        let mut admitted = 0;
        let mut suppressed = 0;
        // 100 lines per second for a minute.
        for hundredth in 0..6000 {
            let now = from + Duration::from_millis(10 * hundredth);
            let (is_printed, before) = lines.admit("source", now);
            admitted += u64::from(is_printed);
            suppressed += before;
        }
        assert_eq!(admitted, 6 * MAX_LINES);
        assert_eq!(suppressed, 5 * (1000 - MAX_LINES));
    }
}
