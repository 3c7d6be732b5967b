//! Topics that viewers who come later get, too: the last message is kept for them.

use std::sync::{Arc, Mutex, PoisonError};

use foxglove::{
    PartialMetadata, RawChannel, SinkId,
    websocket::{ChannelView, Client, ServerListener},
};

/// A topic with its last message.
pub(super) struct Latched {
    channel: Arc<RawChannel>,
    /// Held while a message is passed on, so that nobody gets an older one after a newer one.
    last: Mutex<Option<Vec<u8>>>,
}

impl Latched {
    pub(super) fn new(channel: Arc<RawChannel>) -> Self {
        Self { channel, last: Mutex::new(None) }
    }

    /// Passes a message on to those who are there, and keeps it. The time is since 1970.
    pub(super) fn publish(&self, time_ns: u64, message: Vec<u8>) {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        self.channel.log_with_meta(&message, PartialMetadata::with_log_time(time_ns));
        *last = Some(message);
    }

    /// Passes the last message on to one who has just come. It is stamped with the time of now, at which
    /// it still holds.
    fn repeat(&self, viewer: SinkId) {
        let last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(message) = &*last {
            self.channel.log_to_sink(message, Some(viewer));
        }
    }
}

/// Repeats the last messages of these topics to viewers who come late.
pub(super) struct Late(pub(super) Vec<Arc<Latched>>);

impl ServerListener for Late {
    fn on_subscribe(&self, client: Client, channel: ChannelView<'_>) {
        let topic = self.0.iter().find(|topic| topic.channel.id() == channel.id());
        if let (Some(topic), Some(viewer)) = (topic, client.sink_id()) {
            topic.repeat(viewer);
        }
    }
}
