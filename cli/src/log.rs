//! What a long-running command has to say, on standard error.

/// From now on, what happens is told there.
pub(crate) fn start() {
    let told = tracing_subscriber::fmt()
        .with_writer(std::io::stderr)
        .with_max_level(tracing::Level::INFO)
        .with_target(false)
        .with_ansi(false)
        .try_init();
    // Somebody else tells it already.
    drop(told);
}
