//! The event loop of a thread with sockets.

use std::io;

use tokio::runtime::{Builder, Runtime};

/// A single-threaded runtime.
///
/// # Errors
///
/// The system has no resources for it.
pub(crate) fn runtime() -> io::Result<Runtime> {
    Builder::new_current_thread().enable_io().enable_time().build()
}
