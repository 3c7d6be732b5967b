//! Tasks that a program starts at the same time: what they would do is searched for, and not evaluated.

use std::{collections::BTreeSet, rc::Rc};

use crate::{machine::Machine, syntax::Member, unknown::Unknown, value::Value};

/// Methods that a task runs: those of `Runnable`, `TimerTask` and `Callable`.
const METHODS: [&str; 2] = ["run", "call"];

/// The doings of a task.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TaskEffects {
    /// Whether it acts otherwise than by taking time.
    pub moves: bool,
    /// The names of the methods that it calls, by way of others or not.
    pub calls: BTreeSet<String>,
}

impl Machine {
    /// Starts a task that is not evaluated: values that it sets are unknown from here on. Nothing is done if it acts, or calls one of
    /// these methods. None if the task has no method that would be run.
    pub fn start_task(
        &mut self,
        task: &Value,
        interfering: &[&str],
        unknown: &Rc<Unknown>,
    ) -> Option<TaskEffects> {
        let effects = match task {
            Value::Object(object) if object.function.is_none() => {
                let method = METHODS.iter().find_map(|name| self.plain_method(object.class, name));
                let (_, method) = method?;
                self.effects_of(method.body.as_ref()?)
            }
            Value::Object(_) | Value::Function(_) => self.effects_of_function(task, ""),
            _ => return None,
        };
        let task = TaskEffects { moves: effects.moves(), calls: effects.calls.clone() };
        if !task.moves && !interfering.iter().any(|name| task.calls.contains(*name)) {
            self.forget_values(&self.outliving(effects), unknown);
        }
        Some(task)
    }

    /// The names of all fields of the project.
    pub(crate) fn field_names(&self) -> BTreeSet<String> {
        let classes = &self.java.classes;
        let members = classes.ids().flat_map(|id| &classes.known(id).class.members);
        let fields = members.filter_map(|member| match member {
            Member::Field(field) => Some(field.name.clone()),
            Member::Initializer { .. } => None,
        });
        fields.collect()
    }
}

impl Value {
    /// True for a value that can be a task: an object of the project, or a function.
    #[must_use]
    pub fn is_task(&self) -> bool {
        matches!(self, Self::Object(_) | Self::Function(_))
    }
}
