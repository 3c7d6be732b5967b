//! Observations of all recordings, until something is concluded from them.

use iiwa_kin::Robot;

use crate::{
    estimate::Estimate,
    identify::{
        identified::{Identified, Settle},
        kappa::Kappa,
        limits::{self, Bound},
        ramps::Observed,
    },
};

/// Within what share of their largest figure joints may be the one that limits a motion: for each kind.
const TOLERANCES: [f64; 3] = [0.005, 0.02, 0.1];

/// No mean time is taken to be known better than to this share of the time between samples.
const TIME_SHARE: f64 = 0.01;

/// Observations so far.
#[derive(Default)]
pub(super) struct Findings {
    pub(super) known: Identified,
    pub(super) bounds: [Vec<Bound>; 3],
    pub(super) settles: Vec<Observed>,
    pub(super) unequal: Vec<Observed>,
    /// Of blends of the TCP: how far before and behind the target they begin and end, as shares of what the program asks
    /// for, and how far the two are from being equal.
    pub(super) tcp_reach: [Vec<Observed>; 2],
    pub(super) tcp_unequal: Vec<Observed>,
    /// The longest time between samples of a recording, in s.
    pub(super) period_s: f64,
}

impl Findings {
    pub(super) fn conclude(self, model: &Robot) -> Identified {
        let [speed, acceleration, jerk] = &self.bounds;
        let blends = self.known.blends.iter().map(|blend| (blend.gamma_deg, blend.kappa));
        let tcp_blends = self.known.tcp_blends.iter().map(|blend| (blend.gamma_deg, blend.kappa));
        let [before, after] = self.tcp_reach.each_ref().map(|reach| Estimate::mean(reach));
        Identified {
            velocity_rad_s: limits::estimate(speed, TOLERANCES[0]),
            acceleration_rad_s2: limits::estimate(acceleration, TOLERANCES[1]),
            jerk_rad_s3: limits::estimate(jerk, TOLERANCES[2]),
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

fn settle(observations: &[Observed], period_s: f64) -> Option<Settle> {
    let mut mean_s = Estimate::mean(observations)?;
    mean_s.uncertainty = mean_s.uncertainty.hypot(TIME_SHARE * period_s);
    let count = observations.len() as f64;
    let mean = observations.iter().map(|(seconds, _)| seconds).sum::<f64>() / count;
    let squares: f64 = observations.iter().map(|(seconds, _)| (seconds - mean).powi(2)).sum();
    Some(Settle { mean_s, deviation_s: (squares / (count - 1.0).max(1.0)).sqrt() })
}
