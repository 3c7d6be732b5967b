//! Names that most programs need: `use iiwa::prelude::*;`.

pub use iiwa_kin::{Joints, Pose, Robot};
#[cfg(feature = "plan")]
pub use iiwa_path::{JointPath, PathOptions};
#[cfg(feature = "plan")]
pub use iiwa_plan::{PlanRequest, ProgramSource};
#[cfg(feature = "plan")]
pub use iiwa_program::{Blend, Motion, MotionIndex, Program, Ptp, Sources, Start, Workcell};
#[cfg(feature = "scene")]
pub use iiwa_scene::{ArmInScene, Scene};
#[cfg(feature = "plan")]
pub use iiwa_traj::{JerkOptions, Replanner, Timing, Trajectory, plan_all};
