//! `ZeroMQ` sockets (ZMTP 3.1) over TCP with bounded resources.
//!
//! The protocol, including CURVE, is that of `omq-proto`, which is sans I/O. The I/O is done here in
//! order to bound the number of connections, the memory of messages in transit and the time that a peer
//! may take:
//!
//! | resource | bound |
//! |---|---|
//! | connections with an incomplete handshake | 64, for 2 s each; a new one replaces one that has not sent anything |
//! | established connections | another 64; a new one replaces an idle one |
//! | bytes of a handshake | 4 KiB |
//! | short messages | 64 KiB; up to 8 requests per peer are accepted before their replies |
//! | long messages, up to the limit of the socket | one at a time per socket, without pauses of more than 2 s |
//! | backlog of a peer that does not read | per socket, for 5 s without progress |
//!
//! A [`Listener`] accepts connections, and a [`Dialer`] maintains one; a client that sends one request at
//! a time uses a `Wire`.

mod admission;
mod dialer;
mod listener;
mod meter;
mod probe;
mod runtime;
mod subscriptions;
mod wire;

pub use admission::PeerId;
pub use dialer::Dialer;
pub use listener::{Event, Listener, ListenerConfig, SocketKind};
pub use probe::ProbeError;
pub(crate) use probe::probe;
pub(crate) use runtime::runtime;
pub use wire::{Frames, Permit, Received, SHORT_BYTES};
pub(crate) use wire::{Incoming, Wire, WireConfig, WireError};
