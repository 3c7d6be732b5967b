//! Solver iterations on standard error.

/// Starts printing the iterations.
pub(crate) fn start() {
    let started = tracing_subscriber::fmt()
        .with_writer(std::io::stderr)
        .with_max_level(tracing::Level::TRACE)
        .without_time()
        .with_level(false)
        .with_target(false)
        .with_ansi(false)
        .try_init();
    // The log may have been started before.
    drop(started);
}
