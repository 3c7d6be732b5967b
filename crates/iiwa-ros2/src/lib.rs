//! ROS 2: a robot of the bridge as a node, by DDS; times for foreign joint paths.
//!
//! Without its feature `dds`, the crate has [`retime`] alone: DDS brings a hundred crates.
//!
//! | name | type | what |
//! |---|---|---|
//! | `joint_states` | `sensor_msgs/msg/JointState` | every sample of the stream |
//! | `/tf` | `tf2_msgs/msg/TFMessage` | the links, 100 times a second |
//! | `robot_description` | `std_msgs/msg/String` | the URDF, for those who come later, too |
//! | `joint_trajectory_controller/follow_joint_trajectory` | `control_msgs/action/FollowJointTrajectory` | runs goals, if commands are allowed |
//! | `time_joint_path` | `iiwasim_msgs/srv/TimeJointPath` | times a path within limits of jerk |
//! | `joint_path` | `trajectory_msgs/msg/JointTrajectory` | the same for paths that come by a topic |
//! | `timed_joint_path` | `trajectory_msgs/msg/JointTrajectory` | the paths with their times |
//!
//! Names are relative to the namespace of the robot.
//!
//! DDS knows no keys: who reaches the machine's UDP ports from 7400 on can send goals, and `RustDDS` 0.15 reserves the memory that a
//! packet asks for, up to 4 GB. It binds them to all addresses, whatever is announced (see `Ros2Options::networks`).

#[cfg(feature = "dds")]
mod action;
#[cfg(feature = "dds")]
mod error;
#[cfg(feature = "dds")]
mod execution;
#[cfg(feature = "dds")]
mod goal;
#[cfg(feature = "dds")]
mod goals;
#[cfg(feature = "dds")]
mod latest;
#[cfg(feature = "dds")]
mod messages;
#[cfg(feature = "dds")]
mod names;
#[cfg(feature = "dds")]
mod nodes;
#[cfg(feature = "dds")]
mod options;
#[cfg(feature = "dds")]
mod path_joints;
mod polyline;
#[cfg(feature = "dds")]
mod publisher;
#[cfg(feature = "dds")]
mod qos;
#[cfg(feature = "dds")]
mod received;
pub mod retime;
#[cfg(feature = "dds")]
mod retiming;
#[cfg(feature = "dds")]
mod robot;
mod rounded;
mod spacing;
#[cfg(feature = "dds")]
mod timing_service;

#[cfg(feature = "dds")]
pub use error::Ros2Error;
#[cfg(feature = "dds")]
pub use names::namespace_of;
#[cfg(feature = "dds")]
pub use nodes::Ros2;
#[cfg(feature = "dds")]
pub use options::{Ros2Options, Ros2Robot};
#[cfg(feature = "dds")]
pub use retiming::RetimeGoals;
