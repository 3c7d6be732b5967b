//! Drive, simulated cabinet and clients together, over the loopback interface.

#![expect(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::print_stdout,
    reason = "a failed test panics, figures are printed, and counts are small"
)]

mod bad_instructions;
mod bad_requests;
mod bad_rows;
mod bounds;
mod cell_runs;
mod corrupted;
mod corrupted_motions;
mod crowds;
mod faults;
mod instructions;
mod invalid_motions;
mod invalid_requests;
mod link_check;
mod other_robots;
mod real_cabinet;
mod request_socket;
mod rig;
mod runs;
mod scripted_program;
mod streaming;
mod sunrise_program;
mod wire;
