//! End-to-end tests of the workspace: planned programs, random programs, and the architecture
//! rules.

mod architecture;
mod cartesian;
mod hard_geometry;
mod hostile;
mod limits;
mod long_programs;
mod metamorphic;
mod ports;
mod program_keys;
mod reference;
mod replanning;
mod straight_jerk;
mod tcp_programs;
mod tcp_reach;
mod torque_limits;
mod torques;
