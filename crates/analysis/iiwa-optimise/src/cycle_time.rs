//! Exact cycle times of the versions of a program.

use std::sync::{
    Arc,
    atomic::{AtomicBool, AtomicU64, Ordering::Relaxed},
};

use iiwa_kin::{Joints, Robot};
use iiwa_path::{JointPath, ReplacedSteps, Step};
use iiwa_plan::{PlanOptions, section_assumptions};
use iiwa_program::{MotionIndex, Program};
use iiwa_traj::{PlanError, Planner, Timing, TimingError, Trajectory};

use crate::change::Change;

/// A program as it is, with its path and the durations of its sections.
#[derive(Clone, Debug)]
pub(crate) struct Version {
    pub(crate) program: Program,
    pub(crate) cycle_time_s: f64,
    path: JointPath,
    /// First step of each section.
    starts: Vec<usize>,
    /// Duration of each section, in s.
    durations_s: Vec<f64>,
    /// Assumptions about the controller, each with a motion whose time depends on it.
    assumptions: Vec<(&'static str, MotionIndex)>,
    /// `true` if the timing follows recordings where there are any.
    is_recorded: bool,
}

impl Version {
    /// Assumptions that the times of the motions of a change, and of the next motion, depend on.
    /// Without recordings behind the timing, all assumptions of the plan count.
    pub(crate) fn assumptions_about(&self, change: &Change) -> impl Iterator<Item = &'static str> {
        let after = change.last().index() + 1;
        let moves = |index: &usize| self.program.motions[*index].moves();
        let next = (after..self.program.motions.len()).find(moves).unwrap_or(after);
        let motions = change.first().index()..=next;
        let counts =
            move |motion: MotionIndex| !self.is_recorded || motions.contains(&motion.index());
        self.assumptions.iter().filter(move |(_, motion)| counts(*motion)).map(|(text, _)| *text)
    }
}

/// Planner of changed programs. Sections that a change leaves as they are, are not planned again.
#[derive(Debug)]
pub(crate) struct CycleTimes<'a> {
    robot: &'a Robot,
    options: &'a PlanOptions,
    stop: &'a Arc<AtomicBool>,
    /// Numbers of plans: of this search, and of all searches.
    plans: [&'a AtomicU64; 2],
    planner: Option<Planner>,
}

impl<'a> CycleTimes<'a> {
    pub(crate) fn new(
        robot: &'a Robot,
        options: &'a PlanOptions,
        stop: &'a Arc<AtomicBool>,
        plans: [&'a AtomicU64; 2],
    ) -> Self {
        Self { robot, options, stop, plans, planner: None }
    }

    /// Plans a whole program.
    pub(crate) fn plan(&mut self, program: &Program) -> Result<Trajectory, PlanError> {
        let path = JointPath::on_other_robot(program, self.robot, self.options.path)?;
        Ok(Trajectory::by(self.planner(&path))?)
    }

    /// Returns the cycle time of a program, in s, and its last joint positions, in rad; `None` if
    /// the robot cannot execute it.
    pub(crate) fn end(&mut self, program: &Program) -> Option<(f64, Joints)> {
        let trajectory = self.plan(program).ok()?;
        let cycle_time_s = trajectory.cycle_time_s();
        Some((cycle_time_s, trajectory.at(cycle_time_s).q))
    }

    /// Returns the last joint positions of a program, in rad, without planning its times; `None` if
    /// it has no path.
    pub(crate) fn last_rad(&self, program: &Program) -> Option<Joints> {
        let path = JointPath::on_other_robot(program, self.robot, self.options.path).ok()?;
        let last = path.steps().iter().rev().find_map(|step| match step {
            Step::Move { segment, .. } => Some(segment.at(1.0).q),
            _ => None,
        });
        Some(last.unwrap_or(*path.start_rad()))
    }

    /// Plans a whole program, as the one that changes refer to.
    pub(crate) fn version(&mut self, program: &Program) -> Result<Version, PlanError> {
        let mut path = JointPath::on_other_robot(program, self.robot, self.options.path)?;
        path.prepare_updates(program)?;
        let timing = self.options.timing.name();
        let planner = self.planner(&path);
        let (mut starts, mut durations_s, mut cycle_time_s) = (Vec::new(), Vec::new(), 0.0);
        let mut assumptions = Vec::new();
        loop {
            let start = planner.step();
            let Some(section) = planner.next().transpose()? else { break };
            starts.push(start);
            durations_s.push(section.end_s() - section.start_s());
            cycle_time_s = section.end_s();
            assumptions.extend(section_assumptions(&section, timing));
        }
        let program = program.clone();
        let is_recorded = matches!(self.options.timing, Timing::Sunrise(_));
        Ok(Version { program, cycle_time_s, path, starts, durations_s, assumptions, is_recorded })
    }

    /// Cycle time after changes, in s, and the changed program; `None` if the robot cannot execute
    /// it, or if the search is interrupted.
    pub(crate) fn changed(
        &mut self,
        version: &Version,
        changes: &[&Change],
    ) -> Option<(Program, f64)> {
        if self.stop.load(Relaxed) {
            return None;
        }
        let first = changes.iter().map(|change| change.first()).min()?;
        let last = changes.iter().map(|change| change.last()).max()?;
        let program = changes
            .iter()
            .try_fold(version.program.clone(), |program, change| change.apply(&program))?;
        let mut path = version.path.clone();
        let motions = first..=last;
        let replaced = path.update_all(&program, self.options.path, motions).ok()?;
        let overlaps = !path.overlapping_waits().is_empty();
        let cycle_time_s = if overlaps {
            Trajectory::by(self.planner(&path)).ok()?.cycle_time_s()
        } else {
            self.with_new_sections(version, &path, &replaced).ok()?
        };
        Some((program, cycle_time_s))
    }

    /// Cycle time of a changed path, in s: sections with replaced steps are planned.
    fn with_new_sections(
        &mut self,
        version: &Version,
        path: &JointPath,
        replaced: &ReplacedSteps,
    ) -> Result<f64, TimingError> {
        let Version { starts, durations_s, .. } = version;
        // From the section before the first replaced step: a stop may have become a blend.
        let after = starts.partition_point(|start| *start < replaced.before.start);
        let first = after.saturating_sub(1);
        let planner = self.planner(path);
        planner.skip_to(starts.get(first).copied().unwrap_or(0));
        let mut cycle_time_s: f64 = durations_s[..first].iter().sum();
        loop {
            let step = planner.step();
            // The same step in the path before the change, if it is after the replaced ones.
            let old_step = step.checked_sub(replaced.after.end);
            let old_step = old_step.map(|beyond| replaced.before.end + beyond);
            let kept = old_step.and_then(|old_step| starts.binary_search(&old_step).ok());
            if let Some(kept) = kept {
                return Ok(cycle_time_s + durations_s[kept..].iter().sum::<f64>());
            }
            match planner.next().transpose()? {
                Some(section) => cycle_time_s += section.end_s() - section.start_s(),
                None => return Ok(cycle_time_s),
            }
        }
    }

    /// Returns the planner, at the start of `path`.
    fn planner(&mut self, path: &JointPath) -> &mut Planner {
        for plans in self.plans {
            plans.fetch_add(1, Relaxed);
        }
        match &mut self.planner {
            Some(planner) => {
                planner.restart(path);
                planner
            }
            empty => {
                let planner = Planner::new(path, self.options.timing).with_threads(1);
                empty.insert(planner.interrupted_by(Arc::clone(self.stop)))
            }
        }
    }
}
