//! Motions along a line with ramps as under Sunrise, fitted to all samples at once.

use iiwa_traj::RampStart;

use crate::{
    identify::{
        ramps::Observed,
        soft_shape::{SoftLine, SoftShape},
    },
    least_squares::{self, Fit, FitModel},
};

/// Parameters: start position and time, length of the way, top speed and acceleration, and for the
/// first phase of each ramp the speed at its end and the remaining share of the squared
/// acceleration: 0 for a ramp of one phase.
const FROM: usize = 0;
const BEGIN: usize = 1;
const WAY: usize = 2;
const SPEED: usize = 3;
const ACCELERATION: usize = 4;
const RAMPS: [[usize; 2]; 2] = [[5, 6], [7, 8]];
const COUNT: usize = 9;

type SoftParameters = [f64; COUNT];

/// Minimum duration in s of a phase that shows a limit.
const SHOWN_S: f64 = 2e-3;

/// Share of the acceleration, reached in the first phase, above which the phase does not show a
/// jerk limit.
const WHOLE_SHARE: f64 = 0.98;

/// Relative difference up to which a first phase counts as having the minimum width.
const APART: f64 = 0.02;

/// Initial values for ramps, in addition to the expected ones: the width of the first phase
/// relative to the minimum, and the remaining share of the squared acceleration. The last phase has
/// three forms, and a fit remains in the form of its initial value.
const STARTS: [[f64; 2]; 9] = [
    [1.02, 0.05],
    [1.02, 0.25],
    [1.02, 0.55],
    [1.3, 0.05],
    [1.3, 0.25],
    [1.3, 0.55],
    [1.7, 0.05],
    [1.7, 0.25],
    [1.7, 0.55],
];

/// Residual in rad below which the form is clear.
const CLEAR_RAD: f64 = 1e-7;

/// Number of samples that is sufficient to find the form.
const ROUGHLY: usize = 160;

/// Observed motion along a line, in the unit of the samples (rad).
#[derive(Clone, Copy, Debug)]
pub(super) struct SoftRamps {
    /// Start time, in s.
    pub(super) start_s: Observed,
    /// End time, in s.
    pub(super) end_s: Observed,
    /// Top speed, if it was held for some time.
    pub(super) speed: Option<Observed>,
    /// Acceleration, if it was held for some time.
    pub(super) acceleration: Option<Observed>,
    /// Results of both ramps, if the acceleration was held for some time.
    pub(super) ends: Option<[SoftEnd; 2]>,
    /// Root mean square residual of the model.
    pub(super) residual: f64,
}

/// Result of a ramp.
#[derive(Clone, Copy, Debug)]
pub(super) struct SoftEnd {
    /// Largest snap that would reach the acceleration in one phase, which determines the speed at
    /// the end of the first phase, in rad/s^4; none if that speed is the minimum.
    pub(super) snap: Option<Observed>,
    /// Jerk at the end of the first phase, in rad/s^3, and the acceleration there, in rad/s^2; none
    /// if the phase reaches the whole acceleration.
    pub(super) jerk: Option<(Observed, f64)>,
}

/// Samples of the way over time.
struct SoftSamples<'a> {
    t_s: &'a [f64],
    way: &'a [f64],
    width: f64,
}

/// Returns the first phase of a ramp.
fn first_phase(p: &SoftParameters, [speed, left]: [usize; 2]) -> RampStart {
    let square = (1.0 - p[left]).max(1e-3) * p[ACCELERATION].powi(2);
    RampStart { speed: p[speed], jerk: square / (1.5 * p[speed]) }
}

impl SoftSamples<'_> {
    fn line(&self, p: &SoftParameters) -> SoftLine {
        SoftLine {
            way: p[WAY],
            speed: p[SPEED],
            acceleration: p[ACCELERATION],
            ends: RAMPS.map(|ramp| first_phase(p, ramp)),
            width: self.width,
        }
    }

    /// Returns the best parameters of fits from several initial values.
    fn explore(&self, start: SoftParameters, [enough, worth]: [f64; 2]) -> Option<SoftParameters> {
        let fit = |start| least_squares::fit(self, start, [false; COUNT]);
        let mut best = fit(start);
        if best.as_ref().is_some_and(|best| best.residual > worth) {
            return None;
        }
        // Noise hides the correct form, so that all forms are tried.
        let is_enough = |best: &Option<Fit<COUNT>>| {
            enough <= CLEAR_RAD && best.as_ref().is_some_and(|best| best.residual <= enough)
        };
        // The form of one end affects the optimum of the other one: both are tried in turn, twice.
        for [speed, left] in RAMPS.into_iter().cycle().take(2 * RAMPS.len()) {
            let from = best.as_ref().map_or(start, |best| best.parameters);
            for [width, share] in STARTS {
                if is_enough(&best) {
                    break;
                }
                let mut other = from;
                (other[speed], other[left]) = (width * self.width, share);
                let candidate = fit(other);
                // The first fit shows if others are worthwhile.
                if best.is_none()
                    && candidate.as_ref().is_some_and(|candidate| candidate.residual > worth)
                {
                    return None;
                }
                let residual = |fit: &Option<Fit<COUNT>>| {
                    fit.as_ref().map_or(f64::INFINITY, |fit| fit.residual)
                };
                if residual(&candidate) < residual(&best) {
                    best = candidate;
                }
            }
        }
        best.map(|best| best.parameters)
    }
}

impl FitModel<COUNT> for SoftSamples<'_> {
    fn samples(&self, p: &SoftParameters, mut each: impl FnMut(f64, SoftParameters)) {
        const STEP: f64 = 1e-6;
        let shape = SoftShape::new(&self.line(p));
        let moved: Vec<_> = (WAY..COUNT)
            .map(|i| {
                let mut moved = *p;
                let step = STEP * p[i].max(1e-2);
                moved[i] += step;
                (i, SoftShape::new(&self.line(&moved)), step)
            })
            .collect();
        for (t_s, way) in self.t_s.iter().zip(self.way) {
            let t = t_s - p[BEGIN];
            let [position, speed] = shape.at(t);
            let mut by = [0.0; COUNT];
            (by[FROM], by[BEGIN]) = (1.0, -speed);
            for (i, moved, step) in &moved {
                by[*i] = (moved.at(t)[0] - position) / step;
            }
            each(way - p[FROM] - position, by);
        }
    }

    fn lower_bounds(&self) -> SoftParameters {
        let mut lower_bounds = [1e-3; COUNT];
        (lower_bounds[FROM], lower_bounds[BEGIN]) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        // Minimum width of the first phase.
        for [speed, left] in RAMPS {
            (lower_bounds[speed], lower_bounds[left]) = (self.width, 0.0);
        }
        lower_bounds
    }
}

impl SoftRamps {
    /// Fits a way from rest to rest that is expected to be about `line`, with its middle at
    /// `middle_s`. Returns `None` if the motion has another form, or if the residual of the first
    /// fit is above `worth`. If `enough` is at most [`CLEAR_RAD`], a fit with a residual of at most
    /// `enough` is not improved further.
    pub(super) fn fit(
        t_s: &[f64],
        way: &[f64],
        line: &SoftLine,
        middle_s: f64,
        [enough, worth]: [f64; 2],
    ) -> Option<Self> {
        let all = SoftSamples { t_s, way, width: line.width };
        let mut p = [0.0; COUNT];
        (p[WAY], p[SPEED], p[ACCELERATION]) = (line.way, line.speed, line.acceleration);
        for ([speed, left], end) in RAMPS.into_iter().zip(line.ends) {
            let share = 1.5 * end.jerk * end.speed / line.acceleration.powi(2);
            (p[speed], p[left]) = (end.speed, (1.0 - share).clamp(1e-3, 0.9));
        }
        p[BEGIN] = middle_s - 0.5 * SoftShape::new(&all.line(&p)).duration_s;
        let step = t_s.len().div_ceil(ROUGHLY);
        let some = |values: &[f64]| values.iter().step_by(step).copied().collect::<Vec<_>>();
        let (some_s, some_way) = (some(t_s), some(way));
        let roughly = SoftSamples { t_s: &some_s, way: &some_way, width: line.width };
        let start = roughly.explore(p, [enough, worth])?;
        let solution = least_squares::fit(&all, start, [false; COUNT])?;
        Some(Self::of(&all, &solution))
    }

    fn of(samples: &SoftSamples<'_>, fit: &Fit<COUNT>) -> Self {
        let p = &fit.parameters;
        let shape = SoftShape::new(&samples.line(p));
        let estimate =
            |figure: &dyn Fn(&SoftParameters) -> f64| (figure(p), fit.deviation_of(figure));
        let duration = |p: &SoftParameters| SoftShape::new(&samples.line(p)).duration_s;
        let cruises = shape.cruise_s >= SHOWN_S;
        let keeps = shape.plateau_s.iter().all(|plateau_s| *plateau_s >= SHOWN_S);
        let end = |ramp: [usize; 2]| {
            let speed = ramp[0];
            let narrow = p[speed] <= samples.width * (1.0 + APART);
            let reached = first_phase(p, ramp).acceleration();
            let whole = reached >= WHOLE_SHARE * p[ACCELERATION];
            SoftEnd {
                snap: (!narrow)
                    .then(|| estimate(&|p| 2.0 / 9.0 * p[ACCELERATION].powi(3) / p[speed].powi(2))),
                jerk: (!whole).then(|| (estimate(&|p| first_phase(p, ramp).jerk), reached)),
            }
        };
        Self {
            start_s: estimate(&|p| p[BEGIN]),
            end_s: estimate(&|p| p[BEGIN] + duration(p)),
            speed: cruises.then(|| estimate(&|p| p[SPEED])),
            acceleration: keeps.then(|| estimate(&|p| p[ACCELERATION])),
            ends: keeps.then(|| RAMPS.map(end)),
            residual: fit.residual,
        }
    }
}
