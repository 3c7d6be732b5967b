//! Effects of statements.

use std::collections::BTreeSet;

/// Effects of statements beyond their values.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Effects {
    /// Strongest action.
    pub(crate) action: Action,
    /// `true` if the statements may leave the surrounding code: by `return`, `throw`, or the
    /// `break` of an enclosing loop.
    pub(crate) leaves: bool,
    /// `true` if the statements may continue with the next iteration of an enclosing loop.
    pub(crate) continues: bool,
    /// Names of variables and fields that are assigned.
    pub(crate) assigns: BTreeSet<String>,
    /// Names of variables whose contents change.
    pub(crate) changes: BTreeSet<String>,
    /// Names of returned variables and fields, without those of called methods.
    pub(crate) returns: BTreeSet<String>,
    /// Names of called methods and constructed classes.
    pub(crate) calls: BTreeSet<String>,
}

/// Actions of statements, in ascending order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Action {
    #[default]
    None,
    /// Only takes time.
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
