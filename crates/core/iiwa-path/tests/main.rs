//! Paths of programs: geometry, TCP paths, blends, updates, and invalid input.

mod any_program;
mod bad_input;
mod cartesian;
mod geometry;
mod ori_joint;
mod program;
mod spline;
mod tcps;
mod turns;
mod update;
