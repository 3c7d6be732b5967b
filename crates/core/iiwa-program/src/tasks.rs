//! Tasks: groups of motions that may be executed in another order.

use std::{collections::BTreeMap, ops::Range};

use iiwa_json::{JsonPlace, JsonStep, excerpt, locate};
use serde_json::Value;

use crate::{
    flange_load::FlangeLoad,
    motion_index::MotionIndex,
    program::{Motion, Program},
    repeat_block::RepeatBlock,
};

/// Largest number of tasks of a program.
pub const MAX_TASKS: usize = 200;

/// A group of motions that may be executed before or after other tasks.
///
/// The tasks of a program follow each other without other motions in between. Each of them begins
/// with a point-to-point motion to a position, so that its path does not depend on the task before.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Task {
    /// Group of the motions.
    pub group: String,
    /// Groups of the tasks that have to be executed before this one.
    pub after: Vec<String>,
}

/// Fault of a task.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TaskFault {
    /// There are too many tasks.
    #[error("there are {found} tasks; at most {MAX_TASKS} are supported")]
    TooMany {
        /// Number of tasks.
        found: usize,
    },
    /// No motion has the group of the task.
    #[error("no motion has the group `{}`", excerpt(.group))]
    NoMotions {
        /// Group of the task.
        group: String,
    },
    /// Two tasks have the same group.
    #[error("the task `{}` is listed twice", excerpt(.group))]
    Twice {
        /// Group of the tasks.
        group: String,
    },
    /// Another entry is between the motions of the task.
    #[error(
        "the motions of the task `{}` do not follow each other: motion {motion} does not belong to \
         it", excerpt(.group)
    )]
    Interrupted {
        /// Group of the task.
        group: String,
        /// Entry in between.
        motion: MotionIndex,
    },
    /// Another entry is between two tasks.
    #[error("motion {motion} is between two tasks; tasks have to follow each other")]
    Between {
        /// Entry in between.
        motion: MotionIndex,
    },
    /// The path of the task would depend on the task before it.
    #[error(
        "motion {motion}: the task `{}` has to begin with a ptp to a position, so that its path \
         does not depend on the task before it", excerpt(.group)
    )]
    Start {
        /// Group of the task.
        group: String,
        /// First motion of the task.
        motion: MotionIndex,
    },
    /// A wait of the task begins before the task.
    #[error("motion {motion} overlaps a motion before its task `{}`", excerpt(.group))]
    Overlap {
        /// Group of the task.
        group: String,
        /// Index of the wait.
        motion: MotionIndex,
    },
    /// The payload after the task is not the one before it.
    #[error(
        "the task `{}` ends with another payload than it begins with; the tasks after it would \
         depend on it", excerpt(.group)
    )]
    Payload {
        /// Group of the task.
        group: String,
    },
    /// A task that has to be executed before is unknown.
    #[error("`after` names `{}`, which is not a task", excerpt(.after))]
    Unknown {
        /// Group of the task.
        group: String,
        /// Name that is unknown.
        after: String,
    },
    /// A task that has to be executed before comes later in the program.
    #[error(
        "the task `{}` is to be executed after `{}`, which comes later in the program",
        excerpt(.group), excerpt(.after)
    )]
    Order {
        /// Group of the task.
        group: String,
        /// Task that comes later.
        after: String,
    },
}

impl TaskFault {
    /// Motion at fault, if any.
    #[must_use]
    pub fn motion(&self) -> Option<MotionIndex> {
        match self {
            Self::Interrupted { motion, .. }
            | Self::Between { motion }
            | Self::Start { motion, .. }
            | Self::Overlap { motion, .. } => Some(*motion),
            _ => None,
        }
    }

    /// Group of the task at fault, if it is one.
    fn group(&self) -> Option<&str> {
        match self {
            Self::TooMany { .. } | Self::Between { .. } => None,
            Self::NoMotions { group }
            | Self::Twice { group }
            | Self::Interrupted { group, .. }
            | Self::Start { group, .. }
            | Self::Overlap { group, .. }
            | Self::Payload { group }
            | Self::Unknown { group, .. }
            | Self::Order { group, .. } => Some(group),
        }
    }

    /// Place of the task at fault in the program's JSON text.
    pub(crate) fn place_in(&self, text: &str) -> JsonPlace {
        use JsonStep::{Index, Key};
        let document = serde_json::from_str::<Value>(text).unwrap_or_default();
        let tasks = document["tasks"].as_array().map(Vec::as_slice).unwrap_or_default();
        // The second one of two that are equal.
        let task = tasks.iter().rposition(|task| task["group"].as_str() == self.group());
        let mut path = vec![Key("tasks")];
        path.extend(task.map(Index));
        if let Self::Unknown { after, .. } | Self::Order { after, .. } = self {
            let names = task.and_then(|task| tasks[task]["after"].as_array());
            let name = names.and_then(|names| names.iter().position(|name| name == after));
            path.push(Key("after"));
            path.extend(name.map(Index));
        }
        locate(text, &path)
    }
}

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
            if is_start && !entry.is_ptp_to_position() {
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

    /// Returns the program with its tasks in another order, and for each of its entries the index
    /// of the same entry in this program. `order` has the indices of the tasks as in
    /// [`tasks`](Self::tasks), each of them once. A repeat block with a part of a task is written
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

/// Returns repeat blocks for entries in another order, without those whose entries do not follow
/// each other any more. `origins` has the former index of each entry.
pub(crate) fn reordered_blocks(blocks: &[RepeatBlock], origins: &[usize]) -> Vec<RepeatBlock> {
    let kept = blocks.iter().filter_map(|block| {
        let range = block.range(0);
        let first = origins.iter().position(|origin| *origin == range.start)?;
        let there = origins.get(first..first + range.len())?;
        there.iter().copied().eq(range).then(|| RepeatBlock { first, ..block.clone() })
    });
    let mut kept: Vec<_> = kept.collect();
    kept.sort_by_key(|block| block.first);
    kept
}
