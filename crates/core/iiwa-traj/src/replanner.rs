//! Incremental planning of a program that changes.

use std::{ops::Range, sync::atomic::AtomicBool};

use iiwa_kin::Robot;
use iiwa_path::{JointPath, PathOptions, ReplacedSteps, Step};
use iiwa_program::{Motion, MotionIndex, Program};

use crate::{
    batch::PlanError,
    interval::{Node, later},
    jerk::{self, JerkTiming, Pieces, Stamps},
    limit_usage::LimitUsage,
    path_limits::PathLimits,
    section::{Piece, Section, pause_s},
    section_sweep::{Moves, SAMPLES_BEFORE_JERK, SweepScratch, sweep_moves},
    timing::{JerkOptions, Timing, TimingError},
    trajectory::Trajectory,
};

/// Keeps the jerk-limited plan of a program whose motions are changed one at a time, as by
/// optimisers. The plan far from a change is reused, so that the computing time does not depend on
/// the length of the program.
///
/// The fastest motion through a program is local: a changed target has a large effect on its own
/// lines and blends, changes those next to them by some microseconds, and all others not at all
/// (docs/solver.md has figures). A program in which waits overlap motions is planned anew as a
/// whole.
///
/// ```
/// use iiwa_kin::Robot;
/// use iiwa_path::PathOptions;
/// use iiwa_program::{Blend, Motion, MotionIndex, Program, Ptp};
/// use iiwa_traj::{JerkOptions, Replanner};
///
/// let program = Program::from_deg([0.0; 7])
///     .ptp_deg([40.0, 0.0, 0.0, -60.0, 0.0, 0.0, 0.0])
///     .blend(Blend::Fraction(0.3))
///     .ptp_deg([40.0, 30.0, 0.0, -30.0, 0.0, 0.0, 0.0])
///     .build();
/// let mut plan =
///     Replanner::new(program, &Robot::default(), PathOptions::default(), JerkOptions::default())?;
/// let before_s = plan.cycle_time_s();
///
/// // Search for the elbow angle with the shortest cycle time.
/// let corner = MotionIndex::new(0);
/// let Motion::Ptp(ptp) = plan.program().motions[0].clone() else { unreachable!() };
/// for elbow_deg in [-55.0_f64, -45.0, -35.0] {
///     let mut target_rad = ptp.target_rad;
///     target_rad[3] = elbow_deg.to_radians();
///     plan.replace(corner, Motion::Ptp(Ptp { target_rad, ..ptp.clone() }))?;
/// }
/// assert!(plan.cycle_time_s() < before_s);
/// assert!((plan.trajectory().cycle_time_s() - plan.cycle_time_s()).abs() < 1e-9);
/// # Ok::<(), iiwa_traj::PlanError>(())
/// ```
#[derive(Debug)]
pub struct Replanner {
    program: Program,
    path: JointPath,
    path_options: PathOptions,
    options: JerkOptions,
    /// Plan of each step of the path.
    plans: Vec<StepPlan>,
    limits: PathLimits,
    scratch: SweepScratch,
    /// Plan of a program in which waits overlap motions: the time at which one motion is known may
    /// delay all that follow, so that the plan is not local.
    whole: Option<Trajectory>,
}

/// Plan of one step of the path.
#[derive(Clone, Debug, Default)]
struct StepPlan {
    duration_s: f64,
    /// Stamps of a move, from its start; otherwise empty.
    nodes: Vec<Node>,
    usage: LimitUsage,
}

/// Steps beyond the window at which the sweep starts, so that its acceleration-limited stamps in
/// the window hardly depend on the ends.
const BEFORE: usize = 4;

/// Factor by which the window grows if there is no feasible motion between its given end states.
const MORE: usize = 4;

impl Replanner {
    /// Plans `program` on `robot`.
    ///
    /// # Errors
    ///
    /// The errors of [`JointPath::with_options`] and [`Trajectory::plan`].
    pub fn new(
        program: Program,
        robot: &Robot,
        path_options: PathOptions,
        options: JerkOptions,
    ) -> Result<Self, PlanError> {
        let mut path = JointPath::with_options(&program, robot, path_options)?;
        path.prepare_updates(&program)?;
        let steps = path.steps().len();
        let mut replanner = Self {
            program,
            path,
            path_options,
            options,
            plans: vec![StepPlan::default(); steps],
            limits: PathLimits::default(),
            scratch: SweepScratch::new(SAMPLES_BEFORE_JERK),
            whole: None,
        };
        if replanner.path.overlapping_waits().is_empty() {
            replanner.plan(0..steps, 0)?;
        } else {
            replanner.plan_whole()?;
        }
        Ok(replanner)
    }

    /// Returns the current program.
    #[must_use]
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// Returns the current path.
    #[must_use]
    pub fn path(&self) -> &JointPath {
        self.whole.as_ref().map_or(&self.path, Trajectory::path)
    }

    /// Returns the time from the start to the end of the last settling, in s.
    #[must_use]
    pub fn cycle_time_s(&self) -> f64 {
        match &self.whole {
            Some(whole) => whole.cycle_time_s(),
            None => self.plans.iter().map(|plan| plan.duration_s).sum(),
        }
    }

    /// Replaces a motion by `new`: with another target, other limits or another blend, or by a
    /// wait.
    ///
    /// The cycle time differs from that of [`Trajectory::plan`] as plans differ from the optimum,
    /// most often by some 1e-5 s.
    ///
    /// # Errors
    ///
    /// If the robot cannot execute the program, or time parameterisation fails. The plan is then
    /// unchanged.
    ///
    /// # Panics
    ///
    /// If the program has no such motion.
    pub fn replace(&mut self, motion: MotionIndex, new: Motion) -> Result<(), PlanError> {
        let limits = self.path.limits()[motion.index()];
        let is_load = [&self.program.motions[motion.index()], &new]
            .into_iter()
            .any(|entry| matches!(entry, Motion::Load(_)));
        let old = std::mem::replace(&mut self.program.motions[motion.index()], new);
        let replaced = match self.path.update(&self.program, self.path_options, motion) {
            Ok(replaced) => replaced,
            Err(fault) => {
                self.program.motions[motion.index()] = old;
                return Err(fault.into());
            }
        };
        if self.whole.is_some() || !self.path.overlapping_waits().is_empty() {
            if let Err(error) = self.plan_whole() {
                self.program.motions[motion.index()] = old;
                self.path.update(&self.program, self.path_options, motion)?;
                return Err(error.into());
            }
            return Ok(());
        }
        // Another payload changes the torques of all motions after it.
        let replaced = match self.path.torque_limit_rel() {
            Some(_) if is_load => {
                ReplacedSteps { before: 0..self.plans.len(), after: 0..self.path.steps().len() }
            }
            _ => replaced,
        };
        // Without nodes: `state` then reads the states at both ends from the unchanged neighbours.
        let blank = replaced.after.clone().map(|_| StepPlan::default());
        let before: Vec<_> = self.plans.splice(replaced.before, blank).collect();
        // After a change in shape, the outermost lines are longer or shorter at their inner ends
        // only, so that their outer ends can be kept. New limits apply to a line from end to end.
        let around = usize::from(self.path.limits()[motion.index()] != limits);
        if let Err(error) = self.plan(replaced.after.clone(), around) {
            self.plans.splice(replaced.after, before);
            self.program.motions[motion.index()] = old;
            // Restores the old path, which was feasible, within rounding.
            self.path.update(&self.program, self.path_options, motion)?;
            return Err(error.into());
        }
        Ok(())
    }

    /// Returns the whole trajectory, in time proportional to its length.
    #[must_use]
    pub fn trajectory(&self) -> Trajectory {
        if let Some(whole) = &self.whole {
            return whole.clone();
        }
        let mut sections = Vec::new();
        let mut section = self.section(0.0);
        for (step, plan) in self.plans.iter().enumerate() {
            let rests = plan.nodes.is_empty();
            if !rests && step > 0 && !self.moves(step - 1) {
                let next = self.section(section.end_s());
                sections.push(std::mem::replace(&mut section, next));
            }
            if rests {
                section.rest(step, 0.0);
            } else {
                plan.add_to(&mut section, step);
            }
        }
        sections.push(section);
        Trajectory::from_sections(self.path.clone(), sections)
    }

    /// Creates a section without pieces.
    fn section(&self, start_s: f64) -> Section {
        Section {
            path: self.path.clone(),
            start_s,
            rest_rad: *self.path.start_rad(),
            pieces: Vec::new(),
            nodes: Vec::new(),
            late_blend: None,
        }
    }

    /// Plans the whole program anew. On errors, the plan is unchanged.
    fn plan_whole(&mut self) -> Result<(), TimingError> {
        self.whole = Some(Trajectory::plan(&self.path, Timing::Jerk(self.options))?);
        Ok(())
    }

    /// Plans the steps in `changed` and at least `around` steps on either side. On errors, all
    /// plans are unchanged.
    fn plan(&mut self, changed: Range<usize>, around: usize) -> Result<(), TimingError> {
        self.limits.check(&self.path)?;
        let mut sections = Vec::new();
        let mut step = changed.start;
        if changed.is_empty() && self.moves(step) {
            // A rest between two moves was removed: the moves now join.
            sections.push(self.plan_moves(step..step, around)?);
        }
        while step < changed.end {
            let moves = (step..changed.end).take_while(|step| self.moves(*step)).count();
            if moves > 0 {
                sections.push(self.plan_moves(step..step + moves, around)?);
                step += moves;
            } else {
                let duration_s = match self.path.steps()[step] {
                    Step::Settle { blocking, .. } => pause_s(self.path.robot(), blocking),
                    Step::Wait { seconds, .. } => seconds,
                    _ => 0.0,
                };
                sections.push((step, vec![StepPlan { duration_s, ..StepPlan::default() }]));
                step += 1;
            }
        }
        // Stored after all windows have been solved: an error leaves all plans unchanged.
        for (first, plans) in sections {
            for (plan, sections) in self.plans[first..].iter_mut().zip(plans) {
                *plan = sections;
            }
        }
        Ok(())
    }

    /// Returns true if there is a step at `step` that moves the robot.
    fn moves(&self, step: usize) -> bool {
        self.path.steps().get(step).is_some_and(Step::moves)
    }

    /// Returns true if the step at `step` is a line.
    fn is_straight(&self, step: usize) -> bool {
        match &self.path.steps()[step] {
            Step::Move { segment, .. } => segment.is_straight(),
            _ => false,
        }
    }

    /// Extends `moves` by at least `count` steps on either side, up to the next stop, such that the
    /// result begins and ends with a line: at the start of a curve, the robot has already slowed
    /// down for it.
    fn around(&self, moves: &Range<usize>, count: usize) -> Range<usize> {
        let Range { mut start, mut end } = *moves;
        let mut remaining = count;
        while start > 0 && self.moves(start - 1) && (remaining > 0 || !self.is_straight(start)) {
            start -= 1;
            remaining = remaining.saturating_sub(1);
        }
        let mut remaining = count;
        while self.moves(end) && (remaining > 0 || end == 0 || !self.is_straight(end - 1)) {
            end += 1;
            remaining = remaining.saturating_sub(1);
        }
        start..end
    }

    /// Plans consecutive moves without a stop, with `count` steps around them, or as many more as a
    /// feasible connection to the rest of the plan takes. Returns the first step and a plan for
    /// each step.
    fn plan_moves(
        &mut self,
        moves: Range<usize>,
        mut count: usize,
    ) -> Result<(usize, Vec<StepPlan>), TimingError> {
        loop {
            let window = self.around(&moves, count);
            match self.plan_window(&window) {
                Ok(plans) => return Ok((window.start, plans)),
                // The window already extends from stop to stop.
                Err(error) if self.around(&window, 1) == window => return Err(error),
                Err(_) => count = MORE * count.max(1),
            }
        }
    }

    /// Plans the moves of `window`, between the states at which the adjacent moves end and begin.
    fn plan_window(&mut self, window: &Range<usize>) -> Result<Vec<StepPlan>, TimingError> {
        let stop = AtomicBool::new(false);
        let swept = self.around(window, BEFORE);
        let ends = [swept.start, swept.end].map(|step| self.state(step).map(|[square, _]| square));
        let mut section = self.section(0.0);
        let limits = &self.limits.of_steps(&self.path, swept.clone());
        let moves = Moves { steps: swept.clone(), ends, limits };
        sweep_moves(&moves, &mut self.scratch, &stop, &mut section)?;
        let pieces = Pieces {
            range: window.start - swept.start..window.end - swept.start,
            ends: [window.start, window.end].map(|step| self.state(step)),
            limits,
        };
        Ok(StepPlan::of(jerk::stamps(
            &mut section,
            &pieces,
            JerkTiming { options: self.options, sunrise: false },
            &stop,
        )?))
    }

    /// Returns the state at the start of the step at `step`: the squared speed along the path and
    /// its derivative with respect to the way; none at rest.
    fn state(&self, step: usize) -> Option<[f64; 2]> {
        if step == 0 || !self.moves(step - 1) || !self.moves(step) {
            return None;
        }
        // At most one of both steps lacks a plan: the other one holds the state.
        let node = |step: usize, node: Option<&Node>| {
            let Step::Move { segment, .. } = &self.path.steps()[step] else { return None };
            let length = segment.sigma_length_rad();
            let Node { rate, u, .. } = node?;
            Some([(rate * length).powi(2), 2.0 * u[0] * length])
        };
        let before = node(step - 1, self.plans[step - 1].nodes.last());
        before.or_else(|| node(step, self.plans[step].nodes.first()))
    }
}

impl StepPlan {
    /// Creates the plans of the segments of `stamps`, in order.
    fn of(stamps: Stamps) -> Vec<Self> {
        let Stamps { nodes, segments } = stamps;
        let plan = |stamps: &jerk::SegmentStamps| {
            let mut nodes = nodes[stamps.nodes.clone()].to_vec();
            let start_s = nodes[0].t_s;
            for node in &mut nodes {
                node.t_s -= start_s;
            }
            let duration_s = nodes[nodes.len() - 1].t_s;
            Self { duration_s, nodes, usage: stamps.usage.clone() }
        };
        segments.iter().map(plan).collect()
    }

    /// Appends the plan to `section`.
    fn add_to(&self, section: &mut Section, step: usize) {
        let first = section.nodes.len();
        let mut t_s = section.nodes.last().map_or(0.0, |node| node.t_s);
        let start_s = t_s;
        for node in &self.nodes {
            section.nodes.push(Node { t_s, ..*node });
            if node.dt_s > 0.0 {
                t_s = later(section.start_s, t_s, node.dt_s);
            }
        }
        let nodes = first..section.nodes.len();
        let Some(piece) = Piece::moving(section, step, [start_s, t_s], &self.usage, nodes) else {
            return;
        };
        if let Step::Move { segment, .. } = &section.path.steps()[step] {
            section.rest_rad = segment.at(1.0).q;
        }
        section.pieces.push(piece);
    }
}
