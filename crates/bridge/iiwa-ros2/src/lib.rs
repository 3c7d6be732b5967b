//! ROS 2 interface: bridged robots as nodes over DDS, and time parameterisation of external joint
//! paths.
//!
//! Without its feature `dds`, the crate contains only [`retime`], because DDS adds a hundred
//! crates.
//!
//! | name | type | content |
//! |---|---|---|
//! | `joint_states` | `sensor_msgs/msg/JointState` | every sample of the stream |
//! | `/tf` | `tf2_msgs/msg/TFMessage` | the links, 100 times per second |
//! | `robot_description` | `std_msgs/msg/String` | the URDF, also for late subscribers |
//! | `joint_trajectory_controller/follow_joint_trajectory` | `control_msgs/action/FollowJointTrajectory` | runs goals, if commands are allowed |
//! | `time_joint_path` | `iiwasim_msgs/srv/TimeJointPath` | times a path within jerk limits |
//! | `joint_path` | `trajectory_msgs/msg/JointTrajectory` | paths to be timed, as a topic |
//! | `timed_joint_path` | `trajectory_msgs/msg/JointTrajectory` | timed paths |
//!
//! Names are relative to the namespace of the robot.
//!
//! DDS is not authenticated: anyone who can reach the machine's UDP ports from 7400 on can send
//! goals, and `RustDDS` 0.15 reserves the memory that a packet requests, up to 4 GB. It binds these
//! ports to all addresses, regardless of the announced ones (see `Ros2Options::networks`).

#[cfg(feature = "dds")]
mod dds;
mod polyline;
pub mod retime;
mod rounded;
mod spacing;

#[cfg(feature = "dds")]
pub use dds::{RetimeGoals, Ros2, Ros2Error, Ros2Options, Ros2Robot, namespace_of};
