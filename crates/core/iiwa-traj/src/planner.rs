//! Time parameterisation of a path, one section at a time. A section is the part of the path from
//! one stop to the next.

use std::{
    ops::Range,
    sync::{Arc, atomic::AtomicBool},
};

use iiwa_kin::Joints;
use iiwa_path::{JointPath, Step};

use crate::{
    jerk::{self, JerkTiming},
    known_in_time::{is_early, needed_s},
    limit_usage::SATURATED_ROW,
    overlapping_waits::{ProgramClock, Standing, waits_before_blend},
    path_limit::PathLimit,
    path_limits::{PathLimits, StepLimits, largest_share},
    section::{LateBlend, PieceKind, Section},
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

/// Margin in s for comparing times of plans that cover different numbers of moves. It is generous:
/// in the moves that both plans cover, times differ by nanoseconds only.
const PLANS_DIFFER_S: f64 = 0.02;

/// Decision on a blend: to continue through the blend, or to stop before it. It is necessary
/// because a wait that overlaps the motion before the blend can delay the next motion.
enum Decided {
    /// The program sends the next motion in time for the blend into it. `needed_s` is the latest
    /// time in s at which the program may send the motion. If the decision was possible without
    /// this time, `needed_s` is only a lower bound: either negative infinity, or the largest
    /// `needed_s` of the preceding blends (no blend needs its motion earlier than a preceding blend
    /// does).
    InTime { needed_s: f64 },
    /// The program sends the next motion too late. Contains the section that stops before the
    /// blend.
    TooLate(Box<Section>),
}

/// Iterator that plans a path section by section. Each section is planned when the caller asks for
/// it, and is not kept.
///
/// ```
/// use iiwa_kin::Robot;
/// use iiwa_path::JointPath;
/// use iiwa_program::{Blend, Program};
/// use iiwa_traj::{Planner, Timing};
///
/// let program = Program::from_deg([0.0; 7])
///     .ptp_deg([40.0, 0.0, 0.0, -60.0, 0.0, 0.0, 0.0])
///     .blend(Blend::Fraction(0.3))
///     .ptp_deg([40.0, 30.0, 0.0, -30.0, 0.0, 0.0, 0.0])
///     .build();
/// let path = JointPath::new(&program, &Robot::default())?;
/// let mut cycle_time_s = 0.0;
/// for section in Planner::new(&path, Timing::default()) {
///     // The section is written, sent or dropped before the next one is planned.
///     cycle_time_s = section?.end_s();
/// }
/// assert!(cycle_time_s > 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Planner {
    path: JointPath,
    timing: Timing,
    /// Jerk limits of the timing, if it has any.
    jerk: Option<JerkTiming>,
    /// Index of the next step of the path.
    step: usize,
    time_s: f64,
    /// Joint positions at the last stop, in rad.
    rest_rad: Joints,
    /// Times at which the program sends the motions after overlapping waits.
    clock: ProgramClock,
    /// Buffers of the sweep (the backward and forward pass under velocity and acceleration limits).
    scratch: SweepScratch,
    /// All limits except velocity, acceleration and jerk limits.
    limits: PathLimits,
    /// Path without the T1 speed limit of TCP and flange, and that limit in m/s; only in T1 under
    /// Sunrise's timing. Like the controller, the planner first plans without this limit, and then
    /// slows down each part of a section that exceeds it.
    unsupervised: Option<(JointPath, f64)>,
    /// Flag that interrupts planning.
    stop: Arc<AtomicBool>,
}

impl Planner {
    /// Creates a planner for `path`.
    #[must_use]
    pub fn new(path: &JointPath, timing: Timing) -> Self {
        let (samples, jerk) = match timing {
            Timing::Acceleration(options) => (options.samples.max(2), None),
            Timing::Jerk(options) | Timing::Sunrise(options) => {
                let sunrise = matches!(timing, Timing::Sunrise(_));
                (SAMPLES_BEFORE_JERK, Some(JerkTiming { options, sunrise }))
            }
        };
        let mut planner = Self {
            path: path.clone(),
            timing,
            jerk,
            step: 0,
            time_s: 0.0,
            rest_rad: *path.start_rad(),
            clock: ProgramClock::default(),
            scratch: SweepScratch::new(samples),
            limits: PathLimits::default(),
            unsupervised: None,
            stop: Arc::default(),
        };
        planner.limit_as_sunrise();
        planner
    }

    /// Applies Sunrise's limits to the path. The speed of a LIN or CIRC motion from rest to rest is
    /// limited to the length of the motion divided by `least_cruise_s`. Recorded PTP motions and
    /// splines show this limit; for LIN and CIRC, it is an assumption. Even a very short motion
    /// therefore takes at least `least_cruise_s` plus the time of its ramps. In T1, the function
    /// also stores the path without the T1 speed limit, in `unsupervised`.
    fn limit_as_sunrise(&mut self) {
        self.unsupervised = None;
        if let Some(JerkTiming { sunrise: true, .. }) = self.jerk {
            let min_cruise_s = self.path.ramp_law().least_cruise_s;
            let slower = |path: JointPath| path.with_least_cruise(min_cruise_s).unwrap_or(path);
            self.unsupervised = self.path.unsupervised().map(|(path, speed)| (slower(path), speed));
            self.path = slower(self.path.clone());
        }
    }

    /// Returns the path.
    #[must_use]
    pub fn path(&self) -> &JointPath {
        &self.path
    }

    /// Returns the timing.
    #[must_use]
    pub fn timing(&self) -> Timing {
        self.timing
    }

    /// Restarts with `path`, under the same timing and limits. The memory of the planner is reused,
    /// which for many programs is faster than a new planner for each.
    pub fn restart(&mut self, path: &JointPath) {
        (self.path, self.rest_rad) = (path.clone(), *path.start_rad());
        (self.step, self.time_s) = (0, 0.0);
        self.clock = ProgramClock::default();
        self.limit_as_sunrise();
    }

    /// Uses `stop` as the flag that interrupts planning. Soon after the caller has set the flag to
    /// true, planning ends with [`TimingError::Interrupted`], even in the middle of a section.
    #[must_use]
    pub fn interrupted_by(mut self, stop: Arc<AtomicBool>) -> Self {
        self.stop = stop;
        self
    }

    /// Adds a limit that is linear in the acceleration `u` along the path and in the squared path
    /// speed `x`: `-1 <= a u + b x + c <= 1`. The fields `acceleration`, `square` and `offset` of a
    /// [`PathRow`](crate::PathRow) are a, b and c. Here `u` is the second time derivative of the
    /// path parameter s and `x` the square of the first; [`RowLimit::rows`](crate::RowLimit::rows)
    /// gets derivatives with respect to s.
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use iiwa_kin::{Joints, Robot};
    /// use iiwa_path::JointPath;
    /// use iiwa_program::Program;
    /// use iiwa_traj::{Limit, PathLimit, PathRow, Planner, RowLimit, Timing, Trajectory};
    ///
    /// /// Limit of the sum of the accelerations of joints 1 and 4, in rad/s^2.
    /// #[derive(Clone, Copy, Debug)]
    /// struct Together(f64);
    ///
    /// impl PathLimit for Together {
    ///     fn of_step(&self, _: &JointPath, _: usize) -> Option<Box<dyn RowLimit>> {
    ///         Some(Box::new(*self))
    ///     }
    ///
    ///     fn limit(&self, _: usize) -> Limit {
    ///         Limit::Other { name: "together", joint: None }
    ///     }
    /// }
    ///
    /// impl RowLimit for Together {
    ///     fn row_count(&self) -> usize {
    ///         1
    ///     }
    ///
    ///     fn rows(&self, _: &[Joints], derivative: &[Joints], second: &[Joints]) -> Vec<PathRow> {
    ///         let sum = |q: &Joints| (q[0] + q[3]) / self.0;
    ///         let rows = derivative.iter().zip(second);
    ///         rows.map(|(one, two)| PathRow {
    ///             acceleration: sum(one),
    ///             square: sum(two),
    ///             offset: 0.0,
    ///         })
    ///         .collect()
    ///     }
    /// }
    ///
    /// let program =
    ///     Program::from_deg([0.0; 7]).ptp_deg([40.0, 0.0, 0.0, 60.0, 0.0, 0.0, 0.0]).build();
    /// let path = JointPath::new(&program, &Robot::default())?;
    /// let free = Trajectory::plan(&path, Timing::jerk_limited())?;
    /// let mut planner =
    ///     Planner::new(&path, Timing::jerk_limited()).with_limit(Arc::new(Together(4.0)));
    /// assert!(Trajectory::by(&mut planner)?.cycle_time_s() > free.cycle_time_s());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn with_limit(mut self, limit: Arc<dyn PathLimit>) -> Self {
        self.limits.add(limit);
        self
    }

    /// Returns the share of the path's steps that are planned, 0 to 1.
    #[must_use]
    pub fn progress(&self) -> f64 {
        self.step as f64 / self.path.steps().len().max(1) as f64
    }
}

impl Planner {
    /// Plans `steps`, each of which must be a move, and adds their pieces (segments with times) to
    /// `section`, which must have no pieces yet.
    ///
    /// A section with further limits is planned without them first, for a numerical reason: with
    /// further limits, the solver uses a finer mesh and more constraints, so that even limits that
    /// are never reached change the last digits. A section in which no further limit is active has
    /// to equal the plan without them to the last bit.
    fn plan_moves(
        &mut self,
        steps: Range<usize>,
        section: &mut Section,
    ) -> Result<(), TimingError> {
        let limits = self.limits.of_steps(&section.path, steps.clone());
        self.sweep(&[], steps.clone(), section)?;
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
        self.sweep(&limits, steps, &mut limited)?;
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
        &mut self,
        limits: &[StepLimits],
        steps: Range<usize>,
        section: &mut Section,
    ) -> Result<(), TimingError> {
        let moves = Moves { steps, ends: [None; 2], limits };
        sweep_moves(&moves, &mut self.scratch, &self.stop, section)
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

impl Iterator for Planner {
    type Item = Result<Section, TimingError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.step == self.path.steps().len() {
            return None;
        }
        let planned = self.plan_section();
        // The iterator ends after an error.
        if planned.is_err() {
            self.step = self.path.steps().len();
        }
        Some(planned)
    }
}

impl Planner {
    /// Plans the moves up to the next stop, and the standstill there.
    fn plan_section(&mut self) -> Result<Section, TimingError> {
        let first = self.step;
        if first == 0 {
            // Once, before the caller gets any section of the path.
            self.limits.check(&self.path)?;
        }
        let overlaps = !self.path.overlapping_waits().is_empty();
        let moves_end =
            first + self.path.steps()[first..].iter().take_while(|step| step.moves()).count();
        let (mut section, stop_step) = if overlaps {
            self.plan_known_moves(first..moves_end)?
        } else {
            (self.plan_to(first..moves_end)?, moves_end)
        };
        let steps = &self.path.steps()[stop_step..];
        let end = stop_step + steps.iter().take_while(|step| !step.moves()).count();
        let still_s = self.still_s();
        if overlaps {
            let mut standing = Standing { still_s, clock: &mut self.clock };
            if stop_step < moves_end {
                standing.rest_before_blend(&mut section, stop_step);
            } else {
                standing.rest(&mut section, stop_step..end);
            }
        } else {
            for step in stop_step..end {
                section.rest(step, still_s);
            }
        }
        self.step = end;
        self.time_s = section.end_s();
        self.rest_rad = section.rest_rad;
        Ok(section)
    }

    /// Returns the duration of a motion without displacement, in s: `least_cruise_s` under
    /// Sunrise's timing, otherwise 0.
    fn still_s(&self) -> f64 {
        match self.jerk {
            Some(JerkTiming { sunrise: true, .. }) => self.path.ramp_law().least_cruise_s,
            _ => 0.0,
        }
    }

    /// Plans the section of these moves, without the standstill after them.
    fn plan_to(&mut self, moves: Range<usize>) -> Result<Section, TimingError> {
        let mut section = Section {
            path: self.path.clone(),
            start_s: self.time_s,
            rest_rad: match self.path.steps()[moves.clone()].last() {
                Some(Step::Move { segment, .. }) => segment.at(1.0).q,
                _ => self.rest_rad,
            },
            pieces: Vec::with_capacity(moves.len() + 1),
            nodes: Vec::new(),
            late_blend: None,
        };
        match self.unsupervised {
            None => self.plan_moves(moves, &mut section)?,
            Some((ref unsupervised, speed_m_s)) => {
                section.path = unsupervised.clone();
                self.plan_moves(moves, &mut section)?;
                section.hold_speed(speed_m_s);
                section.path = self.path.clone();
            }
        }
        Ok(section)
    }

    /// Plans these moves up to the first blend whose next motion becomes known too late; the robot
    /// stops before that blend. If all motions are known in time, plans all of them. Returns the
    /// section and the step at which it ends.
    ///
    /// Later motions do not change whether a motion is known in time, and planning all of them for
    /// each decision would take time proportional to the square of the number of moves. Therefore
    /// the plan starts short, and its length doubles as long as all motions are known in time.
    fn plan_known_moves(&mut self, moves: Range<usize>) -> Result<(Section, usize), TimingError> {
        /// Minimum number of blends that are planned beyond those known to be in time.
        const AHEAD: usize = 2;
        let delays = |step: &usize| {
            waits_before_blend(&self.path, *step).iter().any(|wait| wait.seconds > 0.0)
        };
        // The first move needs no decision, because the section begins at rest. It is a blend if
        // the previous section stopped before a blend whose next motion came too late.
        let blends: Vec<usize> = (moves.start + 1..moves.end).filter(delays).collect();
        let mut in_time = 0;
        // Largest `needed_s` of the blends decided so far, in s.
        let mut needed_before_s = f64::NEG_INFINITY;
        loop {
            let end = blends.get(in_time + in_time.max(AHEAD)).copied().unwrap_or(moves.end);
            let section = self.plan_to(moves.start..end)?;
            self.clock.note(&section);
            while let Some(blend) = blends.get(in_time).copied().filter(|blend| *blend < end) {
                let known_s = self.clock.known_s(waits_before_blend(&self.path, blend));
                // Each blend has a deadline: the latest time at which the arm can begin to brake to
                // stop at the start of the blend. No blend has an earlier deadline than a preceding
                // blend. A motion that is known before `needed_before_s` is therefore in time, and
                // no plan with a stop is necessary.
                let is_in_time = known_s <= needed_before_s - PLANS_DIFFER_S;
                let decided = if is_in_time {
                    Decided::InTime { needed_s: needed_before_s }
                } else {
                    self.decide(blend, known_s, &section)?
                };
                if let Decided::InTime { needed_s } = decided {
                    needed_before_s = needed_before_s.max(needed_s);
                }
                if let Decided::TooLate(mut stopped) = decided {
                    // With the stop, motions may begin some nanoseconds earlier or later than
                    // without it.
                    self.clock.note(&stopped);
                    let known_s = self.clock.known_s(waits_before_blend(&self.path, blend));
                    if let Some(late) = &mut stopped.late_blend {
                        late.known_s = known_s;
                    }
                    return Ok((*stopped, blend));
                }
                self.clock.go_through(known_s);
                in_time += 1;
            }
            if end == moves.end {
                return Ok((section, end));
            }
        }
    }

    /// Decides whether the robot has to stop before the step `blend`, given that the next motion is
    /// known only at `known_s`. `section` is a plan that continues through this blend.
    fn decide(
        &mut self,
        blend: usize,
        known_s: f64,
        section: &Section,
    ) -> Result<Decided, TimingError> {
        // Result of the two early returns below: they do not compute the latest time for sending
        // the motion, so that its lower bound is negative infinity.
        let in_time = Decided::InTime { needed_s: f64::NEG_INFINITY };
        let Some(piece) = section.pieces.iter().position(|piece| piece.step == blend) else {
            return Ok(in_time);
        };
        if is_early(section, piece, known_s, &self.limits) {
            return Ok(in_time);
        }
        let first = section.pieces[0].step;
        let mut stopped = self.plan_to(first..blend)?;
        let needed_s = needed_s(section, &stopped);
        if known_s <= needed_s {
            return Ok(Decided::InTime { needed_s });
        }
        if let Step::Move { blend: Some(corner), .. } = &self.path.steps()[blend] {
            stopped.late_blend = Some(LateBlend { after_motion: corner.motion, known_s, needed_s });
        }
        Ok(Decided::TooLate(Box::new(stopped)))
    }
}
