//! The FRI from outside: bytes of any kind, both sides against each other over bad networks, and
//! an independent codec and client.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stderr,
    reason = "a failed test is a panic, and one that is left out says so"
)]

mod bytes;
mod messages;
mod network;
mod peer;
mod session;
