//! Requests to the drive, each over a connection of its own.

use std::{io, net::SocketAddr, time::Duration};

use serde_json::Value;

use super::zmtp::Peer;

/// A request that is answered or not.
pub(super) struct Asked {
    peer: Peer,
}

impl Asked {
    /// Sends a request; it has left this process when this returns.
    pub(super) fn send(at: SocketAddr, request: &str) -> io::Result<Self> {
        let mut peer = Peer::connect(at, "REQ")?;
        peer.send(&[b"", request.as_bytes()])?;
        Ok(Self { peer })
    }

    /// The answer.
    pub(super) fn answer(mut self, patience: Duration) -> io::Result<Value> {
        let frames = self.peer.receive(patience)?;
        let body = frames.last().map(Vec::as_slice).unwrap_or_default();
        serde_json::from_slice(body).map_err(io::Error::other)
    }
}

/// Sends a request and waits for the answer.
pub(super) fn ask(at: SocketAddr, request: &str, patience: Duration) -> io::Result<Value> {
    Asked::send(at, request)?.answer(patience)
}

/// Whether an answer says that it was done.
pub(super) fn is_ok(answer: &Value) -> bool {
    answer["ok"].as_bool() == Some(true)
}
