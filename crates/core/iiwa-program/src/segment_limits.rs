//! Limits of a single spline segment.

use iiwa_kin::Joints;

use crate::{
    cartesian_fault::CartesianFault,
    limit_kind::{ByKind, MIN_SHARE, is_share},
    tool_limits::ToolLimits,
};

/// Limits of a spline segment; the spline's limits by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SegmentLimits {
    /// Share of each joint's limit, in (0, 1].
    pub shares: ByKind<Option<Joints>>,
    /// TCP limits; infinite if the spline's limits apply.
    pub tool: ToolLimits,
}

impl SegmentLimits {
    /// Checks the limits; returns the first that is too small or out of range.
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
