//! A plan that follows its program when that changes.

use std::{ops::Range, sync::atomic::AtomicBool};

use iiwa_kin::Robot;
use iiwa_path::{JointPath, PathOptions, Step};
use iiwa_program::{Motion, MotionIndex, Program};

use crate::{
    batch::PlanError,
    interval::later,
    jerk::{self, JerkTiming, Pieces, Stamps},
    limit_usage::LimitUsage,
    node::Node,
    path_limits::PathLimits,
    section::{Piece, Section, pause_s},
    section_sweep::{Moves, SAMPLES_BEFORE_JERK, SweepScratch, sweep_moves},
    timing::{JerkOptions, Timing, TimingError},
    trajectory::Trajectory,
};

/// Keeps the jerk-limited plan of a program whose motions are changed one at a time, as optimisers do: what is far
/// from the change stays as it was, so that the time does not depend on the length of the program.
///
/// The fastest way through a program is local: a target that moves changes its own lines and blends much, those next to
/// them by some microseconds, and all others not at all (docs/solver.md has figures). A program in which waits overlap motions
/// is planned anew from its first motion to its last.
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
/// // At which angle of the elbow does the arm pass by soonest?
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
    /// One for each step of the path.
    plans: Vec<StepPlan>,
    limits: PathLimits,
    scratch: SweepScratch,
    /// The plan of a program in which waits overlap motions: what one of these needs may delay all that follows.
    whole: Option<Trajectory>,
}

/// How a step of the path is gone through.
#[derive(Clone, Debug, Default)]
struct StepPlan {
    duration_s: f64,
    /// The stamps of a move, from its start; else none.
    nodes: Vec<Node>,
    usage: LimitUsage,
}

/// Steps beyond them from which the acceleration-limited stamps start that the solver starts from.
const BEFORE: usize = 4;

/// By which factor more is planned anew when there is no way that fits to the rest.
const MORE: usize = 4;

impl Replanner {
    /// Plans `program` on `robot`.
    ///
    /// # Errors
    ///
    /// As [`JointPath::with_options`] and [`Trajectory::plan`].
    pub fn new(
        program: Program,
        robot: &Robot,
        path_options: PathOptions,
        options: JerkOptions,
    ) -> Result<Self, PlanError> {
        let path = JointPath::with_options(&program, robot, path_options)?;
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

    /// The program as it is now.
    #[must_use]
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// The path as it is now.
    #[must_use]
    pub fn path(&self) -> &JointPath {
        self.whole.as_ref().map_or(&self.path, Trajectory::path)
    }

    /// From the start to the end of the last settling, in s.
    #[must_use]
    pub fn cycle_time_s(&self) -> f64 {
        match &self.whole {
            Some(whole) => whole.cycle_time_s(),
            None => self.plans.iter().map(|plan| plan.duration_s).sum(),
        }
    }

    /// Puts `new` in the place of a motion: with another target, other limits or another blend, or a wait.
    ///
    /// The cycle time comes as near to that of [`Trajectory::plan`] as the solver comes to the optimum, most often to some
    /// 1e-5 s.
    ///
    /// # Errors
    ///
    /// If the robot cannot do it, or no stamps are found. All is then as it was before.
    ///
    /// # Panics
    ///
    /// If the program has no such motion.
    pub fn replace(&mut self, motion: MotionIndex, new: Motion) -> Result<(), PlanError> {
        let limits = self.path.limits()[motion.index()];
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
        let blank = replaced.after.clone().map(|_| StepPlan::default());
        let before: Vec<_> = self.plans.splice(replaced.before, blank).collect();
        // The outermost lines of a change in shape are longer or shorter at their inner ends only; one with other limits
        // is another from end to end.
        let around = usize::from(self.path.limits()[motion.index()] != limits);
        if let Err(error) = self.plan(replaced.after.clone(), around) {
            self.plans.splice(replaced.after, before);
            self.program.motions[motion.index()] = old;
            // It was possible before.
            self.path.update(&self.program, self.path_options, motion)?;
            return Err(error.into());
        }
        Ok(())
    }

    /// The whole trajectory: in time that goes with its length.
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

    /// A section without pieces.
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

    /// Plans all of it anew. If there is an error, the plan is as before.
    fn plan_whole(&mut self) -> Result<(), TimingError> {
        self.whole = Some(Trajectory::plan(&self.path, Timing::Jerk(self.options))?);
        Ok(())
    }

    /// Plans the steps in `changed` and at least `around` steps on either side. If there is an error, all plans are as
    /// before.
    fn plan(&mut self, changed: Range<usize>, around: usize) -> Result<(), TimingError> {
        self.limits.check(&self.path)?;
        let mut found = Vec::new();
        let mut step = changed.start;
        if changed.is_empty() && self.moves(step) {
            // Something between two moves is gone.
            found.push(self.plan_moves(step..step, around)?);
        }
        while step < changed.end {
            let moves = (step..changed.end).take_while(|step| self.moves(*step)).count();
            if moves > 0 {
                found.push(self.plan_moves(step..step + moves, around)?);
                step += moves;
            } else {
                let duration_s = match self.path.steps()[step] {
                    Step::Settle { blocking, .. } => pause_s(self.path.robot(), blocking),
                    Step::Wait { seconds, .. } => seconds,
                    _ => 0.0,
                };
                found.push((step, vec![StepPlan { duration_s, ..StepPlan::default() }]));
                step += 1;
            }
        }
        for (first, plans) in found {
            for (plan, found) in self.plans[first..].iter_mut().zip(plans) {
                *plan = found;
            }
        }
        Ok(())
    }

    /// Whether there is a step at `step` that moves the arm.
    fn moves(&self, step: usize) -> bool {
        self.path.steps().get(step).is_some_and(Step::moves)
    }

    /// Whether the step at `step` is a line.
    fn is_straight(&self, step: usize) -> bool {
        match &self.path.steps()[step] {
            Step::Move { segment, .. } => segment.is_straight(),
            _ => false,
        }
    }

    /// `moves` and at least `count` more on either side, as far as there is no stop, from a line to a line: where a curve
    /// begins, the arm has slowed down for it already.
    fn around(&self, moves: &Range<usize>, count: usize) -> Range<usize> {
        let Range { mut start, mut end } = *moves;
        let mut left = count;
        while start > 0 && self.moves(start - 1) && (left > 0 || !self.is_straight(start)) {
            start -= 1;
            left = left.saturating_sub(1);
        }
        let mut left = count;
        while self.moves(end) && (left > 0 || end == 0 || !self.is_straight(end - 1)) {
            end += 1;
            left = left.saturating_sub(1);
        }
        start..end
    }

    /// Plans for moves that follow each other without a stop, `count` around them, or as many more as it takes to fit to
    /// the rest: the first step, and a plan for each.
    fn plan_moves(
        &mut self,
        moves: Range<usize>,
        mut count: usize,
    ) -> Result<(usize, Vec<StepPlan>), TimingError> {
        loop {
            let window = self.around(&moves, count);
            match self.plan_window(&window) {
                Ok(plans) => return Ok((window.start, plans)),
                Err(error) if self.around(&window, 1) == window => return Err(error),
                Err(_) => count = MORE * count.max(1),
            }
        }
    }

    /// Plans for the moves of `window`, from and to the states in which the moves beside it end and begin.
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

    /// The state in which the step at `step` begins: the square of the speed along the path and its derivative by the
    /// way; none at rest.
    fn state(&self, step: usize) -> Option<[f64; 2]> {
        if step == 0 || !self.moves(step - 1) || !self.moves(step) {
            return None;
        }
        // One of both is not planned anew.
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
    /// Those of the segments of `stamps`, in order.
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

    /// Adds it to `section`, in which it is the next.
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
