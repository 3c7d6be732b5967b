//! Tasks that a program starts at the same time: what they would do is searched for, and not evaluated.

use std::{collections::BTreeSet, rc::Rc};

use crate::{
    machine::Machine,
    syntax::Member,
    unknown::Unknown,
    value::{Object, Value},
};

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
        task: &Rc<Object>,
        interfering: &[&str],
        unknown: &Rc<Unknown>,
    ) -> Option<TaskEffects> {
        let method = METHODS.iter().find_map(|name| self.plain_method(task.class, name));
        let (_, method) = method?;
        let mut effects = self.effects_of(method.body.as_ref()?);
        let task = TaskEffects { moves: effects.moves(), calls: effects.calls.clone() };
        if !task.moves && !interfering.iter().any(|name| task.calls.contains(*name)) {
            // Its local variables are its own.
            let fields = self.field_names();
            effects.assigns.retain(|name| fields.contains(name));
            self.forget_values(&effects, unknown);
        }
        Some(task)
    }

    /// The names of all fields of the project.
    fn field_names(&self) -> BTreeSet<String> {
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
    /// The object of a project's class that this is.
    #[must_use]
    pub fn object(&self) -> Option<&Rc<Object>> {
        match self {
            Self::Object(object) => Some(object),
            _ => None,
        }
    }
}
