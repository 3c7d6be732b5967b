//! Drive, simulated cabinet and clients together, over the loopback interface.

mod rig;
mod runs;
