//! `ZeroMQ` sockets (ZMTP 3.1) over TCP with bounded resources.
//!
//! The crate `omq-proto`, which is sans I/O, implements the protocol, including CURVE. The I/O is
//! implemented here to bound the number of connections, the memory of messages in transit and the
//! time that a peer may take:
//!
//! | resource | bound |
//! |---|---|
//! | connections with an incomplete handshake | 64, of which 48 per address, for 2 s each |
//! | established connections | another 64, of which 48 per key or address |
//! | open files | fewer connections if the process may open fewer than 576 |
//! | bytes of a handshake | 4 KiB |
//! | short messages | 64 KiB; up to 8 requests per peer are accepted before their replies |
//! | long messages, up to the limit of the socket | one at a time per socket, without pauses of more than 2 s, at 1 MiB/s at least |
//! | backlog of a peer that does not read | per socket, for 5 s without progress |
//!
//! A new connection is always accepted. The module `places` selects the connection to be evicted.
//!
//! A [`Listener`] accepts connections, and a [`Dialer`] maintains one; a client that sends one
//! request at a time uses a `WireConnection`.

mod dialer;
mod listener;
mod meter;
mod open_files;
mod places;
mod probe;
mod runtime;
mod subscriptions;
mod wire;

pub use dialer::Dialer;
pub use listener::{Event, Listener, ListenerConfig, SocketKind};
pub use places::PeerId;
pub use probe::ProbeError;
pub(crate) use probe::probe;
pub(crate) use runtime::runtime;
pub(crate) use wire::{ConnectionEnd, WireConfig, WireConnection, WireInput};
pub use wire::{Frames, Permit, ReceivedMessage, SHORT_BYTES};
