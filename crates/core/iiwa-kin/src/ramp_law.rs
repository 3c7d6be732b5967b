//! Limits of snap and jerk of a motion that starts or stops under Sunrise.

use crate::{Joints, SplineSpeed};

/// Limits of snap and jerk of a PTP near a pose at rest, as measured on one LBR iiwa 7 R800: KUKA publishes none of them.
///
/// `u` is the direction of the line, a unit vector in joint space that points away from the pose; a ramp to a stop is that of
/// a start backwards. The way along the line is in rad.
///
/// - Snap at the beginning: the second derivative of the joints' torques, `M(q) u` times the snap, is at most
///   [`torque_snap_nm_s2`](Self::torque_snap_nm_s2). Exact over 17 directions from one pose, to 1e-5.
/// - Jerk J and acceleration a at the end of the phase of constant snap: `J + damping a <= R / |B u + M(q) u|` of each joint.
///   A fitted form, to 1.1 % (rms).
/// - Phases are as wide as [`width_rad_s`](Self::width_rad_s) in speed.
///
/// Source: commanded positions of three KUKA `DataRecorder` logs (2020 and 2021; 46 ramps), in a public repository,
/// `dheeraj9932/Automated-spline-trajectory-planning-for-offline-robot-programming` at 2edb0b6.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RampLaw {
    /// Largest second derivative of each joint's torque, in Nm/s^2.
    pub torque_snap_nm_s2: Joints,
    /// Inertia of each joint beyond that of the arm, as of its motor, in kg m^2: B.
    pub motor_inertia_kg_m2: Joints,
    /// R of ramps that start, in Nm/s; 1e9 of joints that were never seen to limit.
    pub start_nm_s: Joints,
    /// R of ramps that stop, in Nm/s.
    pub stop_nm_s: Joints,
    /// Jerk per acceleration, in 1/s: c.
    pub damping_per_s: f64,
    /// Width of a phase, in rad/s along the line.
    pub width_rad_s: f64,
    /// Least length of a line or a spline over its top speed, in s.
    pub least_cruise_s: f64,
    /// Speed along splines: a model.
    pub spline: SplineSpeed,
}

/// Largest snap and jerk at one end of a line, in rad along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RampLimits {
    /// Largest snap, in rad/s^4.
    pub snap: f64,
    /// Largest `J + damping a`, in rad/s^3.
    pub jerk: f64,
    /// c, in 1/s.
    pub damping_per_s: f64,
}

/// The end of a line at which a ramp is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RampEnd {
    /// At the start of a line.
    Start,
    /// At its end.
    Stop,
}

impl RampEnd {
    /// Both, in order.
    pub const BOTH: [Self; 2] = [Self::Start, Self::Stop];
}

/// R of a joint that was never seen to limit.
const NEVER: f64 = 1e9;

/// Torques' second derivatives over the torque limits, in 1/s^2, with the inertias of the built-in models.
const SNAP_PER_TORQUE: f64 = 38.87;

impl RampLaw {
    /// The law of the iiwa 7, which has these torque limits.
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

    /// The law of another arm: limits of torque rates grow with the limits of torque.
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

    /// The law at an override: the time of a motion, divided by `share`.
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

    /// The limits at one end of a line, whose unit vector there leads `away` from rest; `torques` are what an acceleration of
    /// 1 rad/s^2 that way takes, `M(q) u` in Nm; `shares` are those of the limits of jerk that a motion may use.
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
