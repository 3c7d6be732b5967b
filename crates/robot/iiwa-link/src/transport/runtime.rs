//! The event loop of a thread with sockets.

use std::io;

use tokio::runtime::{Builder, Runtime};

/// Creates a single-threaded runtime.
///
/// # Errors
///
/// The system has no resources for the runtime.
pub(crate) fn runtime() -> io::Result<Runtime> {
    Builder::new_current_thread().enable_io().enable_time().build()
}
