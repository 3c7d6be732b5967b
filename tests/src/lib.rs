//! Common parts of the end-to-end tests: reference programs, random programs, limit checks, free
//! ports, ZeroMQ sockets and bare ZMTP peers, the conformance suite of robot programs, and the Java
//! robot program as a process.

mod bernstein;
pub mod cartesian_cases;
pub mod child_processes;
pub mod conformance;
pub mod differences;
pub mod extremes;
pub mod families;
mod intervals;
mod jumps;
pub mod loaded_programs;
pub mod mean_limits;
pub mod plan_check;
pub mod ports;
pub mod program_process;
pub mod random;
pub mod realtime_guard;
pub mod reference;
pub mod socket;
pub mod tcp_limits;
pub mod tcp_programs;
pub mod tolerances;
pub mod torque_reference;
pub mod zmtp;

/// End-to-end tests, in one executable with the unit tests of this crate.
#[cfg(test)]
#[path = "../tests/main.rs"]
mod tests;
#[cfg(test)]
extern crate self as iiwasim_tests;

use std::path::PathBuf;

/// Returns the path of a file below `fixtures/`.
#[must_use]
pub fn fixture(name: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../fixtures")).join(name)
}
