//! ROS nodes: publications, and the action and service servers.

mod action;
mod error;
mod execution;
mod goal;
mod goals;
mod latest;
mod messages;
mod names;
mod nodes;
mod options;
mod path_joints;
mod publisher;
mod qos;
mod received;
mod retiming;
mod robot;
mod timing_service;

pub use error::Ros2Error;
pub use names::namespace_of;
pub use nodes::Ros2;
pub use options::{Ros2Options, Ros2Robot};
pub use retiming::RetimeGoals;
