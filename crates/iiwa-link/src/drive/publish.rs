//! What is measured goes out to subscribers, off the thread that measures.

use std::sync::mpsc::Receiver;

use bytes::Bytes;

use crate::{message::to_json, stream::Published, transport::Listener};

/// Messages that wait to be published, at most.
pub(super) const BACKLOG: usize = 4096;

/// Publishes until there is nothing more to come.
pub(super) fn publish(published: &Receiver<Published>, listener: &Listener) {
    for message in published {
        let topic: &[u8] = match message {
            Published::Joints { .. } => b"joints",
            Published::State { .. } => b"state",
        };
        listener.publish(&vec![Bytes::from_static(topic), to_json(&message).into()]);
    }
}
