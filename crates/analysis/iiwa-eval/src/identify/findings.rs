//! Observations of all recordings, and the conclusions from them.

use iiwa_kin::{Joints, Robot};

use crate::{
    estimate::Estimate,
    identify::{
        identified::{Identified, Settle},
        kappa::Kappa,
        limits::{self, Bound, Plausible},
        ramp_estimates::RampFindings,
        ramps::Observed,
    },
};

/// Relative distance from their largest figure within which joints may be the one that limits a
/// motion, for each kind of limit.
const TOLERANCES: [f64; 3] = [0.005, 0.02, 0.1];

/// Lower bound of the uncertainty of a mean time, as a share of the time between samples.
const TIME_SHARE: f64 = 0.01;

/// Observations so far.
#[derive(Default)]
pub(super) struct Findings {
    pub(super) known: Identified,
    pub(super) bounds: [Vec<Bound>; 3],
    pub(super) ramps: RampFindings,
    pub(super) settles: Vec<Observed>,
    pub(super) unequal: Vec<Observed>,
    /// Distances of the start and the end of TCP blends from the target, as shares of the
    /// programmed distance.
    pub(super) tcp_reach: [Vec<Observed>; 2],
    /// Differences between both distances, as shares of those with independent sides.
    pub(super) tcp_unequal: Vec<Observed>,
    /// Longest time between samples of a recording, in s.
    pub(super) period_s: f64,
}

impl Findings {
    pub(super) fn conclude(self, model: &Robot) -> Identified {
        let [speed, acceleration, jerk] = &self.bounds;
        let blends = self.known.blends.iter().map(|blend| (blend.gamma_deg, blend.kappa));
        let tcp_blends = self.known.tcp_blends.iter().map(|blend| (blend.gamma_deg, blend.kappa));
        let [before, after] = self.tcp_reach.each_ref().map(|reach| Estimate::mean(reach));
        Identified {
            velocity_rad_s: with_model(speed, &model.limits().velocity_rad_s, TOLERANCES[0]),
            acceleration_rad_s2: with_model(
                acceleration,
                &model.limits().acceleration_rad_s2,
                TOLERANCES[1],
            ),
            jerk_rad_s3: limits::estimate(jerk, TOLERANCES[2]),
            ramps: self.ramps.conclude(model.ramp_law()),
            settle: settle(&self.settles, self.period_s),
            kappa: Kappa::fit(&blends.collect::<Vec<_>>(), |gamma| model.kappa(gamma)),
            unequal_share: Estimate::mean(&self.unequal),
            tcp_kappa: Kappa::fit(&tcp_blends.collect::<Vec<_>>(), |gamma| model.tcp_kappa(gamma)),
            tcp_reach: before.zip(after).map(|(before, after)| [before, after]),
            tcp_unequal_share: Estimate::mean(&self.tcp_unequal),
            ..self.known
        }
    }
}

/// Returns the limits shown by the observations alone. For joints that remain open, returns those
/// shown under the assumption that the ratios of the limits are about the model's.
fn with_model(bounds: &[Bound], model: &Joints, tolerance: f64) -> [Option<Estimate>; 7] {
    let shown = limits::estimate(bounds, tolerance);
    let by = Plausible { limits: model, factor: 1.35, share: 0.8 };
    let by_model = limits::estimate(&limits::plausible(bounds, by), tolerance);
    std::array::from_fn(|j| shown[j].or(by_model[j]))
}

fn settle(observations: &[Observed], period_s: f64) -> Option<Settle> {
    let mut mean_s = Estimate::mean(observations)?;
    mean_s.uncertainty = mean_s.uncertainty.hypot(TIME_SHARE * period_s);
    let count = observations.len() as f64;
    let mean = observations.iter().map(|(seconds, _)| seconds).sum::<f64>() / count;
    let squares: f64 = observations.iter().map(|(seconds, _)| (seconds - mean).powi(2)).sum();
    Some(Settle { mean_s, deviation_s: (squares / (count - 1.0).max(1.0)).sqrt() })
}
