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
/// let limit = |of| Limit { of, kind: LimitKind::Velocity };
/// assert_eq!(limit(Limited::Joint(Joint::A4)).to_string(), "A4 velocity");
/// assert_eq!(limit(Limited::Way).to_string(), "cart velocity");
/// assert_eq!(limit(Limited::Turn).name(), "orientation_velocity");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limit {
    /// What is limited.
    pub of: Limited,
    /// Which of its limits.
    pub kind: LimitKind,
}

/// What has limits.
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
        match self.of {
            Limited::Joint(joint) => Some(joint),
            Limited::Way | Limited::Turn => None,
        }
    }

    /// Its name in files, without the joint: `velocity`, `acceleration` or `jerk`, after `cart_` or `orientation_` where
    /// it is one of the TCP.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match (self.of, self.kind) {
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
        let Self { of, kind } = self;
        match of {
            Limited::Joint(joint) => write!(f, "{joint} {kind}"),
            Limited::Way => write!(f, "cart {kind}"),
            Limited::Turn => write!(f, "orientation {kind}"),
        }
    }
}

impl fmt::Display for Limited {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Joint(joint) => write!(f, "joint {joint}"),
            Self::Way => f.write_str("the TCP along its way"),
            Self::Turn => f.write_str("the turn of the TCP"),
        }
    }
}
