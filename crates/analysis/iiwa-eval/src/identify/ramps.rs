//! Speed along a straight line from rest to rest: the seven phases of constant jerk, fitted to all
//! samples of a motion at once.
//!
//! Nothing is differentiated, so that noise is averaged over the whole motion instead of being
//! amplified: top speed, acceleration and jerk follow from the parameters of the way over time.

use crate::least_squares::{self, Fit, FitModel};

/// Parameters: start position, length of the way, middle of the duration, and the durations of the
/// phases: jerk, constant acceleration, constant speed.
const START: usize = 0;
const WAY: usize = 1;
const MIDDLE: usize = 2;
const JERK: usize = 3;
const PUSH: usize = 4;
const CRUISE: usize = 5;
const COUNT: usize = 6;

/// Minimum duration of a jerk phase, in s: it must not vanish.
const SHORTEST_S: f64 = 1e-4;

/// Increase of the residual, in standard deviations, above which a phase cannot be omitted.
const SHOWN_DEVIATIONS: f64 = 5.0;

/// Ratio of a phase's duration to its standard deviation above which the phase is clearly present.
const CLEAR_DEVIATIONS: f64 = 30.0;

/// Minimum duration in s of a phase that shows a limit.
const SHOWN_S: f64 = 2e-3;

/// Value and its standard deviation.
pub(super) type Observed = (f64, f64);

/// Observed motion along a line; ways are those of the samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ramps {
    /// Start time, in s.
    pub(super) start_s: Observed,
    /// End time, in s.
    pub(super) end_s: Observed,
    /// Top speed, if it was held for some time.
    pub(super) speed: Option<Observed>,
    /// Acceleration, if it was held for some time.
    pub(super) acceleration: Option<Observed>,
    /// Jerk, if the jerk phase was long enough.
    pub(super) jerk: Option<Observed>,
    /// Root mean square residual of the model.
    pub(super) residual: f64,
}

/// Samples of the way over time.
struct RampLine<'a> {
    t_s: &'a [f64],
    way: &'a [f64],
}

/// Returns the way from 0 to 1 at `t` from its middle, for given durations of the phases.
fn shape(t: f64, [jerk_s, push_s, cruise_s]: [f64; 3]) -> f64 {
    let rise_s = 2.0 * jerk_s + push_s;
    let speed = (rise_s + cruise_s).recip();
    // The second half mirrors the first.
    let before = 0.5 * cruise_s + rise_s - t.abs();
    let way = if before <= 0.0 {
        0.0
    } else {
        let acceleration = speed / (jerk_s + push_s);
        let jerk = acceleration / jerk_s;
        if before < jerk_s {
            jerk * before.powi(3) / 6.0
        } else if before < jerk_s + push_s {
            let pushed = before - jerk_s;
            acceleration * (jerk_s * jerk_s / 6.0 + pushed * (jerk_s + pushed) / 2.0)
        } else {
            let remaining_s = rise_s - before;
            let eased = if remaining_s > 0.0 { jerk * remaining_s.powi(3) / 6.0 } else { 0.0 };
            speed * (0.5 * rise_s - remaining_s) + eased
        }
    };
    if t < 0.0 { way } else { 1.0 - way }
}

impl FitModel<COUNT> for RampLine<'_> {
    fn samples(&self, p: &[f64; COUNT], mut each: impl FnMut(f64, [f64; COUNT])) {
        const STEP_S: f64 = 1e-6;
        let durations = [p[JERK], p[PUSH], p[CRUISE]];
        for (t_s, way) in self.t_s.iter().zip(self.way) {
            let t = t_s - p[MIDDLE];
            let point = shape(t, durations);
            let mut by = [0.0; COUNT];
            (by[START], by[WAY]) = (1.0, point);
            by[MIDDLE] = p[WAY] * (point - shape(t + STEP_S, durations)) / STEP_S;
            for phase in 0..3 {
                let mut longer = durations;
                longer[phase] += STEP_S;
                by[JERK + phase] = p[WAY] * (shape(t, longer) - point) / STEP_S;
            }
            each(way - p[START] - p[WAY] * point, by);
        }
    }

    fn lower_bounds(&self) -> [f64; COUNT] {
        let none = f64::NEG_INFINITY;
        [none, none, none, SHORTEST_S, 0.0, 0.0]
    }
}

impl Ramps {
    /// Fits the phases to a way of about `length` from rest to rest; none if the motion has another
    /// form.
    pub(super) fn fit(t_s: &[f64], way: &[f64], length: f64) -> Option<Self> {
        let line = RampLine { t_s, way };
        let start = line.guess(length)?;
        let mut held = [false; COUNT];
        let free = least_squares::fit(&line, start, held)?;
        let mut best = free.clone();
        // Phases that are not significant are omitted, so that they do not blur the others.
        for (phase, absent) in [(CRUISE, 0.0), (PUSH, 0.0), (JERK, SHORTEST_S)] {
            if best.parameters[phase] > CLEAR_DEVIATIONS * best.deviation(phase) {
                continue;
            }
            let mut parameters = best.parameters;
            parameters[phase] = absent;
            held[phase] = true;
            let without = least_squares::fit(&line, parameters, held).filter(|without| {
                without.squares - best.squares < (SHOWN_DEVIATIONS * best.residual).powi(2)
            });
            held[phase] = without.is_some();
            best = without.unwrap_or(best);
        }
        Some(Self::of(&free, &best))
    }

    /// Combines the fit in which all phases were free and the one without insignificant phases. The
    /// choice of phases is not certain: its effect on the times is part of their uncertainty. If
    /// its effect on a limit is larger than the scatter, the limit is that of the free fit: without
    /// a phase of constant acceleration that noise had hidden, jerk would be too small in all
    /// motions alike, and averaging would not reveal it.
    fn of(free: &Fit<COUNT>, fit: &Fit<COUNT>) -> Self {
        type PhaseDurations = [f64; COUNT];
        let half = |p: &PhaseDurations| 0.5 * p[CRUISE] + 2.0 * p[JERK] + p[PUSH];
        let speed = |p: &PhaseDurations| p[WAY].abs() / (2.0 * p[JERK] + p[PUSH] + p[CRUISE]);
        let acceleration = |p: &PhaseDurations| speed(p) / (p[JERK] + p[PUSH]);
        let shows = |phase: usize| fit.parameters[phase] >= SHOWN_S;
        let estimate_by = |fit: &Fit<COUNT>, figure: &dyn Fn(&PhaseDurations) -> f64| {
            (figure(&fit.parameters), fit.deviation_of(figure))
        };
        let observed = |figure: &dyn Fn(&PhaseDurations) -> f64| {
            let (value, deviation) = estimate_by(fit, figure);
            let certain = (figure(&free.parameters) - value).abs() <= deviation;
            if certain { (value, deviation) } else { estimate_by(free, figure) }
        };
        let time = |figure: &dyn Fn(&PhaseDurations) -> f64| {
            let (time_s, deviation_s) = estimate_by(fit, figure);
            (time_s, deviation_s.hypot(figure(&free.parameters) - time_s))
        };
        Self {
            start_s: time(&|p| p[MIDDLE] - half(p)),
            end_s: time(&|p| p[MIDDLE] + half(p)),
            speed: shows(CRUISE).then(|| observed(&speed)),
            acceleration: shows(PUSH).then(|| observed(&acceleration)),
            jerk: shows(JERK).then(|| observed(&|p| acceleration(p) / p[JERK])),
            residual: fit.residual,
        }
    }
}

impl RampLine<'_> {
    /// Returns initial parameters, from the times at which the robot passes some shares of its way.
    fn guess(&self, length: f64) -> Option<[f64; COUNT]> {
        let first_beyond = |share: f64| {
            let index = self.way.iter().position(|way| *way >= share * length)?;
            Some(self.t_s[index])
        };
        let [near_s, quarter_s, middle_s, late_s, end_s] = [
            first_beyond(0.02)?,
            first_beyond(0.3)?,
            first_beyond(0.5)?,
            first_beyond(0.7)?,
            first_beyond(0.98)?,
        ];
        let speed = 0.4 / (late_s - quarter_s).max(1e-6);
        let total_s = 1.15 * (end_s - near_s).max(4.0 * SHORTEST_S);
        // The way is speed times (rise + cruise); the duration is twice the rise plus the cruise.
        let rise_s = (total_s - speed.recip()).clamp(0.1 * total_s, 0.5 * total_s);
        let cruise_s = (total_s - 2.0 * rise_s).max(0.0);
        let mut p = [0.0; COUNT];
        (p[WAY], p[MIDDLE]) = (length, middle_s);
        (p[JERK], p[PUSH], p[CRUISE]) = (0.3 * rise_s, 0.4 * rise_s, cruise_s);
        Some(p)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Joint 1 by 40 deg at the limits of Larsen 2019, in degrees, with known durations.
    #[test]
    fn identifies_the_simulated_values() {
        let (v, a, j) = (98.0, 490.0, 10384.86);
        let durations = [a / j, v / a - a / j, 40.0 / v - v / a - a / j];
        let t_s: Vec<f64> = (0..900).map(|i| f64::from(i) * 1e-3).collect();
        let way: Vec<f64> = t_s.iter().map(|t| 3.0 + 40.0 * shape(t - 0.4321, durations)).collect();
        let relative: Vec<f64> = way.iter().map(|way| way - 3.0).collect();
        let actual = Ramps::fit(&t_s, &relative, 40.0).unwrap();
        assert!((actual.speed.unwrap().0 / v - 1.0).abs() < 1e-7, "{actual:?}");
        assert!((actual.acceleration.unwrap().0 / a - 1.0).abs() < 1e-6, "{actual:?}");
        assert!((actual.jerk.unwrap().0 / j - 1.0).abs() < 1e-5, "{actual:?}");
        assert!((actual.end_s.0 - actual.start_s.0 - 0.655_347).abs() < 1e-6);
    }

    /// A phase that does not exist is not found.
    #[test]
    fn figures_without_evidence_are_unknown() {
        let t_s: Vec<f64> = (0..600).map(|i| f64::from(i) * 1e-3).collect();
        for (push, cruise) in [(0.1, 0.0), (0.0, 0.1), (0.0, 0.0)] {
            let way: Vec<f64> = t_s.iter().map(|t| shape(t - 0.3, [0.04, push, cruise])).collect();
            let actual = Ramps::fit(&t_s, &way, 1.0).unwrap();
            assert_eq!(actual.speed.is_some(), cruise > 0.0);
            assert_eq!(actual.acceleration.is_some(), push > 0.0);
        }
    }

    #[test]
    fn the_shape_is_smooth() {
        for durations in [[0.1, 0.2, 0.3], [0.1, 0.0, 0.0], [0.1, 0.0, 1.0], [0.1, 1.0, 0.0]] {
            let whole = 4.0 * durations[0] + 2.0 * durations[1] + durations[2];
            assert!(shape(-whole / 2.0, durations).abs() < 1e-12);
            assert!((shape(whole / 2.0, durations) - 1.0).abs() < 1e-12);
            let mut before = 0.0;
            for i in -1000..=1000 {
                let way = shape(f64::from(i) * 1e-3, durations);
                assert!(way >= before && way - before < 1e-2, "{durations:?} {i}");
                before = way;
            }
        }
    }
}
