//! Blend sizes.

use schemars::JsonSchema;
use serde::Serialize;

/// Zone about the target in which the path may leave the straight line and cut the corner.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Blend {
    /// Share of each neighbouring motion (Larsen 2019, Eq. 36).
    Fraction(#[schemars(range(min = 0, max = 0.5))] f64),
    /// Sunrise's `setBlendingRel`: 1 is half of a motion; below 0.05 the robot stops.
    SunriseRel(#[schemars(range(min = 0, max = 1))] f64),
    /// Radius about the target, in mm; below 4 the robot stops.
    CartMm(#[schemars(range(min = 0))] f64),
}

/// Relative blend below which Sunrise makes an exact stop.
pub const SUNRISE_REL_MIN: f64 = 0.05;
/// Cartesian blend, in mm, below which Sunrise makes an exact stop.
pub const CART_MM_MIN: f64 = 4.0;

impl Blend {
    /// Returns true if the blend is large enough not to become a stop.
    ///
    /// ```
    /// use iiwa_program::{Blend, Ptp};
    ///
    /// let ptp = Ptp::to([0.3; 7]).velocity(0.5).blend(Blend::CartMm(2.0));
    /// assert!(!ptp.blend.is_some_and(Blend::has_effect));
    /// ```
    #[must_use]
    pub fn has_effect(self) -> bool {
        match self {
            Self::Fraction(b) => b > 0.0,
            Self::SunriseRel(x) => x >= SUNRISE_REL_MIN,
            Self::CartMm(r) => r >= CART_MM_MIN,
        }
    }
}
