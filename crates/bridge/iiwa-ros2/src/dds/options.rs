//! ROS settings.

use std::net::{IpAddr, Ipv4Addr};

use iiwa_bridge::BridgedRobot;
use iiwa_kin::{Robot, RosNames};

use super::retiming::RetimeGoals;

/// ROS settings.
#[derive(Clone, Debug)]
pub struct Ros2Options {
    /// DDS domain, like `ROS_DOMAIN_ID`.
    pub domain: u16,
    /// Addresses of this machine that are announced and used for multicast. Loopback only by
    /// default.
    pub networks: Vec<IpAddr>,
    /// The robots.
    pub robots: Vec<Ros2Robot>,
    /// `true` if goals are accepted.
    pub allow_commands: bool,
    /// Maximum rate of `/tf` messages, in Hz.
    pub tf_rate_hz: f64,
    /// Default of the node parameter `retime`: condition for the retiming of goals on their path.
    pub retime: RetimeGoals,
}

impl Default for Ros2Options {
    fn default() -> Self {
        Self {
            domain: 0,
            networks: vec![IpAddr::V4(Ipv4Addr::LOCALHOST)],
            robots: Vec::new(),
            allow_commands: false,
            tf_rate_hz: 100.0,
            retime: RetimeGoals::default(),
        }
    }
}

/// A robot of the bridge and its ROS settings.
#[derive(Clone, Debug)]
pub struct Ros2Robot {
    /// The bridged robot.
    pub bridged: BridgedRobot,
    /// Robot model.
    pub robot: Robot,
    /// Joint and link names.
    pub names: RosNames,
    /// Namespace of its topics; empty for the root namespace.
    pub namespace: String,
}
