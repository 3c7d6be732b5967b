//! Limits of a single segment of a spline.

use iiwa_kin::Joints;

use crate::{
    cartesian_fault::CartesianFault,
    limit_kind::{ByKind, MIN_SHARE, is_share},
    tool_limits::ToolLimits,
};

/// The limits that a segment of a spline has of its own; where it has none, those of the spline hold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SegmentLimits {
    /// Shares of each joint's limits, in (0, 1].
    pub shares: ByKind<Option<Joints>>,
    /// Limits of the TCP; infinite where the spline's hold.
    pub tool: ToolLimits,
}

impl SegmentLimits {
    /// Finds the first limit that cannot be kept.
    pub(crate) fn check(&self) -> Result<(), (&'static str, CartesianFault)> {
        for (kind, shares) in &self.shares {
            if let Some(&found) = shares.iter().flatten().find(|share| !is_share(**share)) {
                let key = kind.share_key();
                return Err((key, CartesianFault::Share { key, found, min: MIN_SHARE }));
            }
        }
        self.tool.check()
    }
}
