//! Bounds of positions, sizes and angles.

/// Largest coordinate, in m: no workcell is a kilometre long.
pub(crate) const MAX_M: f64 = 1000.0;

/// Shortest edge of a box, in m. A shorter edge is a typing error.
pub(crate) const MIN_SIZE_M: f64 = 1e-6;

/// Largest angle, in rad: a full turn, plus rounding.
pub(crate) const MAX_ANGLE_RAD: f64 = std::f64::consts::TAU + 1e-12;
