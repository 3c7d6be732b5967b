//! Log of drives, cabinets and bridges, on standard error.

use std::{
    io::{self, Write},
    sync::{Mutex, PoisonError},
    time::Instant,
};

use iiwa_files::Repetition;
use tracing::{Metadata, callsite::Identifier};
use tracing_subscriber::fmt::MakeWriter;

/// Starts the log.
pub(crate) fn start() {
    let started = tracing_subscriber::fmt()
        .with_writer(RateLimited::default())
        .with_max_level(tracing::Level::INFO)
        .with_target(false)
        .with_ansi(false)
        .try_init();
    // The log may have been started before.
    drop(started);
}

/// Standard error with a rate limit on repeated lines from one place in the program.
#[derive(Default)]
struct RateLimited(Mutex<Repetition<Identifier>>);

impl<'a> MakeWriter<'a> for RateLimited {
    type Writer = Box<dyn Write>;

    fn make_writer(&'a self) -> Self::Writer {
        Box::new(io::stderr())
    }

    fn make_writer_for(&'a self, meta: &Metadata<'_>) -> Self::Writer {
        // Events of other libraries are details of events that the iiwa crates report.
        if !meta.target().starts_with("iiwa") {
            return Box::new(io::sink());
        }
        let mut places = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (is_printed, suppressed) = places.admit(meta.callsite(), Instant::now());
        if !is_printed {
            return Box::new(io::sink());
        }
        if suppressed > 0 {
            // A failure cannot be reported anywhere.
            let _ = writeln!(io::stderr(), "({suppressed} lines like the next one were left out)");
        }
        Box::new(io::stderr())
    }
}
