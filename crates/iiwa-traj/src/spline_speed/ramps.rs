//! Ramps of acceleration where a spline starts and stops.
//!
//! A single SPL starts and stops as a PTP motion does: with the time of the PTP ramp at its ends, three recorded lines of 183 to
//! 288 mm last as long as the model says within 1.2 %. Short ones have shorter ramps, of one time for all six recorded lines of
//! 28 to 85 mm. What lies between both is not recorded: the time goes over from one into the other with the speed (assumption).

use iiwa_kin::{Dynamics, Joints, RampEnd, RampLaw, vector};

use crate::sunrise::Ramp;

/// Ratio of speed and acceleration, over the least time of a cruise, up to which a motion is short: that of the longest of the
/// short recorded lines.
const SHORT: f64 = 0.55;

/// Reach of the ramps of short motions, as a share of the way on which a limit of speed is reached without limits of jerk: all
/// of the way until the speed is steady.
const SHORT_REACH: f64 = 2.0;

/// A place at which the arm rests.
#[derive(Clone, Copy, Debug)]
pub(super) struct RestPlace {
    /// Joint positions, in rad.
    pub(super) q: Joints,
    /// Direction of the path: dq/dsigma.
    pub(super) direction: Joints,
    /// Largest speed of sigma on the way to the next rest, without regard to acceleration and in units of this place, in rad/s.
    pub(super) speed_rad_s: f64,
    /// Acceleration limits of the joints.
    pub(super) acceleration_rad_s2: Joints,
    /// Share of the limits of jerk that the motion may use.
    pub(super) jerk_rel: Joints,
    pub(super) end: RampEnd,
}

/// A ramp next to rest.
#[derive(Clone, Copy, Debug)]
pub(super) struct EndRamp {
    /// Largest acceleration along the path, as a share of what the joints' limits allow.
    pub(super) acceleration_rel: f64,
    /// Time in which jerk builds up the acceleration limit, in s.
    pub(super) build_up_s: f64,
    /// Way from rest on which these limits hold, in rad of sigma.
    pub(super) reach_rad: f64,
}

impl EndRamp {
    /// The ramp at a `place`, on whose path a limit of speed is reached after `limit_rad`. None if no joint moves there.
    pub(super) fn new(
        place: &RestPlace,
        dynamics: &Dynamics,
        law: &RampLaw,
        limit_rad: f64,
    ) -> Option<Self> {
        let rate = vector::norm(&place.direction);
        let sign = if place.end == RampEnd::Start { 1.0 } else { -1.0 };
        let away = place.direction.map(|d| sign * d / rate);
        let torques = dynamics.path_torques(&place.q, &away, &[0.0; 7]).acceleration;
        let limits = law.limits(&away, &torques, &place.jerk_rel, place.end);
        // In rad of joint space, as the law has it.
        let acceleration = vector::largest_multiple(&away, &place.acceleration_rad_s2);
        let speed = rate * place.speed_rad_s;
        let ramp = Ramp::below(speed, acceleration, &limits, law.width_rad_s);
        let ratio = speed / acceleration / law.least_cruise_s;
        let like_ptp = ((ratio - SHORT) / (1.0 - SHORT)).clamp(0.0, 1.0);
        let between = |short: f64, ptp: f64| short + like_ptp * (ptp - short);
        let found = Self {
            acceleration_rel: between(1.0, ramp.acceleration / acceleration),
            build_up_s: between(law.spline.short_ramp_s, ramp.seconds),
            reach_rad: between(SHORT_REACH, law.spline.ramp_reach) * limit_rad,
        };
        let numbers = [found.acceleration_rel, found.build_up_s, found.reach_rad];
        numbers.iter().all(|x| *x > 0.0 && x.is_finite()).then_some(found)
    }

    /// Weight of these limits at a way from rest, in rad: 1 within reach, 0 beyond twice the reach.
    pub(super) fn weight(&self, way_rad: f64) -> f64 {
        let near = (2.0 - way_rad / self.reach_rad).clamp(0.0, 1.0);
        near * near * (3.0 - 2.0 * near)
    }
}
