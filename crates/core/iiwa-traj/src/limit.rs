//! Limits of a trajectory.

use std::fmt;

use iiwa_kin::Joint;
use iiwa_program::LimitKind;

/// Limit of a joint or of the TCP.
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
/// assert_eq!(Limit::MinimumDuration.to_string(), "minimum duration");
/// assert_eq!(Limit::MinimumDuration.name(), "minimum_duration");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Limit {
    /// Limit of velocity, acceleration or jerk.
    Motion {
        /// Joint or TCP coordinate that is limited.
        of: Limited,
        /// Kind of the limit.
        kind: LimitKind,
    },
    /// Torque limit of a joint.
    Torque(Joint),
    /// Minimum duration of short motions under Sunrise: the speed is at most the whole length over
    /// [`RampLaw::least_cruise_s`](iiwa_kin::RampLaw::least_cruise_s).
    MinimumDuration,
    /// Speed limit of TCP and flange in the operating mode T1.
    T1Velocity,
    /// Limit from another crate: see [`PathLimit`](crate::PathLimit).
    Other {
        /// Name in files.
        name: &'static str,
        /// Joint, if the limit belongs to one.
        joint: Option<Joint>,
    },
}

/// Quantity with velocity, acceleration and jerk limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Limited {
    /// Joint.
    Joint(Joint),
    /// Way of the TCP.
    Way,
    /// Angle of the TCP's rotation.
    Turn,
}

/// Share of time for which a limit is active.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitShare {
    /// Limit.
    pub limit: Limit,
    /// Share of the time at the limit, above 0 and up to 1. Several limits may be active at the
    /// same time.
    pub share: f64,
}

impl Limit {
    /// Returns the joint, if the limit belongs to one.
    #[must_use]
    pub fn joint(&self) -> Option<Joint> {
        match self {
            Self::Torque(joint) | Self::Motion { of: Limited::Joint(joint), .. } => Some(*joint),
            Self::Motion { of: Limited::Way | Limited::Turn, .. }
            | Self::MinimumDuration
            | Self::T1Velocity => None,
            Self::Other { joint, .. } => *joint,
        }
    }

    /// Returns the name in files, without the joint: `velocity`, `acceleration` or `jerk`, with the
    /// prefix `cart_` or `orientation_` for TCP limits; `torque`; `minimum_duration`;
    /// `t1_velocity`; or the name of another limit.
    #[must_use]
    pub fn name(&self) -> &'static str {
        let (of, kind) = match *self {
            Self::Torque(_) => return "torque",
            Self::MinimumDuration => return "minimum_duration",
            Self::T1Velocity => return "t1_velocity",
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
            Self::MinimumDuration => f.write_str("minimum duration"),
            Self::T1Velocity => f.write_str("T1 velocity"),
            Self::Other { name, joint: Some(joint) } => write!(f, "{joint} {name}"),
            Self::Other { name, joint: None } => f.write_str(name),
            Self::Motion { of: Limited::Joint(joint), kind } => write!(f, "{joint} {kind}"),
            Self::Motion { of: Limited::Way, kind } => write!(f, "cart {kind}"),
            Self::Motion { of: Limited::Turn, kind } => write!(f, "orientation {kind}"),
        }
    }
}
