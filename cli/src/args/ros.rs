//! ROS names of joints and links.

use clap::{Args, ValueEnum};
use iiwa_kin::{RosNames, RosPrefix, RosStack};
use serde::Deserialize;

/// Names of joints and links in MCAP files and URDFs.
#[derive(Args, Clone, Debug)]
pub(crate) struct RosNaming {
    /// ROS package whose joint and link names are used
    #[arg(long, value_enum, value_name = "PACKAGE", default_value_t = RosPackage::IiwaStack,
        env = "IIWASIM_ROS_NAMES", hide_env = true)]
    ros_names: RosPackage,

    /// Prefix of joint and link names instead of `iiwa` or `lbr`, for several robots in one ROS
    /// graph: 1 to 50 letters, digits and _
    #[arg(long, value_name = "PREFIX", env = "IIWASIM_ROS_PREFIX", hide_env = true)]
    ros_prefix: Option<RosPrefix>,
}

impl RosNaming {
    pub(crate) fn names(&self) -> RosNames {
        RosNames::new(self.ros_names.into(), self.ros_prefix.clone())
    }

    /// The same with another prefix: that of one of several robots.
    #[cfg(feature = "ros2")]
    pub(crate) fn names_with(&self, prefix: RosPrefix) -> RosNames {
        RosNames::new(self.ros_names.into(), Some(prefix))
    }
}

/// A ROS package for the robot.
#[derive(Clone, Copy, Debug, Deserialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
#[value(rename_all = "snake_case")]
pub(crate) enum RosPackage {
    /// `iiwa_joint_1`, `iiwa_link_0`
    IiwaStack,
    /// `lbr_A1`, `lbr_link_0`
    LbrFriRos2Stack,
}

impl From<RosPackage> for RosStack {
    fn from(package: RosPackage) -> Self {
        match package {
            RosPackage::IiwaStack => Self::IiwaStack,
            RosPackage::LbrFriRos2Stack => Self::LbrFriRos2Stack,
        }
    }
}
