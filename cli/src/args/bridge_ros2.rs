//! ROS 2 of `iiwasim bridge`.

use std::net::IpAddr;

use clap::{Args, ValueEnum};

use super::RosNaming;

/// ROS 2.
#[derive(Args, Debug)]
#[command(next_help_heading = "ROS 2")]
pub(crate) struct Ros2 {
    /// Be a node of ROS 2 for each robot: joint states, transforms, description; with --allow-commands, goals of
    /// `FollowJointTrajectory`. Opens UDP ports on all addresses, without keys
    #[arg(long = "ros2")]
    pub(crate) wanted: bool,

    /// Namespace of the robot's topics; that of several, before their names [default: none, and the names of several]
    #[arg(long = "ros2-namespace", value_name = "NAME", default_value = "", requires = "wanted")]
    pub(crate) namespace: String,

    /// DDS domain, which the ports follow from: 0 to 101
    #[arg(
        long = "ros2-domain",
        value_name = "N",
        default_value_t = 0,
        env = "ROS_DOMAIN_ID",
        hide_env = true
    )]
    pub(crate) domain: u16,

    /// Address of this machine that is announced to other machines; may be given more than once [default: 127.0.0.1]
    #[arg(long = "ros2-network", value_name = "IP", requires = "wanted")]
    pub(crate) networks: Vec<IpAddr>,

    /// When goals get new times on their path: planners of ROS know no limits of jerk
    #[arg(
        long = "ros2-retime",
        value_enum,
        value_name = "WHEN",
        default_value_t = RetimeGoals::Needed,
        requires = "wanted"
    )]
    pub(crate) retime: RetimeGoals,

    #[command(flatten)]
    pub(crate) naming: RosNaming,
}

/// When goals get new times.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum RetimeGoals {
    /// If their own break limits
    Needed,
    /// In any case
    Always,
    /// Never: what breaks limits is refused
    Never,
}
