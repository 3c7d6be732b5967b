//! JSON form of tasks.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::task::Task;

/// A group of motions that may be executed before or after other tasks. The tasks of a program
/// follow each other, and each begins with a `ptp` to a position.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Task")]
pub(super) struct TaskWire {
    /// Group of the motions.
    group: String,
    /// Groups of the tasks that have to be executed before.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    after: Vec<String>,
}

impl From<TaskWire> for Task {
    fn from(TaskWire { group, after }: TaskWire) -> Self {
        Self { group, after }
    }
}

impl From<&Task> for TaskWire {
    fn from(task: &Task) -> Self {
        Self { group: task.group.clone(), after: task.after.clone() }
    }
}
