//! Tasks: groups of motions that may be executed in another order, and their faults.

use iiwa_json::{JsonPlace, JsonStep, excerpt, locate};
use serde_json::Value;

use crate::motion_index::MotionIndex;

/// Largest number of tasks of a program.
pub const MAX_TASKS: usize = 200;

/// A group of motions that may be executed before or after other tasks.
///
/// The tasks of a program follow each other without other motions in between. Each of them begins
/// with a point-to-point motion to joints, or to a frame with E1 and status, so that its path does
/// not depend on the task before.
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
        "motion {motion}: the task `{}` has to begin with a ptp to joints, or to a frame with \
         `e1_deg` and `status`, so that its path does not depend on the task before it",
        excerpt(.group)
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
    /// An order of the tasks does not contain each task once.
    #[error("an order has to contain each of the {tasks} tasks once")]
    Incomplete {
        /// Number of tasks.
        tasks: usize,
    },
    /// A task that has to be executed before is unknown.
    #[error("`after` names `{}`, which is not a task", excerpt(.after))]
    Unknown {
        /// Group of the task.
        group: String,
        /// Name that is unknown.
        after: String,
    },
    /// A task that has to be executed before this one follows it in the program.
    #[error(
        "the task `{}` is to be executed after `{}`, which follows it in the program",
        excerpt(.group), excerpt(.after)
    )]
    Order {
        /// Group of the task.
        group: String,
        /// Task that follows.
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
            Self::TooMany { .. } | Self::Between { .. } | Self::Incomplete { .. } => None,
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
