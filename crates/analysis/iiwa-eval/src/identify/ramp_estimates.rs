//! Ramp law identified from motions along lines.

use iiwa_kin::{Joints, RampEnd, RampLaw};

use crate::{
    estimate::Estimate,
    identify::{
        limits::{self, Bound, Plausible, plausible},
        ramps::Observed,
        soft_ramps::SoftEnd,
    },
};

/// Relative distance from their largest figure within which joints may be the one that limits a
/// ramp: the inertias of the model have errors of some per cent.
const TOLERANCE: f64 = 0.08;

/// Expected error factors of the model's limits S and R (start and stop). Larger deviations are
/// first phases that noise made too wide or too narrow.
const FACTORS: [f64; 3] = [1.2, 1.35, 1.35];

/// Minimum usage of its limit by a joint that may limit a ramp, as a share of the largest usage of
/// any joint.
const SHARE: f64 = 0.7;

/// Relative standard deviation of the snap due to errors of the model's inertias.
const INERTIA_SHARE: f64 = 0.02;

/// Relative standard deviation of the jerk that the law does not explain: see `docs/evidence.md`.
const LAW_SHARE: f64 = 0.011;

/// Identified ramp law; joints that did not limit a ramp are `None`.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RampEstimates {
    /// Largest second derivative of each joint's torque, in Nm/s^2: S.
    pub torque_snap_nm_s2: [Option<Estimate>; 7],
    /// Jerk limit of starting ramps, in Nm/s: R.
    pub start_nm_s: [Option<Estimate>; 7],
    /// Jerk limit R of stopping ramps, in Nm/s.
    pub stop_nm_s: [Option<Estimate>; 7],
    /// Number of motions that begin and end with constant snap.
    pub motions: usize,
    /// Root mean square residual of these motions under the law, in rad.
    pub residual_rad: f64,
    /// Root mean square residual of these motions with seven phases of constant jerk, in rad.
    pub jerk_residual_rad: f64,
    /// Root mean square noise of the recordings along these motions, in rad.
    pub noise_rad: f64,
}

impl RampEstimates {
    /// Returns `model` with the identified values.
    #[must_use]
    pub fn law(&self, model: &RampLaw) -> RampLaw {
        let mut law = *model;
        for (values, estimates) in [
            (&mut law.torque_snap_nm_s2, &self.torque_snap_nm_s2),
            (&mut law.start_nm_s, &self.start_nm_s),
            (&mut law.stop_nm_s, &self.stop_nm_s),
        ] {
            for (value, estimates) in values.iter_mut().zip(estimates) {
                *value = estimates.map_or(*value, |estimates| estimates.value);
            }
        }
        law
    }
}

/// Observations of ramps so far.
#[derive(Debug, Default)]
pub(super) struct RampFindings {
    /// Bounds of S, of R at the start and of R at the stop.
    bounds: [Vec<Bound>; 3],
    motions: usize,
    /// Sums of squared residuals under the law and under constant jerk, and of the noise.
    squares: [f64; 3],
}

impl RampFindings {
    /// Adds one end of a motion: the direction away from rest, and the torques of an acceleration
    /// in that direction, in Nm per rad/s^2.
    pub(super) fn add_end(
        &mut self,
        end: RampEnd,
        seen: &SoftEnd,
        away: &Joints,
        torques: &Joints,
        law: &RampLaw,
    ) {
        let all = [1.0; 7];
        let [snaps, starts, stops] = &mut self.bounds;
        if let Some((snap, deviation)) = seen.snap {
            let snap = (snap, deviation.hypot(INERTIA_SHARE * snap));
            snaps.push(Bound::new(snap, torques, &all));
        }
        if let Some(((jerk, deviation), acceleration)) = seen.jerk {
            let sum = jerk + law.damping_per_s * acceleration;
            let sum: Observed = (sum, deviation.hypot(LAW_SHARE * sum));
            let with_motor =
                std::array::from_fn(|j| law.motor_inertia_kg_m2[j] * away[j] + torques[j]);
            let bounds = match end {
                RampEnd::Start => starts,
                RampEnd::Stop => stops,
            };
            bounds.push(Bound::new(sum, &with_motor, &all));
        }
    }

    /// Adds a motion: its residuals under the law and under constant jerk, and its noise, in rad.
    pub(super) fn add_motion(&mut self, residuals_rad: [f64; 3]) {
        self.motions += 1;
        for (squares, residual) in self.squares.iter_mut().zip(residuals_rad) {
            *squares += residual * residual;
        }
    }

    /// Returns the result of all motions; none without such ramps.
    pub(super) fn conclude(&self, model: &RampLaw) -> Option<RampEstimates> {
        if self.motions == 0 {
            return None;
        }
        let [residual_rad, jerk_residual_rad, noise_rad] =
            self.squares.map(|squares| (squares / self.motions as f64).sqrt());
        let by_model = [&model.torque_snap_nm_s2, &model.start_nm_s, &model.stop_nm_s];
        let [torque_snap_nm_s2, start_nm_s, stop_nm_s] = [0, 1, 2].map(|kind| {
            let by = Plausible { limits: by_model[kind], factor: FACTORS[kind], share: SHARE };
            limits::estimate(&plausible(&self.bounds[kind], by), TOLERANCE)
        });
        Some(RampEstimates {
            torque_snap_nm_s2,
            start_nm_s,
            stop_nm_s,
            motions: self.motions,
            residual_rad,
            jerk_residual_rad,
            noise_rad,
        })
    }
}
