//! ROS names of joints and links.

use std::{fmt, str::FromStr};

/// A ROS package for the robot, with its naming convention for joints and links.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RosStack {
    /// `iiwa_stack`: joints `iiwa_joint_1` to `iiwa_joint_7`, links `iiwa_link_0` to `iiwa_link_7`
    /// and `iiwa_link_ee`.
    #[default]
    IiwaStack,
    /// `lbr_fri_ros2_stack`: joints `lbr_A1` to `lbr_A7`, links `lbr_link_0` to `lbr_link_7` and
    /// `lbr_link_ee`.
    LbrFriRos2Stack,
}

/// Prefix of the joint and link names of one robot, so that a ROS graph can have several robots.
///
/// ```
/// use iiwa_kin::RosPrefix;
///
/// assert!("left_arm".parse::<RosPrefix>().is_ok());
/// assert!("2nd arm".parse::<RosPrefix>().is_err());
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RosPrefix(String);

/// Error: a prefix that ROS names cannot begin with, or that is too long.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "a prefix of names is 1 to {MAX_PREFIX} letters (a to z, A to Z), digits and `_`, a letter \
     first"
)]
pub struct BadRosPrefix;

/// Largest length of a prefix, in characters.
const MAX_PREFIX: usize = 50;

impl FromStr for RosPrefix {
    type Err = BadRosPrefix;

    fn from_str(text: &str) -> Result<Self, BadRosPrefix> {
        let fits = text.len() <= MAX_PREFIX
            && text.starts_with(|first: char| first.is_ascii_alphabetic())
            && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        if fits { Ok(Self(text.to_owned())) } else { Err(BadRosPrefix) }
    }
}

impl fmt::Display for RosPrefix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0)
    }
}

/// ROS names of the joints and links of one robot, in its URDF and in messages.
///
/// ```
/// use iiwa_kin::{RosNames, RosStack};
///
/// assert_eq!(RosNames::default().joints()[0], "iiwa_joint_1");
/// let left = RosNames::new(RosStack::LbrFriRos2Stack, Some("left".parse()?));
/// assert_eq!(left.joints()[6], "left_A7");
/// assert_eq!(left.links()[0], "left_link_0");
/// # Ok::<(), iiwa_kin::BadRosPrefix>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RosNames {
    stack: RosStack,
    prefix: Option<RosPrefix>,
}

impl RosNames {
    /// Names of a package's convention, with `prefix` in place of the package's prefix `iiwa` or
    /// `lbr`.
    #[must_use]
    pub fn new(stack: RosStack, prefix: Option<RosPrefix>) -> Self {
        Self { stack, prefix }
    }

    /// Joint names, from the base to the flange: the stem with the numbers 1 to 7.
    #[must_use]
    pub fn joints(&self) -> [String; 7] {
        let stem = self.joint_stem();
        std::array::from_fn(|j| format!("{stem}{}", j + 1))
    }

    /// Common stem of all joint names, such as `iiwa_joint_`.
    #[must_use]
    pub fn joint_stem(&self) -> String {
        let prefix = self.prefix();
        match self.stack {
            RosStack::IiwaStack => format!("{prefix}_joint_"),
            RosStack::LbrFriRos2Stack => format!("{prefix}_A"),
        }
    }

    /// Link names, from link 0 (the base) to link 7, then the flange.
    #[must_use]
    pub fn links(&self) -> [String; 9] {
        let prefix = self.prefix();
        std::array::from_fn(|link| match link {
            8 => format!("{prefix}_link_ee"),
            _ => format!("{prefix}_link_{link}"),
        })
    }

    /// Name of the fixed joint between link 7 and the flange.
    pub(super) fn flange_joint(&self) -> String {
        format!("{}_joint_ee", self.prefix())
    }

    fn prefix(&self) -> &str {
        match (&self.prefix, self.stack) {
            (Some(prefix), _) => &prefix.0,
            (None, RosStack::IiwaStack) => "iiwa",
            (None, RosStack::LbrFriRos2Stack) => "lbr",
        }
    }
}
