//! The limits of the TCP.

use crate::limit_kind::ByKind;

/// A motion's limits of the TCP, of each kind: of its way along the path, and of its turn.
///
/// ```
/// use iiwa_program::{LimitKind, ToolLimits};
///
/// let mut limits = ToolLimits::NONE;
/// limits.way[LimitKind::Velocity] = 0.25;
/// assert_ne!(limits, ToolLimits::NONE);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolLimits {
    /// Of the way: speed, acceleration and jerk along the path, in m over s to the power of the kind's
    /// [order](crate::LimitKind::order). Infinite where there is none; else above zero.
    pub way: ByKind<f64>,
    /// Of the angle by which it turns, in rad over s to the same power.
    pub turn: ByKind<f64>,
}

impl ToolLimits {
    /// No limit.
    pub const NONE: Self = Self {
        way: ByKind::from_array([f64::INFINITY; 3]),
        turn: ByKind::from_array([f64::INFINITY; 3]),
    };
}

impl Default for ToolLimits {
    fn default() -> Self {
        Self::NONE
    }
}
