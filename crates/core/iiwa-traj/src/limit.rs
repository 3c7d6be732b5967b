//! The limits that a trajectory keeps.

use std::fmt;

use iiwa_kin::Joint;
use iiwa_program::LimitKind;

/// A limit of a joint or of the TCP.
///
/// ```
/// use iiwa_kin::Joint;
/// use iiwa_traj::{Limit, LimitKind, Limited};
///
/// let limit = |of| Limit::Motion { of, kind: LimitKind::Velocity };
/// assert_eq!(limit(Limited::Joint(Joint::A4)).to_string(), "A4 velocity");
/// assert_eq!(limit(Limited::Way).to_string(), "cart velocity");
/// assert_eq!(limit(Limited::Turn).name(), "orientation_velocity");
/// assert_eq!(Limit::Torque(Joint::A2).to_string(), "A2 torque");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Limit {
    /// A limit of velocity, acceleration or jerk.
    Motion {
        /// What is limited.
        of: Limited,
        /// Which of its limits.
        kind: LimitKind,
    },
    /// The torque of a joint.
    Torque(Joint),
    /// A limit that is not one of this crate's: see [`PathLimit`](crate::PathLimit).
    Other {
        /// Its name in files.
        name: &'static str,
        /// The joint, if it is one of a joint.
        joint: Option<Joint>,
    },
}

/// What has limits of its motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Limited {
    /// A joint.
    Joint(Joint),
    /// The way of the TCP.
    Way,
    /// The angle by which the TCP turns.
    Turn,
}

/// For how long a limit is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitShare {
    /// The limit.
    pub limit: Limit,
    /// The share of the time at which the joint or the TCP is at it, above 0 and up to 1. Several limits may be
    /// kept at the same time.
    pub share: f64,
}

impl Limit {
    /// The joint, if it is one of a joint.
    #[must_use]
    pub fn joint(&self) -> Option<Joint> {
        match self {
            Self::Torque(joint) | Self::Motion { of: Limited::Joint(joint), .. } => Some(*joint),
            Self::Motion { of: Limited::Way | Limited::Turn, .. } => None,
            Self::Other { joint, .. } => *joint,
        }
    }

    /// Its name in files, without the joint: `velocity`, `acceleration` or `jerk`, after `cart_` or `orientation_` where
    /// it is one of the TCP; `torque`; or the name of another.
    #[must_use]
    pub fn name(&self) -> &'static str {
        let (of, kind) = match *self {
            Self::Torque(_) => return "torque",
            Self::Other { name, .. } => return name,
            Self::Motion { of, kind } => (of, kind),
        };
        match (of, kind) {
            (Limited::Joint(_), kind) => kind.name(),
            (Limited::Way, LimitKind::Velocity) => "cart_velocity",
            (Limited::Way, LimitKind::Acceleration) => "cart_acceleration",
            (Limited::Way, _) => "cart_jerk",
            (Limited::Turn, LimitKind::Velocity) => "orientation_velocity",
            (Limited::Turn, LimitKind::Acceleration) => "orientation_acceleration",
            (Limited::Turn, _) => "orientation_jerk",
        }
    }
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Torque(joint) => write!(f, "{joint} torque"),
            Self::Other { name, joint: Some(joint) } => write!(f, "{joint} {name}"),
            Self::Other { name, joint: None } => f.write_str(name),
            Self::Motion { of: Limited::Joint(joint), kind } => write!(f, "{joint} {kind}"),
            Self::Motion { of: Limited::Way, kind } => write!(f, "cart {kind}"),
            Self::Motion { of: Limited::Turn, kind } => write!(f, "orientation {kind}"),
        }
    }
}
