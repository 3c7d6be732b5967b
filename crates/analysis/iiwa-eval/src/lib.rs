//! Comparison of plans with recordings of the KUKA LBR iiwa and with other plans, and
//! identification of its limits from recordings.
//!
//! Angles are in rad, lengths in m, times in s. The crate has no network access and no file
//! formats: its input are [`JointLog`](iiwa_log::JointLog)s, which `iiwa-log` reads.
//!
//! Source: C. Larsen, *Including a Collaborative Robot in Digital Twin Manufacturing Systems*,
//! Chalmers 2019, chapters 4 and 5 and the appendices, cited as "Larsen 2019".

mod compare;
mod estimate;
mod exerted;
#[cfg(feature = "experiments")]
pub mod experiment;
pub mod identify;
mod least_squares;
#[cfg(feature = "experiments")]
mod load_planning;
mod local_cubic;
mod noise;
mod plan_difference;
mod quantile;
#[cfg(feature = "experiments")]
mod virtual_robot;

pub use compare::{
    CompareError, Comparison, CycleTime, Deviation, Location, MotionDeviation, MotionTime,
    PlannedTrajectory, StopTime, TorqueDifference, TracePoint, compare,
};
pub use estimate::Estimate;
#[cfg(feature = "experiments")]
pub use load_planning::LoadPlanning;
pub use local_cubic::local_cubic;
pub use plan_difference::{
    GroupDifference, MotionDifference, PathChange, PlanDifference, PlanVersion,
};
#[cfg(feature = "experiments")]
pub use virtual_robot::{VirtualRobot, VirtualRobotError};
