//! The FRI from outside: bytes of any kind, both sides against each other over bad networks, and
//! an independent codec and client.

#![expect(clippy::unwrap_used, clippy::panic, reason = "helpers of tests")]

mod bytes;
mod messages;
mod network;
mod peer;
mod session;
