//! Sockets of `libzmq`.

use std::{io, time::Duration};

use zmq::{Context, DONTWAIT, POLLIN, PollItem, Socket};

use super::{SEND_TIMEOUT, SocketType};

/// Socket of `libzmq`.
pub struct LibzmqSocket {
    socket: Socket,
}

impl LibzmqSocket {
    /// Creates a socket that connects to an address such as `tcp://127.0.0.1:30001`, in the
    /// background.
    ///
    /// # Errors
    ///
    /// An error if the address is invalid, or resources are exhausted.
    pub fn connect(kind: SocketType, address: &str) -> io::Result<Self> {
        let socket = new(kind)?;
        socket.connect(address)?;
        Ok(Self { socket })
    }

    /// Creates a socket that listens at an address such as `tcp://127.0.0.1:30001`.
    ///
    /// # Errors
    ///
    /// An error if the address is invalid or in use, or resources are exhausted.
    pub fn bind(kind: SocketType, address: &str) -> io::Result<Self> {
        let socket = new(kind)?;
        socket.bind(address)?;
        Ok(Self { socket })
    }

    /// Subscribes to topics with a prefix.
    ///
    /// # Errors
    ///
    /// An error if the socket is of another type.
    pub fn subscribe(&self, topic: &[u8]) -> io::Result<()> {
        Ok(self.socket.set_subscribe(topic)?)
    }

    /// Sends a message, once there is room for it.
    ///
    /// # Errors
    ///
    /// An error without room within 10 s.
    pub fn send(&self, frames: &[impl AsRef<[u8]>]) -> io::Result<()> {
        Ok(self.socket.send_multipart(frames.iter().map(AsRef::as_ref), 0)?)
    }

    /// Sends a message if there is room for it; returns true if sent.
    pub fn try_send(&self, frames: &[impl AsRef<[u8]>]) -> bool {
        self.socket.send_multipart(frames.iter().map(AsRef::as_ref), DONTWAIT).is_ok()
    }

    /// Returns the next message, if it arrives within `timeout`.
    #[must_use]
    pub fn receive(&self, timeout: Duration) -> Option<Vec<Vec<u8>>> {
        receive_any(&[self], timeout).map(|(_, frames)| frames)
    }
}

/// Returns the next message of several sockets with the index of its socket, if it arrives within
/// `timeout`.
#[must_use]
pub fn receive_any(sockets: &[&LibzmqSocket], timeout: Duration) -> Option<(usize, Vec<Vec<u8>>)> {
    let mut items: Vec<_> =
        sockets.iter().map(|socket| socket.socket.as_poll_item(POLLIN)).collect();
    // Rounded up, so that a short remaining time-out does not cause a busy loop.
    let timeout_ms = i64::try_from(timeout.as_micros().div_ceil(1000)).unwrap_or(i64::MAX);
    zmq::poll(&mut items, timeout_ms).ok()?;
    let place = items.iter().position(PollItem::is_readable)?;
    Some((place, sockets[place].socket.recv_multipart(DONTWAIT).ok()?))
}

fn new(kind: SocketType) -> io::Result<Socket> {
    let socket = Context::new().socket(match kind {
        SocketType::Req => zmq::REQ,
        SocketType::Dealer => zmq::DEALER,
        SocketType::Router => zmq::ROUTER,
        SocketType::Sub => zmq::SUB,
    })?;
    socket.set_linger(0)?;
    socket.set_sndtimeo(i32::try_from(SEND_TIMEOUT.as_millis()).unwrap_or(i32::MAX))?;
    if kind == SocketType::Sub {
        socket.set_rcvhwm(1)?;
        socket.set_rcvbuf(4096)?;
    }
    Ok(socket)
}
