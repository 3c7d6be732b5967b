//! Latched topics: the last message is kept for viewers that connect later.

use std::sync::{Arc, Mutex, PoisonError};

use foxglove::{
    PartialMetadata, RawChannel, SinkId,
    websocket::{ChannelView, Client, ServerListener},
};

/// A topic with its last message.
pub(super) struct Latched {
    channel: Arc<RawChannel>,
    /// Locked while a message is sent, so that no viewer gets an older one after a newer one.
    last: Mutex<Option<Vec<u8>>>,
}

impl Latched {
    pub(super) fn new(channel: Arc<RawChannel>) -> Self {
        Self { channel, last: Mutex::new(None) }
    }

    /// Sends a message to all viewers, and keeps it. The time is since 1970.
    pub(super) fn publish(&self, time_ns: u64, message: Vec<u8>) {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        self.channel.log_with_meta(&message, PartialMetadata::with_log_time(time_ns));
        *last = Some(message);
    }

    /// Sends the last message to a viewer that has just subscribed, stamped with the current time, at which
    /// it still holds.
    fn repeat(&self, viewer: SinkId) {
        let last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(message) = &*last {
            self.channel.log_to_sink(message, Some(viewer));
        }
    }
}

/// Sends the last messages of these topics to viewers when they subscribe.
pub(super) struct LateViewers(pub(super) Vec<Arc<Latched>>);

impl ServerListener for LateViewers {
    fn on_subscribe(&self, client: Client, channel: ChannelView<'_>) {
        let topic = self.0.iter().find(|topic| topic.channel.id() == channel.id());
        if let (Some(topic), Some(viewer)) = (topic, client.sink_id()) {
            topic.repeat(viewer);
        }
    }
}
