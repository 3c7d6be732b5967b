//! Drive, simulated cabinet and clients together, over the loopback interface.

mod bad_input;
mod faults;
mod peer;
mod rig;
mod runs;
mod streaming;
