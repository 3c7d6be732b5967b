//! Time parameterisation of paths of the KUKA LBR iiwa: the fastest motion along a path within the
//! limits, or a motion as recorded under Sunrise ([`Timing`]). The crate has no file formats.
//!
//! ```
//! use iiwa_kin::Robot;
//! use iiwa_path::JointPath;
//! use iiwa_program::Program;
//! use iiwa_traj::{Timing, Trajectory};
//!
//! # let text = r#"{ "version": 1, "start": { "joints_deg": [-20, 0, 0, 0, 0, 0, 0] },
//! #     "motions": [{ "type": "ptp", "joints_deg": [20, 0, 0, 0, 0, 0, 0] }] }"#;
//! let program = Program::from_json(text)?;
//! let path = JointPath::new(&program, &Robot::lbr_iiwa_7_r800())?;
//! // By default as recorded under Sunrise; 0.798 s with the standstill after the stop, 0.05 s.
//! let trajectory = Trajectory::plan(&path, Timing::default())?;
//! assert!((trajectory.cycle_time_s() - 0.798).abs() < 1e-3);
//!
//! // The fastest motion under the limits of joint A1: 98 deg/s, 490 deg/s^2, 10384.86 deg/s^3.
//! let trajectory = Trajectory::plan(&path, Timing::jerk_limited())?;
//! let expected = 40.0 / 98.0 + 98.0 / 490.0 + 490.0 / 10384.86 + 0.05;
//! assert!((trajectory.cycle_time_s() - expected).abs() < 1e-12);
//! let state = trajectory.at(0.5 * trajectory.motion_time_s());
//! assert!(state.q[0].abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Source: C. Larsen, *Including a Collaborative Robot in Digital Twin Manufacturing Systems*,
//! Chalmers 2019, chapter 2.4, cited as "Larsen 2019".

#![expect(
    clippy::inline_always,
    reason = "kernels must be inlined into the function that enables vector instructions"
)]

mod batch;
mod figures;
mod grid;
mod interval;
mod jerk;
mod known_in_time;
mod limit;
mod limit_usage;
mod line_limits;
mod overlapping_waits;
mod path_limit;
mod path_limits;
mod phases;
mod planned_ahead;
mod planner;
pub mod playback;
mod replanner;
mod sampled_usage;
mod section;
mod section_planner;
mod section_sweep;
mod spline_speed;
mod state;
mod sunrise;
mod supervised_speed;
mod sweep;
mod timing;
mod torque_limit;
mod torques;
mod trajectory;

pub use iiwa_program::{LimitKind, MotionType};
pub use iiwa_solver::{PathRow, RowLimit};

pub use batch::{PlanError, plan_all};
pub use figures::{BlendFigures, CartesianFigures, MotionFigures, NearestSingularity, Totals};
pub use interval::Node;
pub use limit::{Limit, LimitShare, Limited};
pub use path_limit::PathLimit;
pub use planner::Planner;
pub use replanner::Replanner;
pub use section::{LateBlend, Piece, PieceKind, Section};
pub use state::State;
pub use sunrise::{RampPhase, RampStart};
pub use timing::{JerkOptions, SweepOptions, Timing, TimingError};
pub use torques::{JointTorques, MotionDynamics, MotionTorques, TorqueFigures};
pub use trajectory::Trajectory;
