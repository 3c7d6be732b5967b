//! Drive, simulated cabinet and clients together, over the loopback interface.

mod faults;
mod rig;
mod runs;
mod streaming;
