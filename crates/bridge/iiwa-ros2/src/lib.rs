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
mod dds;
mod polyline;
pub mod retime;
mod rounded;
mod spacing;

#[cfg(feature = "dds")]
pub use dds::{RetimeGoals, Ros2, Ros2Error, Ros2Options, Ros2Robot, namespace_of};
