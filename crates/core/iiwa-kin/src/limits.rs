//! Joint limits.

use crate::{Joint, Joints};

/// Limits of the seven joints. Velocity, acceleration, jerk and torque limits apply in both
/// directions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Limits {
    /// Lower position limit, in rad.
    pub lower_rad: Joints,
    /// Upper position limit, in rad.
    pub upper_rad: Joints,
    /// Speed limit, in rad/s.
    pub velocity_rad_s: Joints,
    /// Acceleration limit, in rad/s^2.
    pub acceleration_rad_s2: Joints,
    /// Jerk limit, in rad/s^3.
    pub jerk_rad_s3: Joints,
    /// Torque limit, in Nm.
    pub torque_nm: Joints,
}

/// Error: a joint is outside its range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "joint {joint} is at {} deg; its range is {} to {} deg",
    degrees(*.found_rad), degrees(.range_rad[0]), degrees(.range_rad[1])
)]
#[non_exhaustive]
pub struct OutsideRange {
    /// The joint.
    pub joint: Joint,
    /// Position found, in rad; may be NaN.
    pub found_rad: f64,
    /// Lower and upper position limit, in rad.
    pub range_rad: [f64; 2],
}

impl OutsideRange {
    /// Excess beyond the nearer limit, in degrees; NaN if the position is NaN.
    #[must_use]
    pub fn excess_deg(&self) -> f64 {
        let [lower, upper] = self.range_rad;
        let nearest = if self.found_rad < lower { lower } else { upper };
        degrees((self.found_rad - nearest).abs())
    }
}

/// Tolerance by which a joint may exceed its range, in rad. A thousandth of an arc second: a limit
/// typed in degrees must not fail by rounding.
const ROUNDING_RAD: f64 = 5e-9;

impl Limits {
    /// Lower and upper position limit of a joint, in rad.
    #[must_use]
    pub fn range_rad(&self, joint: Joint) -> [f64; 2] {
        [self.lower_rad[joint.index()], self.upper_rad[joint.index()]]
    }

    /// Checks that all joints are within their ranges.
    ///
    /// # Errors
    ///
    /// If a joint is outside its range or not a number; reports the first such joint.
    ///
    /// ```
    /// use iiwa_kin::{Joint, Robot};
    ///
    /// let degrees = [0.0, 0.0, 0.0, -130.0, 0.0, 0.0, 0.0];
    /// let outside =
    ///     Robot::lbr_iiwa_7_r800().limits().check(&degrees.map(f64::to_radians)).unwrap_err();
    /// assert_eq!(outside.joint, Joint::A4);
    /// assert_eq!(outside.to_string(), "joint A4 is at -130 deg; its range is -120 to 120 deg");
    /// assert_eq!(outside.excess_deg(), 10.0);
    /// ```
    pub fn check(&self, joints_rad: &Joints) -> Result<(), OutsideRange> {
        for joint in Joint::ALL {
            let [lower, upper] = self.range_rad(joint);
            let found_rad = joints_rad[joint.index()];
            if !(lower - ROUNDING_RAD..=upper + ROUNDING_RAD).contains(&found_rad) {
                return Err(self.outside(joint, found_rad));
            }
        }
        Ok(())
    }

    /// Error that reports `joint` at `found_rad`, outside its range.
    #[must_use]
    pub fn outside(&self, joint: Joint, found_rad: f64) -> OutsideRange {
        OutsideRange { joint, found_rad, range_rad: self.range_rad(joint) }
    }

    /// Nearest positions within the joint ranges, joint by joint, in rad.
    #[must_use]
    pub fn clamp(&self, joints_rad: &Joints) -> Joints {
        std::array::from_fn(|j| joints_rad[j].clamp(self.lower_rad[j], self.upper_rad[j]))
    }

    /// Positions at relative places within the joint ranges: -1 is the lower limit of a joint, 1
    /// its upper limit.
    #[must_use]
    pub fn at_shares(&self, shares: &Joints) -> Joints {
        std::array::from_fn(|j| {
            let [lower, upper] = [self.lower_rad[j], self.upper_rad[j]];
            0.5 * ((upper + lower) + shares[j] * (upper - lower))
        })
    }
}

/// Angle in degrees, rounded to the decimals that distinguish a value from its limit.
fn degrees(rad: f64) -> f64 {
    let degrees = rad.to_degrees();
    let rounded = (degrees * 1e7).round() / 1e7;
    if rounded.is_finite() { rounded } else { degrees }
}
