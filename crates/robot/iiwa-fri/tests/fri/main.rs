//! Black-box FRI tests: arbitrary bytes, both sides over faulty networks, and an independent codec
//! and client.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stderr,
    reason = "a failed test panics, and a skipped one is reported"
)]

mod bytes;
mod messages;
mod network;
mod peer;
mod session;
