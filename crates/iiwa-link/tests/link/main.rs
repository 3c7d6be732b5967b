//! Drive, simulated cabinet and clients together, over the loopback interface.

mod faults;
mod peer;
mod rig;
mod runs;
