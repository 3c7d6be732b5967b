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

/// Lower bound of the cycle times of a program with other elbow angles (E1), without regard to
/// obstacles. The groups of motions between point-to-point motions turn independently.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LowerBound {
    /// The program is not faster than this with any E1 in these steps, in s.
    pub cycle_time_s: f64,
    /// Step between the values of E1 for which that holds, in degrees.
    pub step_deg: i16,
}

impl LowerBound {
    /// Returns the bound of a result, in s; `None` if the bound is above it: if the search for the
    /// bound had larger steps.
    pub(crate) fn below(self, result_s: f64) -> Option<Self> {
        /// The bound is a sum of parts: it is exact but for rounding.
        const ROUNDING_S: f64 = 1e-6;

        let cycle_time_s = self.cycle_time_s.min(result_s);
        (self.cycle_time_s - cycle_time_s < ROUNDING_S).then_some(Self { cycle_time_s, ..self })
    }
}

/// The fastest version of a program that a search has found. Unless a lower bound shows that it is
/// the fastest one, it is a local optimum.
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
    /// Lower bound of the cycle time. It is known if only elbow angles may change, no wait overlaps
    /// a motion, and the arm stops at the first and the last target of each group of motions that
    /// turns. The first motion of a group has to be a point-to-point motion to a frame with E1 and
    /// status, those between groups point-to-point motions to joints that end in stops, and the
    /// budget has to suffice for all E1 of each group.
    pub lower_bound: Option<LowerBound>,
    /// `false` if the budget ended the search before it had tried all changes again.
    pub is_complete: bool,
}
