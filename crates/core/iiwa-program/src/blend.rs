//! How large a blend is.

/// Where the arm may leave the straight line to the target and cut the corner.
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
    /// Sunrise's `setBlendingRel`, 0 to 1, where 1 is half of a segment; below 0.05 it is a stop.
    SunriseRel(f64),
    /// `b_r` of Larsen 2019: a radius about the target, in mm; below 4 mm it is a stop.
    CartMm(f64),
}

/// Sunrise takes a relative blend below this as an exact stop.
pub const SUNRISE_REL_MIN: f64 = 0.05;
/// Sunrise takes a Cartesian blend below this as an exact stop, in mm.
pub const CART_MM_MIN: f64 = 4.0;

impl Blend {
    /// Whether it is large enough not to be a stop.
    #[must_use]
    pub fn has_effect(self) -> bool {
        match self {
            Self::Fraction(b) => b > 0.0,
            Self::SunriseRel(x) => x >= SUNRISE_REL_MIN,
            Self::CartMm(r) => r >= CART_MM_MIN,
        }
    }
}
