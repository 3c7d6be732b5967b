//! The law of the ramps, from what motions along lines show of it.

use iiwa_kin::{Joints, RampEnd, RampLaw};

use crate::{
    estimate::Estimate,
    identify::{
        limits::{self, Bound, Plausible, plausible},
        ramps::Observed,
        soft_ramps::SoftEnd,
    },
};

/// Within what share of their largest figure joints may be the one that limits a ramp: inertias of the model are off by some
/// per cent.
const TOLERANCE: f64 = 0.08;

/// Limits of a model are right to about such factors, S and R; a first phase that noise made too wide or too narrow shows
/// others.
const FACTORS: [f64; 3] = [1.2, 1.35, 1.35];

/// The least share of its limit that a joint uses which may limit a ramp, in that of the one that uses most of its own.
const SHARE: f64 = 0.7;

/// Standard deviation of snap that inertias of the model cause, as a share.
const INERTIA_SHARE: f64 = 0.02;

/// Standard deviation of jerk that the law does not explain, as a share: see `docs/evidence.md`.
const LAW_SHARE: f64 = 0.011;

/// The law of the ramps as recordings show it; joints that were not seen to limit a ramp are `None`.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FoundRamps {
    /// Largest second derivative of each joint's torque, in Nm/s^2: S.
    pub torque_snap_nm_s2: [Option<Estimate>; 7],
    /// Limit of the jerk of ramps that start, in Nm/s: R.
    pub start_nm_s: [Option<Estimate>; 7],
    /// R of ramps that stop.
    pub stop_nm_s: [Option<Estimate>; 7],
    /// Motions that begin and end with constant snap.
    pub motions: usize,
    /// Root mean square of what the law leaves over in them, in rad.
    pub residual_rad: f64,
    /// Root mean square of what seven phases of constant jerk leave over in them, in rad.
    pub jerk_residual_rad: f64,
    /// Noise of the recordings along these motions, root mean square, in rad.
    pub noise_rad: f64,
}

impl FoundRamps {
    /// `model` with what was found.
    #[must_use]
    pub fn law(&self, model: &RampLaw) -> RampLaw {
        let mut law = *model;
        for (values, found) in [
            (&mut law.torque_snap_nm_s2, &self.torque_snap_nm_s2),
            (&mut law.start_nm_s, &self.start_nm_s),
            (&mut law.stop_nm_s, &self.stop_nm_s),
        ] {
            for (value, found) in values.iter_mut().zip(found) {
                *value = found.map_or(*value, |found| found.value);
            }
        }
        law
    }
}

/// Observations of ramps so far.
#[derive(Debug, Default)]
pub(super) struct RampFindings {
    /// Bounds of S, of R at the start and of R at the end.
    bounds: [Vec<Bound>; 3],
    motions: usize,
    /// Sums of squares: what the law leaves over, what constant jerk does, noise.
    squares: [f64; 3],
}

impl RampFindings {
    /// Adds one end of a motion: the direction away from rest there, and the torques of an acceleration that way, in Nm per
    /// rad/s^2.
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

    /// Adds a motion: what the law leaves over, what constant jerk does, and its noise, in rad.
    pub(super) fn add_motion(&mut self, residuals_rad: [f64; 3]) {
        self.motions += 1;
        for (squares, residual) in self.squares.iter_mut().zip(residuals_rad) {
            *squares += residual * residual;
        }
    }

    /// What all motions show together; none if none has such ramps.
    pub(super) fn conclude(&self, model: &RampLaw) -> Option<FoundRamps> {
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
        Some(FoundRamps {
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
