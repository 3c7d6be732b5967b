//! The solver's iterations, on standard error.

/// Starts to print them.
pub(crate) fn start() {
    let started = tracing_subscriber::fmt()
        .with_writer(std::io::stderr)
        .with_max_level(tracing::Level::TRACE)
        .without_time()
        .with_level(false)
        .with_target(false)
        .with_ansi(false)
        .try_init();
    // It may have been started before.
    drop(started);
}
