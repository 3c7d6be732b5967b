//! What is measured goes out to subscribers, off the thread that measures.

use std::sync::mpsc::Receiver;

use bytes::Bytes;
use iiwa_link::{Published, message::to_json, transport::Listener};

/// Messages that wait to be published, at most.
pub(super) const BACKLOG: usize = 4096;

/// Publishes until there is nothing more to come.
pub(super) fn publish(published: &Receiver<Published>, listener: &Listener) {
    for message in published {
        let topic = Bytes::from_static(message.topic().as_bytes());
        listener.publish(&vec![topic, to_json(&message).into()]);
    }
}
