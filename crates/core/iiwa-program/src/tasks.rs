//! Motions of tasks, and programs with their tasks in another order.

use std::{collections::BTreeMap, ops::Range};

use crate::{
    cartesian_motion::Course,
    flange_load::FlangeLoad,
    motion_index::MotionIndex,
    program::{Motion, Program},
    task::{MAX_TASKS, Task, TaskFault},
};

/// A task with its motions, and the tasks that it has to follow.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct TaskMotions {
    /// Group of the motions.
    pub group: String,
    /// Indices of its entries.
    pub entries: Range<usize>,
    /// Tasks that have to be executed before, as indices into the list of tasks.
    pub after: Vec<usize>,
}

impl Program {
    /// Returns the tasks in the order of the program.
    ///
    /// ```
    /// use iiwa_program::Program;
    ///
    /// let program = Program::from_json(
    ///     r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
    ///         "tasks": [{ "group": "left" }, { "group": "right", "after": ["left"] }],
    ///         "motions": [
    ///             { "type": "ptp", "joints_deg": [30, 0, 0, 0, 0, 0, 0], "group": "left" },
    ///             { "type": "wait", "seconds": 1, "group": "left" },
    ///             { "type": "ptp", "joints_deg": [-30, 0, 0, 0, 0, 0, 0], "group": "right" }] }"#,
    /// )?;
    /// let tasks = program.tasks()?;
    /// assert_eq!(tasks[1].entries, 2..3);
    /// assert_eq!(tasks[1].after, [0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// The first [`TaskFault`].
    pub fn tasks(&self) -> Result<Vec<TaskMotions>, TaskFault> {
        let listed = self.sources.tasks();
        if listed.is_empty() {
            return Ok(Vec::new());
        }
        if listed.len() > MAX_TASKS {
            return Err(TaskFault::TooMany { found: listed.len() });
        }
        let mut ranges = self.group_ranges()?;
        let mut all = Vec::with_capacity(listed.len());
        for task in listed {
            let group = task.group.clone();
            match ranges.remove(group.as_str()) {
                Some(Some(entries)) => all.push((task, entries)),
                Some(None) => return Err(TaskFault::NoMotions { group }),
                None => return Err(TaskFault::Twice { group }),
            }
        }
        all.sort_by_key(|(_, entries)| entries.start);
        for pair in all.windows(2) {
            let between = pair[0].1.end;
            if between != pair[1].1.start {
                return Err(TaskFault::Between { motion: MotionIndex::new(between) });
            }
        }
        let tasks = all.iter().enumerate().map(|(index, (task, entries))| {
            self.check_task(task, entries)?;
            let place = |after: &String| {
                let group = || task.group.clone();
                let found = all.iter().position(|(other, _)| other.group == *after);
                let found = found
                    .ok_or_else(|| TaskFault::Unknown { group: group(), after: after.clone() })?;
                if found < index {
                    Ok(found)
                } else {
                    Err(TaskFault::Order { group: group(), after: after.clone() })
                }
            };
            let after = task.after.iter().map(place).collect::<Result<_, _>>()?;
            Ok(TaskMotions { group: task.group.clone(), entries: entries.clone(), after })
        });
        tasks.collect()
    }

    /// Returns the entries of the group of each task; `None` if it has none.
    fn group_ranges(&self) -> Result<BTreeMap<&str, Option<Range<usize>>>, TaskFault> {
        let listed = self.sources.tasks().iter();
        let mut ranges: BTreeMap<_, Option<Range<usize>>> =
            listed.map(|task| (task.group.as_str(), None)).collect();
        for (motion, label) in self.sources.labels() {
            let index = motion.index();
            let Some(group) = label.group.as_deref().filter(|_| index < self.motions.len()) else {
                continue;
            };
            match ranges.get_mut(group) {
                None => {}
                Some(range @ None) => *range = Some(index..index + 1),
                Some(Some(range)) if range.end == index => range.end += 1,
                Some(Some(range)) => {
                    let motion = MotionIndex::new(range.end);
                    return Err(TaskFault::Interrupted { group: group.to_owned(), motion });
                }
            }
        }
        Ok(ranges)
    }

    /// Checks that a task does not depend on what is before it, nor anything after it on the task.
    fn check_task(&self, task: &Task, entries: &Range<usize>) -> Result<(), TaskFault> {
        let group = || task.group.clone();
        let mut moves = 0;
        for index in entries.clone() {
            let (motion, entry) = (MotionIndex::new(index), &self.motions[index]);
            if entry.overlap() > moves {
                return Err(TaskFault::Overlap { group: group(), motion });
            }
            let is_start = moves == 0 && entry.moves();
            if is_start && !self.is_independent(entry) {
                return Err(TaskFault::Start { group: group(), motion });
            }
            moves += usize::from(entry.moves());
        }
        if moves == 0 {
            return Err(TaskFault::Start {
                group: group(),
                motion: MotionIndex::new(entries.start),
            });
        }
        if self.picked_up(entries.start) == self.picked_up(entries.end) {
            Ok(())
        } else {
            Err(TaskFault::Payload { group: group() })
        }
    }

    /// Returns the payload that the last payload change before the entry at `index` sets.
    fn picked_up(&self, index: usize) -> Option<&FlangeLoad> {
        self.motions[..index].iter().rev().find_map(|entry| match entry {
            Motion::Load(load) => Some(load.as_ref()),
            _ => None,
        })?
    }

    /// Returns true for a point-to-point motion whose target does not depend on the motion before:
    /// joint positions, or a frame with E1 and status.
    #[must_use]
    pub fn is_independent(&self, entry: &Motion) -> bool {
        match entry {
            Motion::Ptp(_) => true,
            Motion::Cartesian(motion) => match &motion.course {
                // An unknown frame is a fault of its own.
                Course::Ptp { to } => self
                    .workcell
                    .target(to, motion.base.as_deref())
                    .map_or(true, |(target, _)| target.e1_rad.is_some() && target.status.is_some()),
                _ => false,
            },
            Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => false,
        }
    }

    /// Returns the program with its tasks in another order, and for each of its entries the index
    /// of the same entry in this program. `order` has the indices of the tasks as in
    /// [`tasks`](Self::tasks), each of them once. A repeat block around several tasks is written
    /// out.
    ///
    /// # Errors
    ///
    /// The first [`TaskFault`], also if the order does not keep what `after` of the tasks states.
    pub fn with_task_order(&self, order: &[usize]) -> Result<(Self, Vec<usize>), TaskFault> {
        let tasks = self.tasks()?;
        let (Some(first), Some(last)) = (tasks.first(), tasks.last()) else {
            return Ok((self.clone(), (0..self.motions.len()).collect()));
        };
        let mut all = order.to_vec();
        all.sort_unstable();
        if !all.into_iter().eq(0..tasks.len()) {
            return Err(TaskFault::Incomplete { tasks: tasks.len() });
        }
        let before = 0..first.entries.start;
        let moved = order.iter().filter_map(|task| tasks.get(*task)).map(|task| &task.entries);
        let after = last.entries.end..self.motions.len();
        let origins: Vec<usize> = before.chain(moved.cloned().flatten()).chain(after).collect();
        let mut program = Self {
            motions: origins.iter().map(|index| self.motions[*index].clone()).collect(),
            ..self.clone()
        };
        program.sources = self.sources.reordered(&origins);
        program.tasks()?;
        Ok((program, origins))
    }
}
