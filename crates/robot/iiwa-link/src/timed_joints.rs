//! Client trajectories: joint positions with time stamps.

mod check;
mod differences;
mod interpolation;
mod points;

pub use check::{MAX_STEP_S, START_TOLERANCE_RAD};
pub use differences::MARGINS;
pub use points::{MAX_POINTS, TimedJoints};
