//! Changes that make a program faster, as text and as JSON.

use std::fmt::Write as _;

use iiwa_optimise::Advice;
use iiwa_program::Program;
use serde::Serialize;

use crate::{
    search::change_rows::{ChangeColumns, ChangeEntry, NOT_CHECKED},
    signed::rounded,
    table::{fitted, table},
};

/// Changes that make a program faster. As JSON, this is the object of `iiwasim advise --json`.
#[derive(Clone, Debug, Serialize)]
pub struct AdviceReport {
    cycle_time_s: f64,
    /// Cycle time with all changes.
    changed_cycle_time_s: f64,
    /// `true` if all changes were checked for collisions with a scene.
    checked_for_collisions: bool,
    /// Changes, the largest saving first.
    changes: Vec<ChangeRow>,
}

/// A change of a program, with the time that it saves.
#[derive(Clone, Debug, Serialize)]
struct ChangeRow {
    /// Number of the row, from 1.
    row: usize,
    #[serde(flatten)]
    entry: ChangeEntry,
    /// Time that the change saves alone.
    saved_s: f64,
    /// Time that it saves after all changes before it.
    saved_on_top_s: f64,
    /// Assumptions about the controller that the times of the changed motions depend on; without
    /// any, they follow recordings.
    rests_on: Vec<&'static str>,
}

impl AdviceReport {
    /// Creates the report of an advice for `program`. `is_checked` says whether the changes were
    /// checked for collisions.
    #[must_use]
    pub fn new(advice: &Advice, program: &Program, is_checked: bool) -> Self {
        let changes = advice.rows.iter().zip(1..).map(|(found, row)| ChangeRow {
            row,
            entry: ChangeEntry::new(&found.change, program),
            saved_s: rounded(found.saved_s, 9),
            saved_on_top_s: rounded(found.saved_on_top_s, 9),
            rests_on: found.rests_on.clone(),
        });
        Self {
            cycle_time_s: rounded(advice.cycle_time_s, 9),
            changed_cycle_time_s: rounded(advice.changed_cycle_time_s, 9),
            checked_for_collisions: is_checked,
            changes: changes.collect(),
        }
    }

    /// Writes the report as text, with a table that is at most `width` columns wide, if given.
    #[must_use]
    pub fn text(&self, width: Option<u16>) -> String {
        let Self { cycle_time_s, changed_cycle_time_s, changes, .. } = self;
        if changes.is_empty() {
            let tried = if self.checked_for_collisions {
                "changes that were tried and keep the clearances"
            } else {
                "changes that were tried"
            };
            return format!(
                "Cycle time {cycle_time_s:.3} s; none of the {tried} saves a millisecond.\n"
            );
        }
        let columns = ChangeColumns::of(changes.iter().map(|row| &row.entry));
        let mut head = vec!["row"];
        head.extend(columns.head());
        head.extend(["saves s", "on top s", "rests on"]);
        let mut rows = table(&head);
        let mut assumed = Vec::new();
        for text in changes.iter().flat_map(|change| &change.rests_on) {
            if !assumed.contains(text) {
                assumed.push(*text);
            }
        }
        for change in changes {
            let mut cells = vec![change.row.to_string()];
            cells.extend(columns.cells(&change.entry));
            cells.extend([change.saved_s, change.saved_on_top_s].map(|time| format!("{time:.3}")));
            let known = assumed.iter().enumerate();
            let letters = known
                .filter(|(_, text)| change.rests_on.contains(text))
                .filter_map(|(index, _)| letter(index));
            let letters: Vec<_> = letters.map(String::from).collect();
            cells.push(if letters.is_empty() { "recordings".into() } else { letters.join(", ") });
            rows.add_row(cells);
        }
        let mut text = fitted(rows, width);
        let percent = 100.0 * (changed_cycle_time_s / cycle_time_s - 1.0);
        let _ = write!(
            text,
            "\n\nCycle time {cycle_time_s:.3} s; with all changes {changed_cycle_time_s:.3} s \
             ({percent:.1} %)\n"
        );
        if !self.checked_for_collisions && changes.iter().any(|row| row.entry.bends()) {
            text.push_str(NOT_CHECKED);
        }
        if !assumed.is_empty() {
            text.push_str("Assumptions that these times rest on, and no recording:\n");
        }
        for (index, assumption) in assumed.iter().enumerate() {
            let _ = writeln!(text, "  {}  {assumption}", letter(index).unwrap_or_default());
        }
        text
    }
}

/// Letter of an assumption in the table.
fn letter(index: usize) -> Option<char> {
    ('a'..='z').nth(index)
}
