//! What each joint may do.

use crate::Joints;

/// Limits of the seven joints. Each holds in both directions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Limits {
    /// Largest distance from zero, in rad.
    pub position_rad: Joints,
    /// Speed, in rad/s.
    pub velocity_rad_s: Joints,
    /// Acceleration, in rad/s^2.
    pub acceleration_rad_s2: Joints,
    /// Jerk, in rad/s^3.
    pub jerk_rad_s3: Joints,
    /// Torque, in Nm.
    pub torque_nm: Joints,
}

impl Limits {
    /// The first joint (0 to 6) of `joints_rad` that is outside its position limit or not a number.
    ///
    /// ```
    /// let robot = iiwa_kin::Robot::lbr_iiwa_7_r800();
    /// let degrees = [0.0, 0.0, 0.0, -130.0, 0.0, 0.0, 0.0];
    /// assert_eq!(robot.limits().outside(&degrees.map(f64::to_radians)), Some(3));
    /// ```
    #[must_use]
    pub fn outside(&self, joints_rad: &Joints) -> Option<usize> {
        // A thousandth of an arc second: a limit typed in degrees must not fail by rounding.
        const ROUNDING_RAD: f64 = 5e-9;
        let range_rad = self.position_rad.map(|limit| limit + ROUNDING_RAD);
        (0..7).find(|&j| !(-range_rad[j]..=range_rad[j]).contains(&joints_rad[j]))
    }
}
