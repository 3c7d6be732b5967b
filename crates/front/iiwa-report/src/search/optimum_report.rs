//! The fastest version of a program, as text and as JSON.

use std::fmt::Write as _;

use iiwa_optimise::Optimum;
use iiwa_program::Program;
use serde::Serialize;

use crate::{
    DifferenceReport,
    search::change_rows::{ChangeColumns, ChangeEntry, ChangeTable, NOT_CHECKED},
    signed::rounded,
    table::{fitted, table},
};

/// The fastest version of a program that was found. As JSON, this is the object of
/// `iiwasim optimise --json`.
#[derive(Clone, Debug, Serialize)]
pub struct OptimumReport {
    cycle_time_s: f64,
    changed_cycle_time_s: f64,
    /// `true` if all changes were checked for collisions with a scene.
    checked_for_collisions: bool,
    /// Number of plans that were compared.
    plans: u64,
    /// `false` if the budget ended the search.
    complete: bool,
    /// Lower bound of the cycle time with another E1, if it is known.
    lower_bound: Option<BoundEntry>,
    /// Changes, in the order of the motions.
    changes: Vec<ChangeEntry>,
    /// Differences between the plans before and after the changes.
    differences: DifferenceReport,
}

/// Lower bound of the cycle time.
#[derive(Clone, Debug, Serialize)]
struct BoundEntry {
    cycle_time_s: f64,
    /// Step between the values of E1.
    e1_step_deg: i16,
}

impl OptimumReport {
    /// Creates the report of an optimum of `program`. `is_checked` says whether the changes were
    /// checked for collisions.
    #[must_use]
    pub fn new(
        optimum: &Optimum,
        program: &Program,
        is_checked: bool,
        differences: DifferenceReport,
    ) -> Self {
        let changes = optimum.changes.iter().map(|change| ChangeEntry::new(change, program));
        Self {
            cycle_time_s: rounded(optimum.cycle_time_s, 9),
            changed_cycle_time_s: rounded(optimum.changed_cycle_time_s, 9),
            checked_for_collisions: is_checked,
            plans: optimum.plans,
            complete: optimum.is_complete,
            lower_bound: optimum.lower_bound.map(|bound| BoundEntry {
                cycle_time_s: rounded(bound.cycle_time_s, 9),
                e1_step_deg: bound.step_deg,
            }),
            changes: changes.collect(),
            differences,
        }
    }

    /// The changes as a table.
    #[must_use]
    pub fn changes(&self) -> ChangeTable {
        ChangeTable::new(&self.changes)
    }

    /// Writes the report as text, with tables that are at most `width` columns wide, if given.
    #[must_use]
    pub fn text(&self, width: Option<u16>) -> String {
        let end = match (self.complete, self.checked_for_collisions) {
            (true, false) => "no other change of these kinds saves a millisecond",
            (true, true) => {
                "no other change of these kinds that keeps the clearances saves a millisecond"
            }
            (false, _) => "the budget ended the search",
        };
        let mut search = format!("{} plans compared; {end}.\n", self.plans);
        if let Some(BoundEntry { cycle_time_s, e1_step_deg }) = self.lower_bound {
            let gap = (100.0 * (1.0 - cycle_time_s / self.changed_cycle_time_s)).max(0.0);
            let scene = if self.checked_for_collisions { ", without obstacles" } else { "" };
            let _ = writeln!(
                search,
                "Lower bound for E1 in steps of {e1_step_deg} deg{scene}: {cycle_time_s:.3} s \
                 ({gap:.1} % below the result)."
            );
        }
        if self.changes.is_empty() {
            let cycle_time_s = self.cycle_time_s;
            return format!("Cycle time {cycle_time_s:.3} s; nothing was changed. {search}");
        }
        let columns = ChangeColumns::of(self.changes.iter());
        let mut rows = table(&columns.head());
        for change in &self.changes {
            rows.add_row(columns.cells(change));
        }
        let mut text = fitted(rows, width);
        text.push_str("\n\n");
        text.push_str(&self.differences.text(width));
        text.push_str(&search);
        if !self.checked_for_collisions && self.changes.iter().any(ChangeEntry::bends) {
            text.push_str(NOT_CHECKED);
        }
        text
    }
}
