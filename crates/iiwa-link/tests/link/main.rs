//! Drive, simulated cabinet and clients together, over the loopback interface.

#![expect(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a failed test is a panic, and one that is left out says so"
)]

mod bad_input;
mod faults;
mod peer;
mod rig;
mod runs;
mod streaming;
