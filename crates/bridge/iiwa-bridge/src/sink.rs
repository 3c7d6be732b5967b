//! Message destinations.

use crate::message::Message;

/// A message destination.
pub trait Sink: Send + Sync {
    /// Accepts a message. The method must not block: the feeds of all robots call it, each up to a
    /// thousand times per second.
    fn take(&self, message: &Message);
}
