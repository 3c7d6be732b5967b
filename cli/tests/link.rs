//! `iiwasim drive`, `cabinet` and their client commands, as processes.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stderr,
    reason = "a failed test is a panic"
)]

mod commands;
mod crowd;
mod faults;
mod keys;
mod page;
mod positions;
mod real_cabinet;
mod recordings;
mod rig;
mod signals;
mod twin;
