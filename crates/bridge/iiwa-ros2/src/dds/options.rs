//! How robots appear in ROS.

use std::net::{IpAddr, Ipv4Addr};

use iiwa_bridge::BridgedRobot;
use iiwa_kin::{Robot, RosNames};

use super::retiming::RetimeGoals;

/// How robots appear in ROS.
#[derive(Clone, Debug)]
pub struct Ros2Options {
    /// The DDS domain, as `ROS_DOMAIN_ID`.
    pub domain: u16,
    /// The addresses of this machine that are announced, and used for multicast. Loopback alone by default.
    pub networks: Vec<IpAddr>,
    /// The robots.
    pub robots: Vec<Ros2Robot>,
    /// Whether goals are taken.
    pub allow_commands: bool,
    /// Most messages a second on `/tf`.
    pub tf_rate_hz: f64,
    /// When goals get new times on their path, unless the node's parameter `retime` says something else.
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

/// A robot of the bridge, as it appears in ROS.
#[derive(Clone, Debug)]
pub struct Ros2Robot {
    /// Its drive.
    pub bridged: BridgedRobot,
    /// Its model.
    pub robot: Robot,
    /// Names of joints and links.
    pub names: RosNames,
    /// Of its topics; empty for none.
    pub namespace: String,
}
