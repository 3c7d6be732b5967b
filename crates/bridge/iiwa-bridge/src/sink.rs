//! Where messages go.

use crate::message::Message;

/// A destination of messages.
pub trait Sink: Send + Sync {
    /// Takes a message. It must not wait: the feeds of all robots call it, up to a thousand times a second each.
    fn take(&self, message: &Message);
}
