//! Search for the order of tasks with the shortest cycle time.

use std::{
    ops::Range,
    sync::atomic::{AtomicU64, Ordering::Relaxed},
};

use iiwa_kin::Joints;
use iiwa_program::{Fault, Motion, Program, Sources, Start, TaskFault, TaskMotions};
use iiwa_traj::{PlanError, Trajectory};
use rayon::prelude::*;

use crate::{
    change_search::LEAST_S, cycle_time::CycleTimes, optimiser::Optimiser, sequence::SequenceTimes,
};

/// Rule that the trajectory of a program has to satisfy whose entries are those of another one, in
/// another order: the last argument has the index there of each entry.
pub type OrderRule<'a> = &'a (dyn Fn(&Program, &Trajectory, &[usize]) -> bool + Sync);

/// Result of a search for an order of tasks.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct OrderedTasks {
    /// Cycle time of the program as it is, in s.
    pub cycle_time_s: f64,
    /// Indices of the tasks in the fastest order that was found; the order of the program if no
    /// other one saves a millisecond.
    pub order: Vec<usize>,
    /// Program with the tasks in this order.
    pub program: Program,
    /// Its cycle time, in s.
    pub changed_cycle_time_s: f64,
    /// `true` if all orders were compared, as if the time of a task depended only on itself and on
    /// the task before it.
    pub is_exact: bool,
    /// Number of plans that were compared.
    pub plans: u64,
}

impl Optimiser {
    /// Searches for the order of the tasks of `program` ([`Program::tasks`]) with the shortest
    /// cycle time. Paths within tasks stay as they are, and the last task stays the last one unless
    /// a point-to-point motion to a position follows it.
    ///
    /// The time of each task is planned after each other one. Up to 16 tasks, all orders are then
    /// compared; of more tasks, the order is improved step by step. The fastest order is planned
    /// exactly.
    ///
    /// # Errors
    ///
    /// If the program cannot be planned as it is, or if the search is interrupted.
    pub fn order(&self, program: &Program) -> Result<OrderedTasks, PlanError> {
        self.ordered(program, None)
    }

    /// As [`order`](Self::order), with only those orders that `rule` accepts.
    ///
    /// # Errors
    ///
    /// As for [`order`](Self::order).
    pub fn order_within(
        &self,
        program: &Program,
        rule: OrderRule<'_>,
    ) -> Result<OrderedTasks, PlanError> {
        self.ordered(program, Some(rule))
    }

    fn ordered(
        &self,
        program: &Program,
        rule: Option<OrderRule<'_>>,
    ) -> Result<OrderedTasks, PlanError> {
        let of_task = |fault: TaskFault| PlanError::from(Fault::Task(fault));
        let tasks = program.tasks().map_err(of_task)?;
        let plans = AtomicU64::new(0);
        let mut times = self.settings.cycle_times(&plans);
        let cycle_time_s = times.plan(program)?.cycle_time_s();
        let given: Vec<usize> = (0..tasks.len()).collect();
        let mut found = OrderedTasks {
            cycle_time_s,
            order: given.clone(),
            program: program.clone(),
            changed_cycle_time_s: cycle_time_s,
            is_exact: true,
            plans: 0,
        };
        let parts = TaskParts { program, tasks: &tasks };
        let mut sequence = self.sequence_times(&parts, &plans);
        self.check_stop()?;
        found.is_exact = given.len() <= SequenceTimes::EXACT_TASKS;
        let allows = |program: &Program, trajectory: &Trajectory, origins: &[usize]| {
            rule.is_none_or(|rule| rule(program, trajectory, origins))
        };
        // If an order is not accepted, those successions that are not are excluded.
        loop {
            let order = if found.is_exact { sequence.fastest() } else { sequence.improved(&given) };
            let Some(order) = order.filter(|order| *order != given) else { break };
            let (changed, origins) = program.with_task_order(&order).map_err(of_task)?;
            let trajectory = times.plan(&changed);
            self.check_stop()?;
            if let Ok(trajectory) = trajectory
                && cycle_time_s - trajectory.cycle_time_s() >= LEAST_S
                && allows(&changed, &trajectory, &origins)
            {
                found.changed_cycle_time_s = trajectory.cycle_time_s();
                (found.order, found.program) = (order, changed);
                break;
            }
            if !parts.exclude(&mut sequence, &order, &mut times, &allows) {
                break;
            }
            self.check_stop()?;
        }
        found.plans = plans.load(Relaxed);
        Ok(found)
    }

    /// Plans each task as the first one, after each other one, and as the last one.
    fn sequence_times(&self, parts: &TaskParts<'_>, plans: &AtomicU64) -> SequenceTimes {
        let count = parts.tasks.len();
        let all = (0..count).into_par_iter().map_init(
            || self.settings.cycle_times(plans),
            |times, task| {
                let mut time_s = |start: Range<usize>, tasks: &[usize], end: Range<usize>| {
                    if self.check_stop().is_err() {
                        return f64::INFINITY;
                    }
                    parts.time_s(times, start, tasks, end)
                };
                let alone_s = time_s(parts.carrying(), &[task], 0..0);
                let first_s = time_s(0..parts.start(), &[task], 0..0);
                let next_s = (0..count).map(|next| {
                    let is_possible = next != task && !parts.tasks[task].after.contains(&next);
                    if is_possible {
                        time_s(parts.carrying(), &[task, next], 0..0) - alone_s
                    } else {
                        f64::INFINITY
                    }
                });
                let next_s: Vec<f64> = next_s.collect();
                let last_s = if parts.is_last_free() || task + 1 == count {
                    time_s(parts.carrying(), &[task], parts.following()) - alone_s
                } else {
                    f64::INFINITY
                };
                // The difference of two times that are not possible is not a number.
                let or_infinite = |time: f64| if time.is_nan() { f64::INFINITY } else { time };
                (first_s, next_s.into_iter().map(or_infinite).collect(), or_infinite(last_s))
            },
        );
        let all: Vec<(f64, Vec<f64>, f64)> = all.collect();
        let mut sequence = SequenceTimes {
            first_s: Vec::with_capacity(count),
            next_s: Vec::with_capacity(count),
            last_s: Vec::with_capacity(count),
            after: parts.tasks.iter().map(|task| task.after.clone()).collect(),
        };
        for (first_s, next_s, last_s) in all {
            sequence.first_s.push(first_s);
            sequence.next_s.push(next_s);
            sequence.last_s.push(last_s);
        }
        sequence
    }
}

/// Parts of a program with tasks.
struct TaskParts<'a> {
    program: &'a Program,
    tasks: &'a [TaskMotions],
}

impl TaskParts<'_> {
    /// First entry of the first task.
    fn start(&self) -> usize {
        self.tasks.first().map_or(0, |task| task.entries.start)
    }

    /// Entry that picks up the payload that is carried between tasks, if any.
    fn carrying(&self) -> Range<usize> {
        let before = &self.program.motions[..self.start()];
        let load = before.iter().rposition(|entry| matches!(entry, Motion::Load(_)));
        load.map_or(0..0, |load| load..load + 1)
    }

    /// Entries after the tasks up to the first motion.
    fn following(&self) -> Range<usize> {
        let end = self.tasks.last().map_or(0, |task| task.entries.end);
        let first = self.program.motions[end..].iter().position(Motion::moves);
        first.map_or(end..end, |first| end..end + first + 1)
    }

    /// Returns true if the motion after the tasks does not depend on where the last one ends.
    fn is_last_free(&self) -> bool {
        self.following().last().is_some_and(|last| self.program.motions[last].is_ptp_to_position())
    }

    /// Returns the program of these entries, and the index of each of them.
    fn part(
        &self,
        start: Range<usize>,
        tasks: &[usize],
        end: Range<usize>,
    ) -> (Program, Vec<usize>) {
        let tasks = tasks.iter().flat_map(|task| self.tasks[*task].entries.clone());
        let origins: Vec<usize> = start.chain(tasks).chain(end).collect();
        let program = Program {
            robot: self.program.robot.clone(),
            start: self.program.start.clone(),
            motions: origins.iter().map(|index| self.program.motions[*index].clone()).collect(),
            workcell: self.program.workcell.clone(),
            sources: Sources::default(),
        };
        (program, origins)
    }

    /// Cycle time of a part of the program, in s; infinite if the robot cannot execute it.
    fn time_s(
        &self,
        times: &mut CycleTimes<'_>,
        start: Range<usize>,
        tasks: &[usize],
        end: Range<usize>,
    ) -> f64 {
        let (program, _) = self.part(start, tasks, end);
        times.plan(&program).map_or(f64::INFINITY, |trajectory| trajectory.cycle_time_s())
    }

    /// Joint positions at the end of a task, in rad, if it ends in a stop.
    fn end_of(&self, times: &mut CycleTimes<'_>, task: usize) -> Option<Joints> {
        let (program, _) = self.part(self.carrying(), &[task], 0..0);
        let trajectory = times.plan(&program).ok()?;
        Some(trajectory.at(trajectory.cycle_time_s()).q)
    }

    /// Excludes those successions of an order that the rule does not accept; returns false if
    /// there are none. Each is checked after a stop.
    fn exclude(
        &self,
        sequence: &mut SequenceTimes,
        order: &[usize],
        times: &mut CycleTimes<'_>,
        rule: OrderRule<'_>,
    ) -> bool {
        let mut is_changed = false;
        let mut check = |time_s: &mut f64, after: Option<usize>, part: (Program, Vec<usize>)| {
            let (mut part, origins) = part;
            if let Some(task) = after
                && let Some(end_rad) = self.end_of(times, task)
            {
                part.start = Start::Joints(end_rad);
            }
            let is_accepted =
                times.plan(&part).is_ok_and(|trajectory| rule(&part, &trajectory, &origins));
            if !is_accepted {
                (*time_s, is_changed) = (f64::INFINITY, true);
            }
        };
        if let Some(first) = order.first() {
            check(&mut sequence.first_s[*first], None, self.part(0..self.start(), &[*first], 0..0));
        }
        for pair in order.windows(2) {
            let part = self.part(self.carrying(), &[pair[1]], 0..0);
            check(&mut sequence.next_s[pair[0]][pair[1]], Some(pair[0]), part);
        }
        if let Some(last) = order.last().filter(|_| !self.following().is_empty()) {
            let part = self.part(self.carrying(), &[], self.following());
            check(&mut sequence.last_s[*last], Some(*last), part);
        }
        is_changed
    }
}
