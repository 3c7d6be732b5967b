//! What the end-to-end tests share: the reference programs, random programs, an eye for limits, free
//! ports, bare peers of ZMTP, the conformance suite of robot programs, that in Java as a process, and the attacks from outside.

#[cfg(unix)]
pub mod attack;
pub mod bars;
mod bernstein;
pub mod calm;
pub mod cartesian_cases;
pub mod conformance;
pub mod differences;
pub mod extremes;
pub mod families;
mod intervals;
mod jumps;
pub mod loaded_programs;
pub mod means;
pub mod ports;
pub mod program_process;
pub mod random;
pub mod reference;
pub mod starts;
pub mod tcp_limits;
pub mod tcp_programs;
pub mod torque_reference;
pub mod verdict;
pub mod zmtp;

use std::path::PathBuf;

/// A file below `fixtures/`.
#[must_use]
pub fn fixture(name: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../fixtures")).join(name)
}
