//! Drive, simulated cabinet and clients together, over the loopback interface.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a failed test is a panic, and says what it has measured"
)]

mod faults;
mod rig;
mod runs;
mod streaming;
