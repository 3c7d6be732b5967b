//! Drive, simulated cabinet and clients together, over the loopback interface.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a failed test is a panic, one that is left out says so, and counts are small"
)]

mod bad_input;
mod bounds;
mod faults;
mod peer;
mod rig;
mod runs;
mod streaming;
mod wire;
