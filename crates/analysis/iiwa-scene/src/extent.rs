//! How far away, how small and how much turned anything may be.

/// Farthest that anything may be, in m: a cell has no length of a kilometre.
pub(crate) const MAX_M: f64 = 1000.0;

/// Shortest edge of a box, in m. What is shorter is a slip of the pen.
pub(crate) const MIN_SIZE_M: f64 = 1e-6;

/// Most that an angle may be, in rad: a whole turn, and what rounding adds to it.
pub(crate) const MAX_ANGLE_RAD: f64 = std::f64::consts::TAU + 1e-12;
