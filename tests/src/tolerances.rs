//! Tolerances of plans at any instant.

/// Largest ratios of velocity, acceleration and jerk to their limits, at every instant, for
/// jerk-limited stamps.
pub const RATIOS: [f64; 3] = [1.001, 1.002, 1.02];

/// Largest ratios of velocity and acceleration for acceleration-limited stamps.
pub const SWEPT_RATIOS: [f64; 2] = [1.0015, 1.005];

/// Ratio above which a limit counts as far exceeded.
pub const FAR: f64 = 1.1;

/// Largest jump of velocity or acceleration, and largest backward speed, relative to limits:
/// rounding.
pub const JUMP: f64 = 1e-6;

/// Relative time by which a program may be faster with jerk limits than without: the sweep is not
/// exact.
pub const FASTER: f64 = 1e-4;

/// Relative tolerance of the acceleration-limited time compared with that of a finer grid.
pub const COARSE: f64 = 1e-3;

/// Intervals per blend of the finer grid.
pub const FINE_SAMPLES: usize = 400;
