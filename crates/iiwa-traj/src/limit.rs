//! The limits that a trajectory keeps.

use std::fmt;

use iiwa_kin::Joint;

/// A joint's limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limit {
    /// The joint.
    pub joint: Joint,
    /// Which of its limits.
    pub kind: LimitKind,
}

/// For how long a limit is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitShare {
    /// The limit.
    pub limit: Limit,
    /// The share of the time at which the joint is at it, above 0 and up to 1. Several limits may be
    /// kept at the same time.
    pub share: f64,
}

/// The kinds of limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LimitKind {
    /// Speed.
    Velocity,
    /// Acceleration.
    Acceleration,
    /// Jerk.
    Jerk,
}

impl LimitKind {
    /// Its name in files: `velocity`, `acceleration` or `jerk`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
        }
    }
}

impl fmt::Display for LimitKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
