//! Requests to the drive, each over a separate connection.

use std::{io, net::SocketAddr, time::Duration};

use serde_json::Value;

use iiwasim_tests::zmtp::{HANDSHAKE_TIMEOUT, Peer};

/// Pending request.
pub(super) struct PendingRequest {
    peer: Peer,
}

impl PendingRequest {
    /// Sends a request; the system has it when this returns.
    pub(super) fn send(address: SocketAddr, request: &str) -> io::Result<Self> {
        let mut peer = Peer::connect(address, "REQ", HANDSHAKE_TIMEOUT)?;
        peer.send(&[b"", request.as_bytes()])?;
        Ok(Self { peer })
    }

    /// Waits for the reply.
    pub(super) fn reply(mut self, timeout: Duration) -> io::Result<Value> {
        let frames = self.peer.receive(timeout)?;
        let body = frames.last().map(Vec::as_slice).unwrap_or_default();
        serde_json::from_slice(body).map_err(io::Error::other)
    }
}

/// Sends a request and waits for the reply.
pub(super) fn request(address: SocketAddr, body: &str, timeout: Duration) -> io::Result<Value> {
    PendingRequest::send(address, body)?.reply(timeout)
}

/// Returns true if a reply is `ok`.
pub(super) fn is_ok(reply: &Value) -> bool {
    reply["ok"].as_bool() == Some(true)
}
