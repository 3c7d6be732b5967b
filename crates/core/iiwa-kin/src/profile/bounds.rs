//! Profile keys and the bounds of their numbers.

/// The version of the profile format that this library reads and writes.
pub(super) const VERSION: u64 = 1;

/// Longest accepted profile, in bytes; a full profile has about four thousand.
pub(super) const MAX_BYTES: usize = 1 << 20;

/// Largest accepted number for keys without a tighter bound, in the key's unit.
pub(super) const MAX_NUMBER: f64 = 1e9;

/// Longest robot name, in characters.
pub(super) const MAX_NAME: usize = 100;

pub(super) const POSITIONS: &str = "position_limit_deg";
pub(super) const RANGES: &str = "position_range_deg";
pub(super) const VELOCITIES: &str = "velocity_limit_deg_s";
pub(super) const ACCELERATIONS: &str = "acceleration_limit_deg_s2";
pub(super) const JERKS: &str = "jerk_limit_deg_s3";
pub(super) const TORQUES: &str = "torque_limit_nm";
pub(super) const MASSES: &str = "link_mass_kg";
pub(super) const LINKS: &str = "links";
pub(super) const FLANGE_MASS: &str = "flange_mass_kg";
pub(super) const FRICTION: &str = "friction";
pub(super) const VISCOUS: &str = "viscous_nm_s_rad";
pub(super) const COULOMB: &str = "coulomb_nm";
pub(super) const KAPPA: &str = "blend_kappa";
pub(super) const TCP_KAPPA: &str = "tcp_blend_kappa";
pub(super) const RAMPS: &str = "ramps";
pub(super) const SETTLE: &str = "settle_time_s";
pub(super) const BLOCKING_PAUSE: &str = "blocking_pause_s";
pub(super) const T1_SPEED: &str = "t1_speed_mm_s";

/// Largest position limit of a joint in either direction, in degrees.
pub(super) const MAX_POSITION_DEG: f64 = 360.0;

/// Smallest accepted difference between a joint's upper and lower limit, in degrees.
pub(super) const MIN_RANGE_DEG: f64 = 0.001;

/// Accepted coefficients of kappa; the built-in models have values below 4.
pub(super) const KAPPA_RANGE: [f64; 2] = [-100.0, 100.0];

/// Accepted durations of standstill after motions, in s.
pub(super) const SETTLE_RANGE_S: [f64; 2] = [0.001, 10.0];

/// Accepted speeds in operating mode T1, in mm/s.
pub(super) const T1_SPEED_RANGE_MM_S: [f64; 2] = [1.0, 250.0];

/// Relative tolerance between the masses of `link_mass_kg` and of `links`, because masses are
/// rounded.
pub(super) const SAME_MASS: f64 = 1e-3;
