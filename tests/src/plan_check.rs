//! Checks of the plans of one program.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    time::{Duration, Instant},
};

use crate::{
    extremes::{Extremes, extremes},
    mean_limits::mean_ratios,
    tolerances::{COARSE, FAR, FASTER, FINE_SAMPLES, JUMP, RATIOS, SWEPT_RATIOS},
};
use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::{LimitKind, Program};
use iiwa_traj::{SweepOptions, Timing, Trajectory};

/// Shortest cycle of the drive: a millisecond.
const CYCLE_S: f64 = 1e-3;

/// Result of the checks of a program.
#[derive(Clone, Debug, Default)]
pub struct PlanCheck {
    /// Largest ratios of velocity, acceleration and jerk to their limits at any instant.
    pub instants: [f64; 3],
    /// Largest ratios without the intervals affected by rounding.
    pub clear: [f64; 3],
    /// Largest ratios of means over a millisecond.
    pub means: [f64; 3],
    /// Largest ratios of velocity and acceleration for acceleration-limited stamps.
    pub swept: [f64; 2],
    /// Largest relative difference, by magnitude, of the acceleration-limited time from that of a
    /// finer grid.
    pub coarse: f64,
    /// Ratio of the jerk-limited to the acceleration-limited time.
    pub slower: f64,
    /// Computation time of the jerk-limited plan.
    pub planning: Duration,
    /// Computation time of its extremes.
    pub judging: Duration,
    /// Errors that explain missing stamps.
    pub refusals: Vec<String>,
    /// Failures found.
    pub failures: Vec<String>,
}

impl PlanCheck {
    /// Plans `program` with both time parameterisations and judges the results.
    #[must_use]
    pub fn of(program: &Program) -> Self {
        let mut verdict = Self::default();
        let path = match JointPath::new(program, &Robot::default()) {
            Ok(path) => path,
            Err(fault) => {
                verdict.failures.push(fault.to_string());
                return verdict;
            }
        };
        let start = Instant::now();
        let jerk = verdict.plan(&path, Timing::jerk_limited());
        verdict.planning = start.elapsed();
        if let Some(jerk) = &jerk {
            let start = Instant::now();
            let actual = extremes(jerk, Timing::jerk_limited());
            verdict.judging = start.elapsed();
            verdict.instants = actual.ratios();
            verdict.clear = actual.clear.map(|peak| peak.ratio);
            verdict.judge(&actual, jerk, Timing::jerk_limited());
            verdict.means = mean_ratios(jerk, CYCLE_S);
        }
        if let Some(sunrise) = verdict.plan(&path, Timing::default()) {
            verdict.judge(&extremes(&sunrise, Timing::default()), &sunrise, Timing::default());
        }
        let timing = Timing::Acceleration(SweepOptions::default());
        let Some(swept) = verdict.plan(&path, timing) else { return verdict };
        let actual = extremes(&swept, timing);
        let [velocity, acceleration, _] = actual.ratios();
        verdict.swept = [velocity, acceleration];
        verdict.judge(&actual, &swept, timing);
        if let Some(jerk) = &jerk {
            let [jerk_s, swept_s] = [jerk, &swept].map(Trajectory::motion_time_s);
            verdict.slower = ratio(jerk_s, swept_s);
        }
        let fine = Timing::Acceleration(SweepOptions { samples: FINE_SAMPLES });
        if let Some(fine) = verdict.plan(&path, fine) {
            verdict.coarse = ratio(swept.motion_time_s(), fine.motion_time_s()) - 1.0;
            if verdict.coarse.is_nan() || verdict.coarse.abs() > COARSE {
                verdict.failures.push("acceleration: off the time of a finer grid".to_owned());
            }
            // The coarser grid may be slower than the optimum by more than that.
            if let Some(jerk) = &jerk {
                let slower = ratio(jerk.motion_time_s(), fine.motion_time_s());
                if slower.is_nan() || slower < 1.0 - FASTER {
                    verdict.failures.push("faster than without jerk limits".to_owned());
                }
            }
        }
        verdict
    }

    fn plan(&mut self, path: &JointPath, timing: Timing) -> Option<Trajectory> {
        let planned = catch_unwind(AssertUnwindSafe(|| Trajectory::plan(path, timing)));
        match planned {
            Ok(Ok(trajectory)) => return Some(trajectory),
            Ok(Err(error)) => {
                let message = error.to_string();
                let message =
                    message.split_once(": ").map_or(message.as_str(), |(_, detail)| detail);
                self.refusals.push(format!("{}: {message}", timing.name()));
            }
            Err(_) => self.failures.push(format!("{}: a panic", timing.name())),
        }
        None
    }

    fn judge(&mut self, extremes: &Extremes, trajectory: &Trajectory, timing: Timing) {
        let name = timing.name();
        let mut fail = |message: &str| self.failures.push(format!("{name}: {message}"));
        let allowed = match timing {
            Timing::Jerk(_) => RATIOS,
            _ => [SWEPT_RATIOS[0], SWEPT_RATIOS[1], f64::INFINITY],
        };
        for (peaks, when) in [(extremes.clear, ""), (extremes.blurred, " where rounding shows")] {
            for ((kind, peak), allowed) in LimitKind::ALL.into_iter().zip(peaks).zip(allowed) {
                if peak.ratio > allowed {
                    let far = if peak.ratio > FAR { " by far" } else { "" };
                    fail(&format!("{kind} exceeded{far}{when}"));
                }
            }
        }
        for (kind, jump) in LimitKind::ALL.into_iter().zip(extremes.jumps) {
            if jump > JUMP {
                fail(&format!("{kind} jumps"));
            }
        }
        if extremes.backwards > JUMP {
            fail("goes backwards");
        }
        let mut last_s = f64::NEG_INFINITY;
        for state in trajectory.states() {
            if state.t_s.is_nan() || state.t_s <= last_s {
                return fail("stamps do not increase");
            }
            last_s = state.t_s;
        }
    }
}

/// Returns `a` over `b`; 1 if both are equal, also for zero motion.
fn ratio(a: f64, b: f64) -> f64 {
    if a == b { 1.0 } else { a / b }
}
