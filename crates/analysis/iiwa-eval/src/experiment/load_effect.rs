//! Effect of a payload on a planner, from swings without and with the payload.

use iiwa_kin::{Joints, Load, Robot};
use iiwa_plan::PlanOptions;
use iiwa_program::{Motion, Ptp};
use iiwa_traj::{PlanError, Timing};

use crate::{
    Estimate,
    experiment::{
        load::{LoadSwing, load_swings},
        trial::program,
    },
    identify::Identified,
};

/// Swings without and with a payload, and the conclusion about the planner.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LoadEffect {
    /// Swings that were observed in both recordings.
    pub swings: Vec<SwingEffect>,
    /// Explanation of the swings.
    pub verdict: LoadVerdict,
    /// Root mean square residual of the acceleration ratios for each explanation: no effect, a
    /// factor, torque.
    pub left_over: [f64; 3],
}

/// Acceleration of a joint about a pose.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SwingEffect {
    /// Joint and pose.
    pub swing: LoadSwing,
    /// Accelerations without and with the payload, in rad/s^2.
    pub acceleration_rad_s2: [Estimate; 2],
    /// Acceleration with the payload over the acceleration without.
    pub ratio: f64,
    /// Standard deviation of the ratio.
    pub deviation: f64,
    /// Modelled share of a joint's torque limit for the swing with the payload at the acceleration
    /// without it.
    pub needs_rel: f64,
    /// Required torque shares by shares of the acceleration.
    needs: Vec<(f64, f64)>,
}

/// Effect of a payload on a planner.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum LoadVerdict {
    /// No effect: accelerations are the same with the payload.
    Ignored,
    /// Accelerations are the same, but the payload is too light for a conclusion: planning with
    /// torques would have no visible effect either.
    TooLight,
    /// Accelerations are lower by this share for each kg, in all poses.
    FactorPerKg(Estimate),
    /// Accelerations are lower where the joint would otherwise exceed this share of its torque
    /// limit, as far as necessary.
    Torque(Estimate),
    /// No explanation fits, or two fit equally well.
    Undecided,
}

/// Lower bound of the standard deviation of a ratio.
const MIN_DEVIATION: f64 = 0.005;

/// Mean squared residual, in squared standard deviations, up to which an explanation is accepted,
/// and the factor by which others have to be worse.
const HOLDS: f64 = 4.0;
const WORSE: f64 = 3.0;

/// Minimum visible effect of planning with torques.
const SHOWS: f64 = 0.03;

/// Number of acceleration shares at which torques are computed.
const SHARES: usize = 16;

impl LoadEffect {
    /// Evaluates the results of two recordings, in the order of `experiment::load`: without `load`,
    /// and with it.
    ///
    /// # Errors
    ///
    /// If a swing cannot be planned for `model`.
    pub fn new(identified: &Identified, load: &Load, model: &Robot) -> Result<Self, PlanError> {
        let mut swings = Vec::new();
        for swing in load_swings() {
            let of = |recording: usize| {
                let lines = identified.lines.iter().filter(|line| {
                    line.recording == recording && swing.motions.contains(&line.motion.index())
                });
                let values: Vec<_> = lines
                    .filter_map(|line| line.acceleration_rad_s2)
                    .map(|value| (value, 1e-3 * value))
                    .collect();
                Estimate::mean(&values)
            };
            let (Some(without), Some(with)) = (of(0), of(1)) else { continue };
            let ratio = with.value / without.value;
            let relative = |it: &Estimate| it.uncertainty / (2.0 * it.value);
            let deviation = ratio * relative(&without).hypot(relative(&with));
            let mut needs = Vec::with_capacity(SHARES);
            for step in 1..=SHARES {
                let share = step as f64 / SHARES as f64;
                let acceleration = share * without.value;
                needs.push((share, torque_rel(&swing, acceleration, load, model)?));
            }
            let needs_rel = needs.last().map_or(0.0, |last| last.1);
            let (acceleration_rad_s2, deviation) = ([without, with], deviation.max(MIN_DEVIATION));
            swings.push(SwingEffect {
                swing,
                acceleration_rad_s2,
                ratio,
                deviation,
                needs_rel,
                needs,
            });
        }
        Ok(Self::of(swings, load.mass_kg))
    }

    fn of(swings: Vec<SwingEffect>, mass_kg: f64) -> Self {
        let count = swings.len() as f64;
        let misfit = |expected: &dyn Fn(&SwingEffect) -> f64| -> f64 {
            let off = |swing: &SwingEffect| (swing.ratio - expected(swing)) / swing.deviation;
            swings.iter().map(|swing| off(swing).powi(2)).sum::<f64>() / count
        };
        let rms = |expected: &dyn Fn(&SwingEffect) -> f64| -> f64 {
            let off = |swing: &SwingEffect| (swing.ratio - expected(swing)).powi(2);
            (swings.iter().map(off).sum::<f64>() / count).sqrt()
        };
        let ratios: Vec<_> = swings.iter().map(|swing| (swing.ratio, swing.deviation)).collect();
        let factor = Estimate::mean(&ratios);
        let factor_value = factor.map_or(1.0, |factor| factor.value);
        // The best fit of the share of the limit, to a thousandth.
        let shares = (200..=2000).map(|i| f64::from(i) / 1000.0);
        let torque_misfit = |limit: f64| misfit(&|swing| swing.share_at(limit));
        let fits = shares.map(|limit| (limit, torque_misfit(limit)));
        let (limit, torque_left) = fits
            .fold((1.0, torque_misfit(1.0)), |best, fit| if fit.1 < best.1 { fit } else { best });
        let [ignored, by_factor] = [misfit(&|_| 1.0), misfit(&|_| factor_value)];
        let left_over =
            [rms(&|_| 1.0), rms(&|_| factor_value), rms(&|swing| swing.share_at(limit))];
        let would_show = swings.iter().any(|swing| swing.share_at(1.0) < 1.0 - SHOWS);
        let verdict = match factor {
            Some(_) if ignored <= HOLDS && would_show => LoadVerdict::Ignored,
            Some(_) if ignored <= HOLDS => LoadVerdict::TooLight,
            Some(factor) if by_factor <= HOLDS && torque_left > WORSE * by_factor.max(1.0) => {
                let factor = Estimate { value: factor.value - 1.0, ..factor };
                LoadVerdict::FactorPerKg(factor.scaled(-1.0 / mass_kg))
            }
            Some(_) if torque_left <= HOLDS && by_factor > WORSE * torque_left.max(1.0) => {
                // The uncertainty extends to where the misfit grows by that of two standard
                // deviations.
                let bound = torque_left + 4.0 / count;
                let beyond = |step: f64| {
                    (1..500)
                        .map(|i| f64::from(i) * step)
                        .find(|off| torque_misfit(limit + off) > bound)
                        .map_or(0.5, f64::abs)
                };
                let uncertainty = beyond(1e-3).max(beyond(-1e-3));
                LoadVerdict::Torque(Estimate { value: limit, uncertainty, count: swings.len() })
            }
            _ => LoadVerdict::Undecided,
        };
        Self { swings, verdict, left_over }
    }
}

impl SwingEffect {
    /// Returns the share of the acceleration at which the swing uses this share of a torque limit:
    /// at most 1.
    #[must_use]
    pub fn share_at(&self, limit_rel: f64) -> f64 {
        let mut before = (0.0, 0.0);
        for &(share, needs) in &self.needs {
            if needs > limit_rel {
                // The holding torque alone may exceed the limit: then no share is small enough.
                let part = (limit_rel - before.1) / (needs - before.1);
                return (before.0 + part.clamp(0.0, 1.0) * (share - before.0)).clamp(0.0, 1.0);
            }
            before = (share, needs);
        }
        1.0
    }
}

/// Returns the largest share of a joint's torque limit that a swing uses in either direction, at an
/// acceleration in rad/s^2.
fn torque_rel(
    swing: &LoadSwing,
    acceleration_rad_s2: f64,
    load: &Load,
    model: &Robot,
) -> Result<f64, PlanError> {
    let j = swing.joint.index();
    let mut limits = *model.limits();
    limits.acceleration_rad_s2[j] = acceleration_rad_s2;
    let robot = model.clone().with_limits(limits);
    let [low, high] = swing.ends_rad;
    let plan = |from: Joints, to: Joints| {
        let mut program = program(from, [Ptp::to(to)]);
        program.motions.insert(0, Motion::Load(Some((*load).into())));
        let peaks = PlanOptions::with_timing(Timing::jerk_limited())
            .plan(&program, &robot)?
            .torques()
            .motions;
        Ok::<f64, PlanError>(peaks.iter().flat_map(|m| m.peak_rel).fold(0.0, f64::max))
    };
    Ok(plan(low, high)?.max(plan(high, low)?))
}
