//! Time parameterisation of the moves of one section: from rest to rest, independently of the other
//! sections.

use std::{
    ops::Range,
    sync::{Arc, atomic::AtomicBool},
};

use iiwa_path::{JointPath, Step};

use crate::{
    jerk::{self, JerkTiming},
    limit_usage::SATURATED_ROW,
    path_limits::{PathLimits, StepLimits, largest_share},
    section::{PieceKind, Section},
    section_sweep::{Moves, SAMPLES_BEFORE_JERK, SweepScratch, sweep_moves},
    spline_speed,
    timing::{Timing, TimingError},
};

// "Further limits" are all limits other than velocity, acceleration and jerk: torque limits and
// those of `Planner::with_limit`. Below are ratios of a value to its limit.

/// Largest ratio of a value to a further limit in a section that was planned without these limits;
/// with a larger ratio, the section is planned again.
const TOLERANCE: f64 = 1.005;

/// If the ratio in the plan without jerk limits is at least this, the plan with jerk limits
/// probably exceeds the further limit, too.
const LIKELY: f64 = 1.03;

/// Largest ratio in a section planned with further limits; above it, planning fails.
const MAX_RATIO: f64 = 1.01;

/// Path with the limits that apply to it.
#[derive(Clone, Debug)]
pub(crate) struct SectionPlanner {
    pub(crate) path: JointPath,
    /// Jerk limits of the timing, if it has any.
    jerk: Option<JerkTiming>,
    /// Intervals of the sweep along each segment.
    samples: usize,
    /// All limits except velocity, acceleration and jerk limits.
    pub(crate) limits: PathLimits,
    /// Path without the T1 speed limit of TCP and flange, and that limit in m/s; only in T1 under
    /// Sunrise's timing. Like the controller, the planner first plans without this limit, and then
    /// slows down each part of a section that exceeds it.
    unsupervised: Option<(JointPath, f64)>,
    /// Flag that interrupts planning.
    pub(crate) stop: Arc<AtomicBool>,
}

impl SectionPlanner {
    pub(crate) fn new(path: &JointPath, timing: Timing) -> Self {
        let (samples, jerk) = match timing {
            Timing::Acceleration(options) => (options.samples.max(2), None),
            Timing::Jerk(options) | Timing::Sunrise(options) => {
                let sunrise = matches!(timing, Timing::Sunrise(_));
                (SAMPLES_BEFORE_JERK, Some(JerkTiming { options, sunrise }))
            }
        };
        let mut planner = Self {
            path: path.clone(),
            jerk,
            samples,
            limits: PathLimits::default(),
            unsupervised: None,
            stop: Arc::default(),
        };
        planner.limit_as_sunrise();
        planner
    }

    /// Replaces the path.
    pub(crate) fn set_path(&mut self, path: &JointPath) {
        self.path = path.clone();
        self.limit_as_sunrise();
    }

    /// Returns memory for [`plan`](Self::plan).
    pub(crate) fn scratch(&self) -> SweepScratch {
        SweepScratch::new(self.samples)
    }

    /// Returns true if the timing limits jerk.
    pub(crate) fn limits_jerk(&self) -> bool {
        self.jerk.is_some()
    }

    /// Applies Sunrise's limits to the path. Sunrise limits the speed of a motion from rest to rest
    /// to its length divided by `least_cruise_s`, so that even a very short motion takes this time
    /// plus the time of its ramps. Recorded PTP motions and splines show this limit; that LIN and
    /// CIRC motions have it as well is an assumption. In T1, the function also stores the path
    /// without the T1 speed limit, in `unsupervised`.
    fn limit_as_sunrise(&mut self) {
        self.unsupervised = None;
        if let Some(JerkTiming { sunrise: true, .. }) = self.jerk {
            let min_cruise_s = self.path.ramp_law().least_cruise_s;
            let slower = |path: JointPath| path.with_least_cruise(min_cruise_s).unwrap_or(path);
            self.unsupervised = self.path.unsupervised().map(|(path, speed)| (slower(path), speed));
            self.path = slower(self.path.clone());
        }
    }

    /// Returns the moves from the step `first` to the next stop of the path.
    pub(crate) fn moves_from(&self, first: usize) -> Range<usize> {
        let moves = self.path.steps()[first..].iter().take_while(|step| step.moves());
        first..first + moves.count()
    }

    /// Returns the steps at rest from the step `first` to the next move of the path.
    pub(crate) fn rests_from(&self, first: usize) -> Range<usize> {
        let rests = self.path.steps()[first..].iter().take_while(|step| !step.moves());
        first..first + rests.count()
    }

    /// Returns the duration of a motion without displacement, in s: `least_cruise_s` under
    /// Sunrise's timing, otherwise 0.
    pub(crate) fn still_s(&self) -> f64 {
        match self.jerk {
            Some(JerkTiming { sunrise: true, .. }) => self.path.ramp_law().least_cruise_s,
            _ => 0.0,
        }
    }

    /// Plans the section of these moves from time 0, without the standstill after them.
    pub(crate) fn plan(
        &self,
        moves: Range<usize>,
        scratch: &mut SweepScratch,
    ) -> Result<Section, TimingError> {
        let mut section = Section {
            path: self.path.clone(),
            start_s: 0.0,
            rest_rad: match self.path.steps()[moves.clone()].last() {
                Some(Step::Move { segment, .. }) => segment.at(1.0).q,
                _ => *self.path.start_rad(),
            },
            pieces: Vec::with_capacity(moves.len() + 1),
            nodes: Vec::new(),
            late_blend: None,
        };
        match self.unsupervised {
            None => self.plan_moves(moves, &mut section, scratch)?,
            Some((ref unsupervised, speed_m_s)) => {
                section.path = unsupervised.clone();
                self.plan_moves(moves, &mut section, scratch)?;
                section.hold_speed(speed_m_s);
                section.path = self.path.clone();
            }
        }
        Ok(section)
    }

    /// Plans `steps`, each of which must be a move, and adds their pieces (segments with times) to
    /// `section`, which must have no pieces yet.
    ///
    /// A section with further limits is planned without them first, for a numerical reason: with
    /// further limits, the solver uses a finer mesh and more constraints, so that even limits that
    /// are never reached change the last digits. A section in which no further limit is active has
    /// to equal the plan without them to the last bit.
    fn plan_moves(
        &self,
        steps: Range<usize>,
        section: &mut Section,
        scratch: &mut SweepScratch,
    ) -> Result<(), TimingError> {
        let limits = self.limits.of_steps(&section.path, steps.clone());
        self.sweep(&[], steps.clone(), section, scratch)?;
        if limits.is_empty() {
            return self.limit_jerk(&[], section);
        }
        let (first, acceleration_jumps) = (steps.start, self.jerk.is_none());
        // The solver for jerk limits takes almost all of the time. If the plan without jerk limits
        // exceeds a further limit clearly, the plan with jerk limits would probably be discarded:
        // it is skipped.
        let is_excess_likely =
            !acceleration_jumps && largest_share(section, first, &limits, true) >= LIKELY;
        let is_kept = |section: &Section| {
            largest_share(section, first, &limits, acceleration_jumps) <= TOLERANCE
        };
        if !is_excess_likely {
            self.limit_jerk(&[], section)?;
            if is_kept(section) {
                return Ok(());
            }
        }
        let mut limited = Section { pieces: Vec::new(), nodes: Vec::new(), ..section.clone() };
        self.sweep(&limits, steps, &mut limited, scratch)?;
        self.limit_jerk(&limits, &mut limited)?;
        let reached = limited
            .pieces
            .iter()
            .filter_map(|piece| Some((piece.motion, piece.usage.largest_row()?)));
        // A NaN ratio counts as the largest, and is rejected below.
        let reached = reached.max_by(|(_, a), (_, b)| a.1.total_cmp(&b.1));
        let Some((motion, (limit, ratio))) = reached else { return Ok(()) };
        if is_excess_likely && ratio < SATURATED_ROW {
            // No further limit became active, contrary to the estimate.
            self.limit_jerk(&[], section)?;
            if is_kept(section) {
                return Ok(());
            }
        }
        if ratio.is_nan() || ratio > MAX_RATIO {
            return Err(TimingError::LimitExceeded { motion, limit, ratio });
        }
        *section = limited;
        Ok(())
    }

    /// Adds the moves of `steps` to `section`, under velocity and acceleration limits and
    /// further `limits`.
    fn sweep(
        &self,
        limits: &[StepLimits],
        steps: Range<usize>,
        section: &mut Section,
        scratch: &mut SweepScratch,
    ) -> Result<(), TimingError> {
        let moves = Moves { steps, ends: [None; 2], limits };
        sweep_moves(&moves, scratch, &self.stop, section)
    }

    /// Limits the jerk of a swept section (one planned under velocity and acceleration limits), if
    /// the timing has jerk limits. Under Sunrise's timing, splines follow the spline model instead.
    fn limit_jerk(&self, limits: &[StepLimits], section: &mut Section) -> Result<(), TimingError> {
        let Some(timing) = self.jerk else { return Ok(()) };
        let is_spline = !section.pieces.is_empty()
            && section.pieces.iter().all(|piece| piece.kind == PieceKind::Spline);
        // Under Sunrise's timing, splines follow the model of their speed where it has a solution.
        if timing.sunrise
            && is_spline
            && limits.is_empty()
            && spline_speed::limit(section, timing.options, &self.stop)?
        {
            return Ok(());
        }
        jerk::limit(section, limits, timing, &self.stop)
    }
}
