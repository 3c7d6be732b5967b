//! The limits that a trajectory keeps.

use iiwa_kin::Joint;
use iiwa_path::LimitKind;

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
