//! Time parameterisation of a path, one section at a time. A section is the part of the path from
//! one stop to the next.

use std::{
    num::NonZero,
    ops::Range,
    sync::{Arc, atomic::AtomicBool},
    thread,
};

use iiwa_kin::Joints;
use iiwa_path::{JointPath, Step};

use crate::{
    known_in_time::{is_early, needed_s},
    overlapping_waits::{ProgramClock, Standing, waits_before_blend},
    path_limit::PathLimit,
    planned_ahead::PlannedAhead,
    section::{LateBlend, Section},
    section_planner::SectionPlanner,
    section_sweep::SweepScratch,
    timing::{Timing, TimingError},
};

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

/// Iterator that plans a path section by section. Sections are planned shortly before the caller
/// asks for them, and are not kept. The sections of long paths are planned on all cores.
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
///     // Write, send or drop the section.
///     cycle_time_s = section?.end_s();
/// }
/// assert!(cycle_time_s > 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Planner {
    sections: SectionPlanner,
    timing: Timing,
    /// Number of threads, if the caller has chosen it.
    threads: Option<usize>,
    /// Sections that other threads plan; `None` before the first section of a path, and if all
    /// sections are planned on the caller's thread.
    ahead: Option<PlannedAhead>,
    /// Index of the next step of the path.
    step: usize,
    /// `true` if the further limits were found to allow the path at rest.
    is_checked: bool,
    time_s: f64,
    /// Joint positions at the last stop, in rad.
    rest_rad: Joints,
    /// Times at which the program sends the motions after overlapping waits.
    clock: ProgramClock,
    /// Buffers of the sweep (the backward and forward pass under velocity and acceleration limits).
    scratch: SweepScratch,
}

impl Planner {
    /// Creates a planner for `path`.
    #[must_use]
    pub fn new(path: &JointPath, timing: Timing) -> Self {
        let sections = SectionPlanner::new(path, timing);
        Self {
            scratch: sections.scratch(),
            sections,
            timing,
            threads: None,
            ahead: None,
            step: 0,
            is_checked: false,
            time_s: 0.0,
            rest_rad: *path.start_rad(),
            clock: ProgramClock::default(),
        }
    }

    /// Returns the path.
    #[must_use]
    pub fn path(&self) -> &JointPath {
        &self.sections.path
    }

    /// Returns the timing.
    #[must_use]
    pub fn timing(&self) -> Timing {
        self.timing
    }

    /// Restarts with `path`, under the same timing and limits. The memory of the planner is reused,
    /// which for many programs is faster than a new planner for each.
    pub fn restart(&mut self, path: &JointPath) {
        self.sections.set_path(path);
        self.ahead = None;
        self.rest_rad = *path.start_rad();
        (self.step, self.time_s, self.is_checked) = (0, 0.0, false);
        self.clock = ProgramClock::default();
    }

    /// Continues at another step of the path, the first after a standstill; the next section then
    /// begins at time 0. For programs in which waits overlap motions, this is of no use: their
    /// sections depend on those before.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_path::JointPath;
    /// use iiwa_program::Program;
    /// use iiwa_traj::{Planner, Timing};
    ///
    /// let program = Program::from_deg([0.0; 7])
    ///     .ptp_deg([40.0, 0.0, 0.0, -60.0, 0.0, 0.0, 0.0])
    ///     .ptp_deg([0.0; 7])
    ///     .build();
    /// let path = JointPath::new(&program, &Robot::default())?;
    /// let mut planner = Planner::new(&path, Timing::default());
    /// let first = planner.next().ok_or("no section")??;
    /// let second_step = planner.step();
    /// planner.restart(&path);
    /// planner.skip_to(second_step);
    /// let second = planner.next().ok_or("no section")??;
    /// assert_eq!(second.start_s(), 0.0);
    /// assert_eq!(planner.step(), path.steps().len());
    /// # let _ = first;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn skip_to(&mut self, step: usize) {
        (self.step, self.time_s) = (step, 0.0);
        self.ahead = None;
    }

    /// Returns the step at which the next section begins; after the last section, the number of
    /// steps.
    #[must_use]
    pub fn step(&self) -> usize {
        self.step
    }

    /// Uses `stop` as the flag that interrupts planning. Soon after the caller has set the flag to
    /// true, planning ends with [`TimingError::Interrupted`], even in the middle of a section.
    #[must_use]
    pub fn interrupted_by(mut self, stop: Arc<AtomicBool>) -> Self {
        self.sections.stop = stop;
        self.ahead = None;
        self
    }

    /// Sets the number of threads that plan the sections of a long path under jerk limits. The
    /// default is one per core, or only the caller's thread if the caller runs in a rayon pool (its
    /// other threads have work of their own). The result does not depend on the number of threads.
    #[must_use]
    pub fn with_threads(mut self, threads: usize) -> Self {
        self.threads = Some(threads);
        self.ahead = None;
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
        self.sections.limits.add(limit);
        self.ahead = None;
        self
    }

    /// Returns the share of the path's steps that are planned, 0 to 1.
    #[must_use]
    pub fn progress(&self) -> f64 {
        self.step as f64 / self.sections.path.steps().len().max(1) as f64
    }
}

impl Iterator for Planner {
    type Item = Result<Section, TimingError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.step == self.sections.path.steps().len() {
            return None;
        }
        let planned = self.plan_section();
        // The iterator ends after an error.
        if planned.is_err() {
            self.step = self.sections.path.steps().len();
        }
        if self.step == self.sections.path.steps().len() {
            self.ahead = None;
        }
        Some(planned)
    }
}

impl Planner {
    /// Plans the moves up to the next stop, and the standstill there.
    fn plan_section(&mut self) -> Result<Section, TimingError> {
        let first = self.step;
        // Once, before the caller gets any section of the path.
        if !self.is_checked {
            self.sections.limits.check(&self.sections.path)?;
            self.is_checked = true;
        }
        if first == 0 {
            self.start_ahead();
        }
        let overlaps = self.overlaps();
        let moves = self.sections.moves_from(first);
        let moves_end = moves.end;
        let (mut section, stop_step) = if overlaps {
            self.plan_known_moves(moves)?
        } else {
            (self.plan_to_stop(moves)?, moves_end)
        };
        let rests = self.sections.rests_from(stop_step);
        let end = rests.end;
        let still_s = self.sections.still_s();
        if overlaps {
            let mut standing = Standing { still_s, clock: &mut self.clock };
            if stop_step < moves_end {
                standing.rest_before_blend(&mut section, stop_step);
            } else {
                standing.rest(&mut section, rests);
            }
        } else {
            for step in rests {
                section.rest(step, still_s);
            }
        }
        self.step = end;
        self.time_s = section.end_s();
        self.rest_rad = section.rest_rad;
        Ok(section)
    }

    /// Returns true if waits overlap motions. In this case, the plan of a section depends on the
    /// times of the preceding sections.
    fn overlaps(&self) -> bool {
        !self.sections.path.overlapping_waits().is_empty()
    }

    /// Lets other threads plan the sections, if that is of use.
    fn start_ahead(&mut self) {
        let threads = || match self.threads {
            Some(threads) => threads,
            None if rayon::current_thread_index().is_some() => 1,
            None => thread::available_parallelism().map_or(1, NonZero::get),
        };
        self.ahead = if self.sections.limits_jerk() && !self.overlaps() {
            PlannedAhead::new(&self.sections, threads)
        } else {
            None
        };
    }

    /// Plans the section of these moves up to the next stop of the path, without the standstill
    /// there, or takes it from the thread that has planned it.
    fn plan_to_stop(&mut self, moves: Range<usize>) -> Result<Section, TimingError> {
        let ahead = self.ahead.as_mut().filter(|_| !moves.is_empty());
        match ahead.and_then(|ahead| ahead.take(&self.sections, &moves)) {
            Some(section) => Ok(self.placed(section?)),
            None => self.plan_to(moves),
        }
    }

    /// Plans the section of these moves, without the standstill after them.
    fn plan_to(&mut self, moves: Range<usize>) -> Result<Section, TimingError> {
        let section = self.sections.plan(moves, &mut self.scratch)?;
        Ok(self.placed(section))
    }

    /// Shifts a planned section in time, so that it begins at the end of the preceding section.
    fn placed(&self, mut section: Section) -> Section {
        section.place(self.time_s);
        if section.pieces.is_empty() {
            section.rest_rad = self.rest_rad;
        }
        section
    }

    /// Plans these moves up to the first blend whose next motion becomes known too late; the robot
    /// stops before that blend. If all motions are known in time, plans all of them. Returns the
    /// section and the step at which it ends.
    ///
    /// Later motions do not change whether a motion is known in time, and planning all of them for
    /// each decision would take time proportional to the square of the number of moves. Therefore
    /// the plan starts short, and its length doubles as long as all motions are known in time.
    fn plan_known_moves(&mut self, moves: Range<usize>) -> Result<(Section, usize), TimingError> {
        /// Minimum number of blends that are planned in addition to those already decided to be in
        /// time.
        const AHEAD: usize = 2;
        let delays = |step: &usize| {
            waits_before_blend(&self.sections.path, *step).iter().any(|wait| wait.seconds > 0.0)
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
                let known_s = self.clock.known_s(waits_before_blend(&self.sections.path, blend));
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
                    let known_s =
                        self.clock.known_s(waits_before_blend(&self.sections.path, blend));
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
        // Result of the two early returns below. They do not compute the latest time at which the
        // program may send the motion; its lower bound `needed_s` is therefore negative infinity.
        let in_time = Decided::InTime { needed_s: f64::NEG_INFINITY };
        let Some(piece) = section.pieces.iter().position(|piece| piece.step == blend) else {
            return Ok(in_time);
        };
        if is_early(section, piece, known_s, &self.sections.limits) {
            return Ok(in_time);
        }
        let first = section.pieces[0].step;
        let mut stopped = self.plan_to(first..blend)?;
        let needed_s = needed_s(section, &stopped);
        if known_s <= needed_s {
            return Ok(Decided::InTime { needed_s });
        }
        if let Step::Move { blend: Some(corner), .. } = &self.sections.path.steps()[blend] {
            stopped.late_blend = Some(LateBlend { after_motion: corner.motion, known_s, needed_s });
        }
        Ok(Decided::TooLate(Box::new(stopped)))
    }
}
