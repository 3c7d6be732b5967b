//! Publication of measurements and states, outside the FRI thread.

use std::sync::mpsc::Receiver;

use bytes::Bytes;
use iiwa_link::{Published, message::to_json, transport::Listener};

/// Maximum number of messages waiting for publication.
pub(super) const BACKLOG: usize = 4096;

/// Publishes until the sender is dropped.
pub(super) fn publish(published: &Receiver<Published>, listener: &Listener) {
    for message in published {
        let topic = Bytes::from_static(message.topic().as_bytes());
        listener.publish(&vec![topic, to_json(&message).into()]);
    }
}
