//! What statements do.

use std::collections::BTreeSet;

/// What statements do beyond having values.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Effects {
    /// The strongest action among them.
    pub(crate) action: Action,
    /// Whether they may leave what is around them: by `return`, `throw`, or the `break` of a loop around.
    pub(crate) leaves: bool,
    /// Whether they may go on with the next turn of a loop around.
    pub(crate) continues: bool,
    /// Variables and fields that get other values, by name.
    pub(crate) assigns: BTreeSet<String>,
    /// Variables whose contents change.
    pub(crate) changes: BTreeSet<String>,
    /// Variables and fields that are returned, by name; not those of methods that are called.
    pub(crate) returns: BTreeSet<String>,
    /// Methods that are called, and classes of which objects are made, by name.
    pub(crate) calls: BTreeSet<String>,
}

/// Actions of statements, the strongest last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Action {
    #[default]
    None,
    /// They take time, and do nothing else.
    Pause,
    Motion,
}

impl Effects {
    pub(crate) fn acts(&self) -> bool {
        self.action > Action::None
    }

    pub(crate) fn moves(&self) -> bool {
        self.action == Action::Motion
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.action = self.action.max(other.action);
        self.leaves |= other.leaves;
        self.continues |= other.continues;
        self.assigns.extend(other.assigns.iter().cloned());
        self.changes.extend(other.changes.iter().cloned());
        self.calls.extend(other.calls.iter().cloned());
    }
}
