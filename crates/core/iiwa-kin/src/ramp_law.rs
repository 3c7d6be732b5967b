//! Snap and jerk limits of motions that start or stop under Sunrise.

use crate::{Joints, SplineSpeed};

/// Snap and jerk limits of a PTP motion near a pose at rest, as measured on one LBR iiwa 7 R800;
/// KUKA publishes none of them.
///
/// `u` is the direction of the line, a unit vector in joint space that points away from the pose; a
/// ramp to a stop is a start ramp in reverse. Distance along the line is in rad.
///
/// - Snap at the beginning: the second derivative of the joint torques, `M(q) u` times the snap, is
///   at most [`torque_snap_nm_s2`](Self::torque_snap_nm_s2). Exact over 17 directions from one
///   pose, to 1e-5.
/// - Jerk J and acceleration a at the end of the constant-snap phase:
///   `J + damping a <= R / |B u + M(q) u|` for each joint. A fitted form, to 1.1 % (rms).
/// - Each phase spans [`width_rad_s`](Self::width_rad_s) in speed.
///
/// Source: commanded positions of three KUKA `DataRecorder` logs (2020 and 2021; 46 ramps), in a
/// public repository,
/// `dheeraj9932/Automated-spline-trajectory-planning-for-offline-robot-programming` at 2edb0b6.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RampLaw {
    /// Limit of the second time derivative of each joint torque, in Nm/s^2.
    pub torque_snap_nm_s2: Joints,
    /// Inertia of each joint in addition to the arm, such as motor inertia, in kg m^2: B.
    pub motor_inertia_kg_m2: Joints,
    /// R of start ramps, in Nm/s; 1e9 for joints that were never seen to limit the jerk.
    pub start_nm_s: Joints,
    /// R of stop ramps, in Nm/s.
    pub stop_nm_s: Joints,
    /// Jerk reduction per acceleration, in 1/s: c.
    pub damping_per_s: f64,
    /// Width of a ramp phase, in rad/s along the line.
    pub width_rad_s: f64,
    /// Lower bound of the length of a line or a spline divided by its top speed, in s.
    pub least_cruise_s: f64,
    /// Model of the speed along splines.
    pub spline: SplineSpeed,
}

/// Snap and jerk limits at one end of a line, in rad along the line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RampLimits {
    /// Snap limit, in rad/s^4.
    pub snap: f64,
    /// Limit of `J + damping a`, in rad/s^3.
    pub jerk: f64,
    /// Factor c, in 1/s.
    pub damping_per_s: f64,
}

/// End of a line at which a ramp is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RampEnd {
    /// At the start of a line.
    Start,
    /// At the end of a line.
    Stop,
}

impl RampEnd {
    /// Both ends, in order.
    pub const BOTH: [Self; 2] = [Self::Start, Self::Stop];
}

/// R of a joint that was never seen to limit the jerk.
const NEVER: f64 = 1e9;

/// Ratio of the second torque derivative limit to the torque limit, in 1/s^2, with the inertias of
/// the built-in models.
const SNAP_PER_TORQUE: f64 = 38.87;

impl RampLaw {
    /// Law of the iiwa 7, for its torque limits.
    pub(crate) fn iiwa_7(torque_nm: &Joints) -> Self {
        Self {
            torque_snap_nm_s2: torque_nm.map(|limit| SNAP_PER_TORQUE * limit),
            motor_inertia_kg_m2: [8.35, 1.0, 1.0, 4.64, 1.0, 1.0, 1.0],
            start_nm_s: [3144.0, NEVER, NEVER, 1450.0, 468.0, NEVER, NEVER],
            stop_nm_s: [3359.0, NEVER, NEVER, 1582.0, 569.0, NEVER, NEVER],
            damping_per_s: 18.41,
            width_rad_s: 0.3,
            least_cruise_s: 0.2,
            spline: SplineSpeed::IIWA_7,
        }
    }

    /// Law of another robot: torque rate limits scale with the torque limits.
    pub(crate) fn scaled(self, from_nm: &Joints, to_nm: &Joints) -> Self {
        let scaled = |values: Joints| {
            let scaled = |j: usize| (values[j] * to_nm[j] / from_nm[j]).min(NEVER);
            std::array::from_fn(scaled)
        };
        Self {
            torque_snap_nm_s2: scaled(self.torque_snap_nm_s2),
            start_nm_s: scaled(self.start_nm_s),
            stop_nm_s: scaled(self.stop_nm_s),
            ..self
        }
    }

    /// Law at an override of `share`: the duration of a motion is divided by `share`.
    #[must_use]
    pub fn slowed_down(&self, share: f64) -> Self {
        let (third, fourth) = (share.powi(3), share.powi(4));
        Self {
            torque_snap_nm_s2: self.torque_snap_nm_s2.map(|limit| fourth * limit),
            start_nm_s: self.start_nm_s.map(|limit| third * limit),
            stop_nm_s: self.stop_nm_s.map(|limit| third * limit),
            damping_per_s: share * self.damping_per_s,
            width_rad_s: share * self.width_rad_s,
            least_cruise_s: self.least_cruise_s / share,
            spline: self.spline.slowed_down(share),
            ..*self
        }
    }

    /// Limits at one end of a line whose unit vector there points `away` from rest. `torques` are
    /// the torques for an acceleration of 1 rad/s^2 in that direction, `M(q) u` in Nm; `shares` are
    /// the shares of the jerk limits that a motion may use.
    #[must_use]
    pub fn limits(
        &self,
        away: &Joints,
        torques: &Joints,
        shares: &Joints,
        end: RampEnd,
    ) -> RampLimits {
        let range = match end {
            RampEnd::Start => &self.start_nm_s,
            RampEnd::Stop => &self.stop_nm_s,
        };
        let (mut snap, mut jerk) = (f64::INFINITY, f64::INFINITY);
        for j in 0..7 {
            snap = snap.min(shares[j] * self.torque_snap_nm_s2[j] / torques[j].abs());
            let with_motor = self.motor_inertia_kg_m2[j] * away[j] + torques[j];
            jerk = jerk.min(shares[j] * range[j] / with_motor.abs());
        }
        RampLimits { snap, jerk, damping_per_s: self.damping_per_s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_override_scales_each_quantity_by_its_power_of_time() {
        let law = RampLaw::iiwa_7(&[176.0; 7]);
        let expected = RampLaw {
            torque_snap_nm_s2: law.torque_snap_nm_s2.map(|snap| snap / 16.0),
            motor_inertia_kg_m2: law.motor_inertia_kg_m2,
            start_nm_s: law.start_nm_s.map(|range| range / 8.0),
            stop_nm_s: law.stop_nm_s.map(|range| range / 8.0),
            damping_per_s: law.damping_per_s / 2.0,
            width_rad_s: law.width_rad_s / 2.0,
            least_cruise_s: law.least_cruise_s * 2.0,
            spline: law.spline.slowed_down(0.5),
        };
        assert_eq!(law.slowed_down(0.5), expected);
    }
}
