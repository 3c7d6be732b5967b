//! Changes that make a program faster, as text and as JSON.

use std::fmt::Write as _;

use iiwa_json::printable;
use iiwa_optimise::{Advice, ChangeKind};
use iiwa_program::Program;
use serde::Serialize;

use crate::{
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

/// A change of a program.
#[derive(Clone, Debug, Serialize)]
struct ChangeRow {
    /// Number of the row, from 1.
    row: usize,
    /// Number of the motion that changes, from 1; of several motions the first.
    motion: usize,
    /// Number of the last motion that changes.
    last_motion: usize,
    /// Name of the motion, if it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    /// Source line, if known.
    #[serde(skip_serializing_if = "Option::is_none")]
    source: Option<String>,
    /// `elbow`, `blend`, `full_speed` or `no_wait_for_end`.
    kind: &'static str,
    /// Text of the change, with the values before and after it.
    change: String,
    /// Time that the change saves alone.
    saved_s: f64,
    /// Time that it saves after all changes before it.
    saved_on_top_s: f64,
}

impl AdviceReport {
    /// Creates the report of an advice for `program`. `is_checked` says whether the changes were
    /// checked for collisions.
    #[must_use]
    pub fn new(advice: &Advice, program: &Program, is_checked: bool) -> Self {
        let changes = advice.rows.iter().zip(1..).map(|(found, row)| {
            let change = &found.change;
            let (kind, last) = match &change.kind {
                ChangeKind::Elbow { last, .. } => ("elbow", *last),
                ChangeKind::Blend { .. } => ("blend", change.motion),
                ChangeKind::FullSpeed { .. } => ("full_speed", change.motion),
                _ => ("no_wait_for_end", change.motion),
            };
            let label = program.sources.label(change.motion);
            ChangeRow {
                row,
                motion: change.motion.number(),
                last_motion: last.number(),
                name: label.and_then(|label| label.name.clone()),
                source: program.sources.of(change.motion).map(ToString::to_string),
                kind,
                change: change.to_string(),
                saved_s: rounded(found.saved_s, 9),
                saved_on_top_s: rounded(found.saved_on_top_s, 9),
            }
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
        let has_name = changes.iter().any(|change| change.name.is_some());
        let has_source = changes.iter().any(|change| change.source.is_some());
        let mut head = vec!["row", "motion"];
        head.extend(has_name.then_some("name"));
        head.extend(has_source.then_some("source"));
        head.extend(["change", "saves s", "on top s"]);
        let mut rows = table(&head);
        for change in changes {
            let mut cells = vec![change.row.to_string(), change.motion.to_string()];
            let shown = |text: &Option<String>| printable(text.as_deref().unwrap_or_default());
            if has_name {
                cells.push(shown(&change.name));
            }
            if has_source {
                let source = shown(&change.source);
                cells.push(source.rsplit('/').next().unwrap_or_default().to_owned());
            }
            cells.push(change.change.clone());
            cells.extend([change.saved_s, change.saved_on_top_s].map(|time| format!("{time:.3}")));
            rows.add_row(cells);
        }
        let mut text = fitted(rows, width);
        let percent = 100.0 * (changed_cycle_time_s / cycle_time_s - 1.0);
        let _ = write!(
            text,
            "\n\nCycle time {cycle_time_s:.3} s; with all changes {changed_cycle_time_s:.3} s \
             ({percent:.1} %)\n"
        );
        let bends = |change: &ChangeRow| matches!(change.kind, "elbow" | "blend");
        if !self.checked_for_collisions && changes.iter().any(bends) {
            text.push_str(
                "Changes of E1 and of blends are not checked for collisions: that needs a scene.\n",
            );
        }
        text
    }
}
