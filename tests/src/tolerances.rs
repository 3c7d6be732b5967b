//! What is allowed of a plan, at any instant.

/// Largest ratios of velocity, acceleration and jerk to their limits, at every instant, under jerk-limited stamps.
pub const RATIOS: [f64; 3] = [1.001, 1.002, 1.02];

/// The same of velocity and acceleration under acceleration-limited stamps.
pub const SWEPT_RATIOS: [f64; 2] = [1.0015, 1.005];

/// Above this ratio, a limit counts as exceeded by far.
pub const FAR: f64 = 1.1;

/// Largest jump of velocity or acceleration, and largest speed backwards, as shares of limits: rounding.
pub const JUMP: f64 = 1e-6;

/// By which share a program may be faster under limits of jerk than without them: the sweep is not exact.
pub const FASTER: f64 = 1e-4;

/// By which share the acceleration-limited time may be off that of a finer grid.
pub const COARSE: f64 = 1e-3;

/// How fine that grid is: intervals a blend.
pub const FINE_SAMPLES: usize = 400;
