//! What statements do.

use std::collections::BTreeSet;

/// What statements do beyond having values.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Effects {
    /// Whether they act: do what the evaluation is for.
    pub(crate) acts: bool,
    /// Whether they may leave what is around them: by `return`, `throw`, or the `break` of a loop around.
    pub(crate) leaves: bool,
    /// Whether they may go on with the next turn of a loop around.
    pub(crate) continues: bool,
    /// Variables and fields that get other values, by name.
    pub(crate) assigns: BTreeSet<String>,
    /// Variables whose contents change.
    pub(crate) changes: BTreeSet<String>,
}

impl Effects {
    pub(crate) fn add(&mut self, other: &Self) {
        self.acts |= other.acts;
        self.leaves |= other.leaves;
        self.continues |= other.continues;
        self.assigns.extend(other.assigns.iter().cloned());
        self.changes.extend(other.changes.iter().cloned());
    }
}
