//! Limits in the figures of a plan.

use std::{borrow::Cow, fmt};

use iiwa_kin::Joint;
use iiwa_traj::Limit;
use serde::{Deserialize, Serialize};

/// A limit with the share of a motion's time for which it is active.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LimitShareRecord {
    /// Limit.
    #[serde(flatten)]
    pub limit: LimitRecord,
    /// Share of the time, 0 to 1.
    pub share: f64,
}

/// A joint limit, a TCP limit, or a limit of another kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LimitRecord {
    /// Joint, 1 to 7; `None` for a limit that does not belong to a joint.
    pub joint: Option<usize>,
    /// Kind: `velocity`, `acceleration` or `jerk`, for a TCP limit with the prefix `cart_` (along
    /// the path) or `orientation_` (angular); `torque`; `minimum_duration` of short motions under
    /// Sunrise; `t1_velocity` of TCP and flange in T1; or the name of another limit. In plans of
    /// earlier versions, `cart_velocity` is also the kind of the minimum duration and of T1.
    pub kind: Cow<'static, str>,
}

impl From<Limit> for LimitRecord {
    fn from(limit: Limit) -> Self {
        Self { joint: limit.joint().map(Joint::number), kind: limit.name().into() }
    }
}

/// Writes `A4 velocity`, `cart velocity` or `T1 velocity`.
impl fmt::Display for LimitRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(joint) = self.joint {
            write!(f, "A{joint} ")?;
        }
        // A name, not a word.
        let kind = self.kind.strip_prefix("t1_").map(|kind| format!("T1 {kind}"));
        f.write_str(&kind.unwrap_or_else(|| self.kind.to_string()).replace('_', " "))
    }
}
