//! Blend sizes.

/// Size of the zone in which the path may leave the straight line to the target and cut the corner.
///
/// ```
/// use iiwa_program::{Blend, Ptp};
///
/// let ptp = Ptp::to([0.3; 7]).velocity(0.5).blend(Blend::Fraction(0.25));
/// assert_eq!(ptp.blend, Some(Blend::Fraction(0.25)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Blend {
    /// b_% of Larsen 2019, Eq. 36: a share of each neighbouring segment, 0 to 0.5.
    Fraction(f64),
    /// Sunrise's `setBlendingRel`, 0 to 1, with 1 for half of a segment; below 0.05 the motion
    /// stops.
    SunriseRel(f64),
    /// `b_r` of Larsen 2019: a radius about the target, in mm; below 4 mm the motion stops.
    CartMm(f64),
}

/// Relative blend below which Sunrise makes an exact stop.
pub const SUNRISE_REL_MIN: f64 = 0.05;
/// Cartesian blend, in mm, below which Sunrise makes an exact stop.
pub const CART_MM_MIN: f64 = 4.0;

impl Blend {
    /// Returns true if the blend is large enough not to become a stop.
    #[must_use]
    pub fn has_effect(self) -> bool {
        match self {
            Self::Fraction(b) => b > 0.0,
            Self::SunriseRel(x) => x >= SUNRISE_REL_MIN,
            Self::CartMm(r) => r >= CART_MM_MIN,
        }
    }
}
