//! Sockets that speak the protocol of `ZeroMQ` (ZMTP 3.1) over TCP, with bounds on all that others can
//! make them hold.
//!
//! The protocol, CURVE included, is that of `omq-proto`, which does no I/O. The I/O is done here, because
//! no message queue that was at hand bounds the connections that are accepted, the memory of messages on
//! their way, and the time that a peer may take for either:
//!
//! | what | bound |
//! |---|---|
//! | connections whose handshake is not complete | 64, for 2 s each; a newcomer takes the place of one that has sent nothing |
//! | connections in all | 64 more; a newcomer takes the place of one that waits for nothing |
//! | bytes of a handshake | 4 KiB |
//! | short messages | 64 KiB; up to 8 of a peer are handed over before their answers |
//! | long messages, up to the socket's limit | one at a time a socket; it has to keep coming |
//! | what waits for a peer that does not read | the socket's backlog, for 5 s without progress |
//!
//! A [`Listener`] accepts connections, a [`Dialer`] keeps one up; a client that asks and waits uses a
//! [`Wire`] by itself.

use std::io;

use tokio::runtime::{Builder, Runtime};

mod admission;
mod dialer;
mod listener;
mod meter;
mod subscriptions;
mod wire;

pub use admission::PeerId;
pub use dialer::Dialer;
pub use listener::{Event, Kind, Listener, ListenerConfig};
pub use wire::{Frames, Permit, Received, SHORT_BYTES};
pub(crate) use wire::{Incoming, Wire, WireConfig, WireError};

/// What drives the sockets of a thread.
pub(crate) fn runtime() -> io::Result<Runtime> {
    Builder::new_current_thread().enable_io().enable_time().build()
}
