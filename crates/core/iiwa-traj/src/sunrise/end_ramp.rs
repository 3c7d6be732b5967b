//! Acceleration ramps at the start and stop of a TCP motion.
//!
//! A single SPL starts and stops as a PTP motion does: with the ramp time of PTP at its ends, the
//! model reproduces the durations of three recorded lines of 183 to 288 mm within 1.2 %. Short ones
//! have shorter ramps, of one time for all six recorded lines of 28 to 85 mm. The range between
//! both is not recorded: the ramp time is interpolated by the way (assumption).

use iiwa_kin::{RampLaw, RampLimits};
use iiwa_solver::fade;

use super::ramp::Ramp;

/// Ratio of way to acceleration, over the square of the minimum cruise time, up to which a motion
/// is short: the ratio of the longest of the short recorded lines.
const SHORT: f64 = 0.55;

/// Reach of the ramps of short motions, as a multiple of the way on which a speed limit is reached
/// without jerk limits: they cover the whole way until the speed is steady.
const SHORT_REACH: f64 = 2.0;

/// Ramp next to rest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EndRamp {
    /// Largest acceleration along the path, as a share of the joint limits.
    pub(crate) acceleration_rel: f64,
    /// Time in which jerk builds up the acceleration limit, in s.
    pub(crate) build_up_s: f64,
    /// Way from rest on which these limits apply, in rad of sigma.
    pub(crate) reach_rad: f64,
}

impl EndRamp {
    /// Creates the ramp to a speed (rad/s) and an acceleration (rad/s^2) under `limits`, on a path
    /// that reaches a speed limit after `limit_rad`; at the speed `cruise`, the whole way would
    /// take the minimum cruise time. None if the robot does not move.
    pub(crate) fn new(
        [speed, acceleration]: [f64; 2],
        cruise: f64,
        limits: &RampLimits,
        law: &RampLaw,
        limit_rad: f64,
    ) -> Option<Self> {
        let ramp = Ramp::to(acceleration, limits, law.width_rad_s).below(speed);
        let ratio = cruise / acceleration / law.least_cruise_s;
        let like_ptp = ((ratio - SHORT) / (1.0 - SHORT)).clamp(0.0, 1.0);
        let between = |short: f64, ptp: f64| short + like_ptp * (ptp - short);
        let end_ramp = Self {
            acceleration_rel: between(1.0, ramp.acceleration / acceleration),
            build_up_s: between(law.spline.short_ramp_s, ramp.seconds),
            reach_rad: between(SHORT_REACH, law.spline.ramp_reach) * limit_rad,
        };
        let numbers = [end_ramp.acceleration_rel, end_ramp.build_up_s, end_ramp.reach_rad];
        numbers.iter().all(|x| *x > 0.0 && x.is_finite()).then_some(end_ramp)
    }

    /// Returns the weight of these limits at a way from rest, in rad: 1 within reach, 0 beyond
    /// twice the reach.
    pub(crate) fn weight(&self, way_rad: f64) -> f64 {
        fade(2.0 - way_rad / self.reach_rad)
    }
}
