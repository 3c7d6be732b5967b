//! The log of long-running commands, on standard error.

use std::{
    collections::HashMap,
    io::{self, Write},
    sync::{Mutex, PoisonError},
    time::{Duration, Instant},
};

use tracing::{Metadata, callsite::Identifier};
use tracing_subscriber::fmt::MakeWriter;

/// Starts the log.
pub(crate) fn start() {
    let started = tracing_subscriber::fmt()
        .with_writer(Limited::default())
        .with_max_level(tracing::Level::INFO)
        .with_target(false)
        .with_ansi(false)
        .try_init();
    // It may have been started before.
    drop(started);
}

/// Prints what the solver traces, as it is.
pub(crate) fn trace() {
    let started = tracing_subscriber::fmt()
        .with_writer(io::stderr)
        .with_max_level(tracing::Level::TRACE)
        .without_time()
        .with_level(false)
        .with_target(false)
        .with_ansi(false)
        .try_init();
    // It may have been started before.
    drop(started);
}

/// Lines from one place in the program within [`WINDOW`], at most. A peer that repeats a fault must not fill
/// the disk.
const MAX_LINES: u64 = 20;

const WINDOW: Duration = Duration::from_secs(10);

/// Standard error with a bound on repeated lines; the rest are counted.
#[derive(Default)]
struct Limited(Mutex<HashMap<Identifier, Lines>>);

/// Lines from one place in the program.
struct Lines {
    since: Instant,
    count: u64,
}

impl Limited {
    /// Whether to print a line, and how many like it were left out before.
    fn admit(&self, from: Identifier, now: Instant) -> (bool, u64) {
        let mut places = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let lines = places.entry(from).or_insert(Lines { since: now, count: 0 });
        let mut left_out = 0;
        if now.saturating_duration_since(lines.since) >= WINDOW {
            left_out = lines.count.saturating_sub(MAX_LINES);
            *lines = Lines { since: now, count: 0 };
        }
        lines.count += 1;
        (lines.count <= MAX_LINES, left_out)
    }
}

impl<'a> MakeWriter<'a> for Limited {
    type Writer = Box<dyn Write>;

    fn make_writer(&'a self) -> Self::Writer {
        Box::new(io::stderr())
    }

    fn make_writer_for(&'a self, meta: &Metadata<'_>) -> Self::Writer {
        // Libraries tell what they do on the way; what matters of it is in our own lines.
        if !meta.target().starts_with("iiwa") {
            return Box::new(io::sink());
        }
        let (is_printed, left_out) = self.admit(meta.callsite(), Instant::now());
        if !is_printed {
            return Box::new(io::sink());
        }
        if left_out > 0 {
            // A failure cannot be reported anywhere.
            let _ = writeln!(io::stderr(), "({left_out} lines like the next one were left out)");
        }
        Box::new(io::stderr())
    }
}

#[cfg(test)]
mod tests {
    use tracing::{Callsite, Metadata, subscriber::Interest};

    use super::*;

    struct Place;

    impl Callsite for Place {
        fn set_interest(&self, _: Interest) {}
        fn metadata(&self) -> &Metadata<'_> {
            unreachable!("only its identity counts")
        }
    }

    #[test]
    fn repeated_lines_are_counted() {
        static PLACE: Place = Place;
        let log = Limited::default();
        let from = Instant::now();
        let mut admitted = 0;
        let mut left_out = 0;
        // A hundred lines a second for a minute.
        for hundredth in 0..6000 {
            let now = from + Duration::from_millis(10 * hundredth);
            let (is_printed, before) = log.admit(Identifier(&PLACE), now);
            admitted += u64::from(is_printed);
            left_out += before;
        }
        assert_eq!(admitted, 6 * MAX_LINES);
        assert_eq!(left_out, 5 * (1000 - MAX_LINES));
    }
}
