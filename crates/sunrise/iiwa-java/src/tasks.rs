//! Concurrent tasks of a program: their effects are searched, but not evaluated.

use std::{collections::BTreeSet, rc::Rc};

use crate::{machine::Machine, syntax::Member, unknown::Unknown, value::Value};

/// Methods that a task runs: those of `Runnable`, `TimerTask` and `Callable`.
const METHODS: [&str; 2] = ["run", "call"];

/// Effects of a task.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TaskEffects {
    /// `true` if the task acts other than by taking time.
    pub moves: bool,
    /// Names of the methods that the task calls, directly or indirectly.
    pub calls: BTreeSet<String>,
}

impl Machine {
    /// Starts a task without evaluating it: the values that it sets are unknown from here on.
    /// Nothing is changed if the task acts other than by taking time, or calls one of the
    /// `interfering` methods. `None` if the task has no method to run.
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

    /// Returns the names of all fields of the project.
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
    /// Returns true for a value that can be a task: a project object, or a function.
    #[must_use]
    pub fn is_task(&self) -> bool {
        matches!(self, Self::Object(_) | Self::Function(_))
    }
}
