//! A client's socket that knows whether it was let in.

use std::{
    cell::Cell,
    ops::Deref,
    sync::atomic::{AtomicU64, Ordering},
};

use super::SecurityError;

/// Events of `zmq_socket_monitor`.
const DISCONNECTED: u16 = 0x0200;
const NO_DETAIL: u16 = 0x0800;
const SUCCEEDED: u16 = 0x1000;
const PROTOCOL: u16 = 0x2000;
const AUTH: u16 = 0x4000;

/// What goes with [`PROTOCOL`] if one side has keys and the other one does not.
const MECHANISM_MISMATCH: u32 = 0x1100_0002;

/// What became of a handshake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Handshake {
    /// The server has let the client in.
    Done,
    /// The server knows that it does not want this client: its key is not on the list.
    NotAllowed,
    /// One side has keys and the other one does not. If the server is the first to notice, this is
    /// [`HungUp`](Self::HungUp) to the client.
    KeysOnOneSide,
    /// The server hung up without a word, and libzmq tries again. So it does if the client has the
    /// wrong server key or keys that do not belong together, but also if it just ends.
    HungUp,
    /// The other side does not speak as it should.
    Protocol,
    /// The connection was lost, after the server had let the client in.
    Lost,
}

impl Handshake {
    /// Whether another key, or one at all, may help.
    #[must_use]
    pub fn is_refusal(self) -> bool {
        matches!(self, Self::NotAllowed | Self::KeysOnOneSide | Self::HungUp)
    }

    /// What it means for the client, in words.
    #[must_use]
    pub fn what(self) -> &'static str {
        match self {
            Self::Done => "the connection is there",
            Self::NotAllowed => "its key is not on the drive's list",
            Self::KeysOnOneSide => "one side has keys and the other one has none",
            Self::HungUp => "the drive hung up; is the drive's public key the right one?",
            Self::Protocol => "the other side does not speak the protocol",
            Self::Lost => "the connection was lost",
        }
    }
}

/// A client's socket whose handshakes can be asked about. Without that, a client that is not let in
/// sees nothing but silence.
///
/// After [`Handshake::NotAllowed`], [`Handshake::KeysOnOneSide`] and [`Handshake::Protocol`] libzmq
/// does not try again: to do so, the client makes a new socket.
pub struct WatchedSocket {
    socket: zmq::Socket,
    events: zmq::Socket,
    let_in: Cell<bool>,
}

impl WatchedSocket {
    /// A socket that is watched from the start.
    ///
    /// # Errors
    /// libzmq refuses to make one.
    pub fn new(context: &zmq::Context, kind: zmq::SocketType) -> Result<Self, SecurityError> {
        let refuse = || SecurityError::zmq("make a socket");
        let socket = context.socket(kind).map_err(refuse())?;
        let events = context.socket(zmq::PAIR).map_err(refuse())?;
        // libzmq's own thread would wait for a reader once so many events are there.
        events.set_rcvhwm(0).map_err(refuse())?;
        let address = fresh_address();
        socket
            .monitor(&address, i32::from(DISCONNECTED | NO_DETAIL | SUCCEEDED | PROTOCOL | AUTH))
            .map_err(refuse())?;
        let watched = Self { socket, events, let_in: Cell::new(false) };
        watched.events.connect(&address).map_err(refuse())?;
        Ok(watched)
    }

    /// What has become of handshakes since the last time, the latest one.
    ///
    /// # Errors
    /// libzmq refuses to tell.
    pub fn handshake(&self) -> Result<Option<Handshake>, SecurityError> {
        let mut latest = None;
        loop {
            match self.events.recv_multipart(zmq::DONTWAIT) {
                Ok(frames) => {
                    let event = frames.first().and_then(|event| read(event));
                    // A refused connection ends, too: that is no news.
                    latest = event.filter(|event| self.is_news(*event)).or(latest);
                }
                Err(zmq::Error::EAGAIN) => return Ok(latest),
                Err(zmq::Error::EINTR) => {}
                Err(source) => {
                    return Err(SecurityError::Zmq { what: "watch a socket".to_owned(), source });
                }
            }
        }
    }

    fn is_news(&self, event: Handshake) -> bool {
        let was_let_in = self.let_in.replace(event == Handshake::Done);
        event != Handshake::Lost || was_let_in
    }
}

impl Deref for WatchedSocket {
    type Target = zmq::Socket;

    fn deref(&self) -> &zmq::Socket {
        &self.socket
    }
}

impl Drop for WatchedSocket {
    fn drop(&mut self) {
        // Nobody reads the events from now on, and libzmq's own thread would wait for somebody: so
        // there must not be any more. Watching for none is the way to stop watching.
        let _ = self.socket.monitor(&fresh_address(), 0);
    }
}

/// An event: two bytes that say which, four with its value.
fn read(event: &[u8]) -> Option<Handshake> {
    let &[e0, e1, v0, v1, v2, v3] = event else { return None };
    let value = u32::from_ne_bytes([v0, v1, v2, v3]);
    match u16::from_ne_bytes([e0, e1]) {
        SUCCEEDED => Some(Handshake::Done),
        AUTH => Some(Handshake::NotAllowed),
        PROTOCOL if value == MECHANISM_MISMATCH => Some(Handshake::KeysOnOneSide),
        PROTOCOL => Some(Handshake::Protocol),
        NO_DETAIL => Some(Handshake::HungUp),
        DISCONNECTED => Some(Handshake::Lost),
        _ => None,
    }
}

/// An address for events that no other socket has.
fn fresh_address() -> String {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    format!("inproc://iiwasim.events.{}", COUNT.fetch_add(1, Ordering::Relaxed))
}
