//! TCP limits.

use crate::{cartesian_fault::CartesianFault, limit_kind::ByKind};

/// TCP limits of a motion, of each kind, for the path and for the orientation.
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
    /// Path limits: speed, acceleration and jerk along the path, in m over s to the power of the
    /// kind's [order](crate::LimitKind::order). Infinite if unlimited, otherwise positive.
    pub way: ByKind<f64>,
    /// Orientation limits, in rad over s to the same power.
    pub turn: ByKind<f64>,
}

impl ToolLimits {
    /// Unlimited.
    pub const NONE: Self = Self {
        way: ByKind::from_array([f64::INFINITY; 3]),
        turn: ByKind::from_array([f64::INFINITY; 3]),
    };

    /// Limits by their program keys, in the units of the keys.
    pub(crate) fn by_key(&self) -> [(&'static str, f64); 6] {
        let way = self.way.into_array().map(|limit| 1e3 * limit);
        let turn = self.turn.into_array().map(f64::to_degrees);
        [
            ("cart_velocity_mm_s", way[0]),
            ("cart_acceleration_mm_s2", way[1]),
            ("cart_jerk_mm_s3", way[2]),
            ("orientation_velocity_deg_s", turn[0]),
            ("orientation_acceleration_deg_s2", turn[1]),
            ("orientation_jerk_deg_s3", turn[2]),
        ]
    }

    /// Checks the limits; returns the first that is too small.
    pub(crate) fn check(&self) -> Result<(), (&'static str, CartesianFault)> {
        for ((key, found), min) in self.by_key().into_iter().zip(LEAST) {
            // The tolerance covers unit conversions in both directions.
            if found.is_nan() || found < min * (1.0 - 1e-9) {
                return Err((key, CartesianFault::Limit { key, found, min }));
            }
        }
        Ok(())
    }

    /// These limits; limits of `other` for those that are infinite.
    pub(crate) fn or(&self, other: &Self) -> Self {
        let or = |first: &ByKind<f64>, other: &ByKind<f64>| {
            ByKind::from_fn(|kind| if first[kind].is_finite() { first[kind] } else { other[kind] })
        };
        Self { way: or(&self.way, &other.way), turn: or(&self.turn, &other.turn) }
    }
}

/// Smallest accepted limits, in the order and the units of the keys. Below them a motion takes
/// hours; and if acceleration is that low but jerk is not, only a millionth of the motion is spent
/// on building up the acceleration, which no solver can distinguish from zero.
const LEAST: [f64; 6] = [1e-3, 1.0, 1e-3, 1e-3, 0.1, 1e-3];

impl Default for ToolLimits {
    fn default() -> Self {
        Self::NONE
    }
}
