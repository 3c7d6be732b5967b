//! ROS 2 of `iiwasim bridge`.

use std::net::IpAddr;

use clap::{Args, ValueEnum};

use super::RosNaming;

/// ROS 2.
#[derive(Args, Debug)]
#[command(next_help_heading = "ROS 2")]
pub(crate) struct Ros2 {
    /// Run a ROS 2 node per robot: joint states, transforms, description; with --allow-commands,
    /// `FollowJointTrajectory` goals. Opens UDP ports on all addresses, without keys
    #[arg(long = "ros2")]
    pub(crate) wanted: bool,

    /// Namespace of the topics; with several robots, a prefix of their names [default: none; with
    /// several robots, their names]
    #[arg(long = "ros2-namespace", value_name = "NAME", default_value = "", requires = "wanted")]
    pub(crate) namespace: String,

    /// DDS domain, which determines the ports: 0 to 101
    #[arg(
        long = "ros2-domain",
        value_name = "N",
        default_value_t = 0,
        env = "ROS_DOMAIN_ID",
        hide_env = true
    )]
    pub(crate) domain: u16,

    /// Address of this machine to announce to other machines; may be given more than once [default:
    /// 127.0.0.1]
    #[arg(long = "ros2-network", value_name = "IP", requires = "wanted")]
    pub(crate) networks: Vec<IpAddr>,

    /// Time parameterisation of goal paths: ROS planners do not know jerk limits
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

/// Time parameterisation of goals.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum RetimeGoals {
    /// Only if their own times violate limits
    Needed,
    /// Always
    Always,
    /// Never: goals that violate limits are refused
    Never,
}
