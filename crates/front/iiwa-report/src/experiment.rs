//! Experiments: those of the thesis repeated, one on TCP paths, and one on loads; their programs,
//! and reports on their recordings.

mod bench;
mod blends;
mod chapter;
mod cycle_time;
mod error;
mod evaluation;
mod kappa_plots;
mod kind;
mod limits;
mod load;
mod other_robot;
mod plot;
mod preface;
mod settle;
mod tcp_blends;
mod virtual_arm;
mod zone_velocity;

pub use bench::{Bench, TrialRun};
pub use chapter::{Chapter, wrapped};
pub use error::ExperimentError;
pub use kind::ExperimentKind;
pub use other_robot::other_robot;
pub use preface::{motion_warning, preface};
pub use virtual_arm::VirtualArm;
