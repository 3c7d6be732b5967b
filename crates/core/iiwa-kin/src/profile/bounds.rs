//! Keys of a profile, and what their numbers may be.

/// The version of the profile format that this library reads and writes.
pub(super) const VERSION: u64 = 1;

/// Longest profile that is read, in bytes; a full one has about four thousand.
pub(super) const MAX_BYTES: usize = 1 << 20;

/// Largest number of a profile whose key has no closer bound, in the key's unit.
pub(super) const MAX_NUMBER: f64 = 1e9;

/// Longest name of a robot, in characters.
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

/// No joint turns farther than this to either side, in degrees.
pub(super) const MAX_POSITION_DEG: f64 = 360.0;

/// The least distance of a joint's upper from its lower limit, in degrees.
pub(super) const LEAST_RANGE_DEG: f64 = 0.001;

/// Coefficients of kappa: the arm's are below 4.
pub(super) const KAPPA_RANGE: [f64; 2] = [-100.0, 100.0];

/// Times to settle and pauses, in s.
pub(super) const SETTLE_RANGE_S: [f64; 2] = [0.001, 10.0];

/// Speeds in the operating mode T1, in mm/s.
pub(super) const T1_SPEED_RANGE_MM_S: [f64; 2] = [1.0, 250.0];

/// By which share the masses of `link_mass_kg` may differ from those of `links`: they are rounded.
pub(super) const SAME_MASS: f64 = 1e-3;
