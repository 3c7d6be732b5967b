//! Kinematics and dynamics of the KUKA LBR iiwa: robot models, forward and inverse kinematics,
//! Jacobian, joint torques, URDF import and export. The crate does not deal with trajectories.
//!
//! ```
//! use iiwa_kin::Robot;
//!
//! let robot = Robot::lbr_iiwa_7_r800();
//! let stretched_out = robot.flange_pose(&[0.0; 7]);
//! assert!((stretched_out.position_m[2] - 1.292).abs() < 1e-12);
//! ```
//!
//! Units are SI and radians, unless a name states another unit. Joint vectors are arrays of seven
//! numbers; joint A1, the one at the base, has index 0. Poses are given in the base frame,
//! `iiwa_link_0`: z points up, the origin is in the centre of the mounting face.
//!
//! Features, both on by default: `profile` for robot profiles in JSON, `urdf` for ROS robot
//! descriptions. Without them, the crate needs neither a JSON nor an XML library.
//!
//! Source: C. Larsen, *Including a Collaborative Robot in Digital Twin Manufacturing Systems*,
//! Chalmers 2019, chapter 2.3, cited as "Larsen 2019".

mod batch;
mod dh;
mod dynamics;
mod dynamics_batch;
mod forward;
mod friction;
pub mod hermite;
mod inertials;
mod inverse;
mod inverse_point;
mod joint;
mod limits;
mod links;
mod load;
mod mount;
mod moving_pose;
mod newton_euler;
mod number;
mod pose;
#[cfg(feature = "profile")]
mod profile;
mod ramp_law;
mod reachable;
mod redundancy;
mod rigid_body;
mod robot;
pub mod rotation;
mod shapes;
mod singularity;
mod spline_speed;
mod taylor;
mod tool_rates;
mod trig;
mod unreachable;
#[cfg(feature = "urdf")]
mod urdf;
pub mod vector;

pub use dh::DhRow;
pub use dynamics::{Dynamics, PathTorques};
pub use friction::Friction;
pub use inverse_point::FlangePoint;
pub use joint::Joint;
pub use limits::{Limits, OutsideRange};
pub use links::part_name;
pub use load::{ImpossibleLoad, Load};
pub use mount::Mount;
pub use moving_pose::MovingPose;
pub use number::Number;
pub use pose::Pose;
#[cfg(feature = "profile")]
pub use profile::ProfileError;
pub use ramp_law::{RampEnd, RampLaw, RampLimits};
pub use redundancy::{Redundancy, Status, Turn};
pub use rigid_body::RigidBody;
pub use robot::{Assumption, BadLength, Lengths, Robot};
pub use shapes::{Along, Shape, Solid};
pub use singularity::{SingularPart, Singularity};
pub use spline_speed::SplineSpeed;
pub use taylor::Taylor;
pub use tool_rates::ToolRates;
pub use unreachable::Unreachable;
#[cfg(feature = "urdf")]
pub use urdf::{
    BadRosPrefix, LimitDifference, Listed, RosNames, RosPrefix, RosStack, UrdfError, UrdfLink,
    UrdfMesh, UrdfReport,
};

/// A quantity of the seven joints, such as positions; in rad unless the name says otherwise.
pub type Joints = [f64; 7];
