//! Results of searches.

use iiwa_program::Program;

use crate::change::Change;

/// Changes of a program that save time.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Advice {
    /// Cycle time of the program as it is, in s.
    pub cycle_time_s: f64,
    /// Changes, the largest saving first.
    pub rows: Vec<AdviceRow>,
    /// Program with all changes.
    pub program: Program,
    /// Its cycle time, in s.
    pub changed_cycle_time_s: f64,
}

/// A change, and the time that it saves.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct AdviceRow {
    /// The change.
    pub change: Change,
    /// Time that the change saves alone, in s.
    pub saved_s: f64,
    /// Time that it saves after all changes before it, in s.
    pub saved_on_top_s: f64,
    /// Assumptions about the controller that the times of the changed motions, and of the one after
    /// them, depend on before or after the change. Without any, these times follow recordings of a
    /// robot.
    pub rests_on: Vec<&'static str>,
}

/// The fastest version of a program that a search has found: a local optimum.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Optimum {
    /// Cycle time of the program as it is, in s.
    pub cycle_time_s: f64,
    /// The changed program; without changes, the program itself.
    pub program: Program,
    /// Its cycle time, in s.
    pub changed_cycle_time_s: f64,
    /// Changes that lead from the program to the changed one, in the order of the motions.
    pub changes: Vec<Change>,
    /// Number of plans that were compared.
    pub plans: u64,
    /// `false` if the budget ended the search before it had tried all changes again.
    pub is_complete: bool,
}
