//! Search for the order of tasks with the shortest cycle time.

use std::{
    collections::BTreeSet,
    ops::Range,
    sync::atomic::{AtomicU64, Ordering::Relaxed},
};

use iiwa_kin::Joints;
use iiwa_program::{Fault, Motion, Program, Start, TaskFault, TaskMotions};
use iiwa_traj::{PlanError, Trajectory};
use rayon::prelude::*;

use crate::{
    change_search::LEAST_S, cycle_time::CycleTimes, optimiser::Optimiser, part::part,
    sequence::SequenceTimes,
};

/// Rule for a program that has entries of another program, in another order. Its arguments are the
/// program, its trajectory, and the index of each of its entries in the other program.
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
    /// `true` if no allowed order is faster, assuming that the time of a task depends only on
    /// itself and on the task before it.
    pub is_exact: bool,
    /// Number of plans that were compared.
    pub plans: u64,
}

impl Optimiser {
    /// Searches for the order of the tasks of `program` ([`Program::tasks`]) with the shortest
    /// cycle time. Paths within tasks stay as they are, except in blends between tasks. The last
    /// task stays the last one unless a point-to-point motion follows it directly whose target does
    /// not depend on the motion before ([`Program::is_independent`]).
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
        let are_all_compared = given.len() <= SequenceTimes::EXACT_TASKS;
        let mut checked = BTreeSet::new();
        let allows = |program: &Program, trajectory: &Trajectory, origins: &[usize]| {
            rule.is_none_or(|rule| rule(program, trajectory, origins))
        };
        // If an order is not accepted, the search continues without those of its transitions that
        // are not accepted.
        loop {
            let order =
                if are_all_compared { sequence.fastest() } else { sequence.improved(&given) };
            found.is_exact = are_all_compared && order.is_some();
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
            let is_changed =
                parts.exclude(&mut sequence, &order, &mut checked, &mut times, &allows);
            self.check_stop()?;
            if !is_changed {
                // Each transition is accepted, but the order is not: slower orders are not tried.
                found.is_exact = false;
                break;
            }
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
                let following = parts.following();
                let last_s = if !following.is_empty() {
                    time_s(parts.carrying(), &[task], following) - alone_s
                } else if task + 1 == count {
                    0.0
                } else {
                    f64::INFINITY
                };
                // The difference of two times that are not possible is not a number.
                let or_infinite = |time: f64| if time.is_nan() { f64::INFINITY } else { time };
                let next_s: Vec<f64> = next_s.into_iter().map(or_infinite).collect();
                (first_s, (next_s, or_infinite(last_s)))
            },
        );
        let (first_s, (next_s, last_s)) = all.unzip();
        let after = parts.tasks.iter().map(|task| task.after.clone()).collect();
        SequenceTimes { first_s, next_s, last_s, after }
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

    /// The motion after the tasks, if nothing after them depends on where the last one ends.
    fn following(&self) -> Range<usize> {
        let end = self.tasks.last().map_or(0, |task| task.entries.end);
        let after = &self.program.motions[end..];
        let is_independent = after.first().is_some_and(|it| self.program.is_independent(it));
        let mut moves = 0;
        let overlaps_task = after.iter().any(|entry| {
            moves += usize::from(entry.moves());
            entry.overlap() > moves
        });
        if is_independent && !overlaps_task { end..end + 1 } else { end..end }
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
        let motions = origins.iter().map(|index| self.program.motions[*index].clone()).collect();
        let program = part(self.program, self.program.start.clone(), motions);
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
        times.end(&program).map(|(_, end_rad)| end_rad)
    }

    /// Excludes those transitions of an order that the rule does not accept; returns false if it
    /// accepts all of them. Each is planned after a stop, and once: `checked` has the tasks before
    /// and after those that are accepted.
    fn exclude(
        &self,
        sequence: &mut SequenceTimes,
        order: &[usize],
        checked: &mut BTreeSet<[Option<usize>; 2]>,
        times: &mut CycleTimes<'_>,
        rule: OrderRule<'_>,
    ) -> bool {
        let mut is_accepted = |before: Option<usize>, after: Option<usize>| {
            if checked.contains(&[before, after]) {
                return true;
            }
            let start = if before.is_none() { 0..self.start() } else { self.carrying() };
            let end = if after.is_none() { self.following() } else { 0..0 };
            let (mut part, origins) = self.part(start, after.as_slice(), end);
            if part.motions.is_empty() {
                return true;
            }
            if let Some(end_rad) = before.and_then(|task| self.end_of(times, task)) {
                part.start = Start::Joints(end_rad);
            }
            let is_accepted =
                times.plan(&part).is_ok_and(|trajectory| rule(&part, &trajectory, &origins));
            if is_accepted {
                checked.insert([before, after]);
            }
            is_accepted
        };
        let mut is_changed = false;
        let mut exclude_if = |is_excluded: bool, time_s: &mut f64| {
            if is_excluded {
                (*time_s, is_changed) = (f64::INFINITY, true);
            }
        };
        if let (Some(first), Some(last)) = (order.first(), order.last()) {
            exclude_if(!is_accepted(None, Some(*first)), &mut sequence.first_s[*first]);
            for pair in order.windows(2) {
                let time_s = &mut sequence.next_s[pair[0]][pair[1]];
                exclude_if(!is_accepted(Some(pair[0]), Some(pair[1])), time_s);
            }
            exclude_if(!is_accepted(Some(*last), None), &mut sequence.last_s[*last]);
        }
        is_changed
    }
}
