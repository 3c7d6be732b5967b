//! Changes of a program, as rows of a table and as JSON.

use iiwa_json::printable;
use iiwa_optimise::{Change, ChangeKind};
use iiwa_program::Program;
use serde::Serialize;

/// A change of a program.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct ChangeEntry {
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
    /// `elbow`, `blend`, `full_speed`, `overlap_wait` or `no_wait_for_end`.
    kind: &'static str,
    /// Text of the change, with the values before and after it.
    change: String,
}

impl ChangeEntry {
    pub(crate) fn new(change: &Change, program: &Program) -> Self {
        let kind = match change.kind {
            ChangeKind::Elbow { .. } => "elbow",
            ChangeKind::Blend { .. } => "blend",
            ChangeKind::FullSpeed { .. } => "full_speed",
            ChangeKind::OverlapWait { .. } => "overlap_wait",
            _ => "no_wait_for_end",
        };
        let label = program.sources.label(change.motion);
        Self {
            motion: change.motion.number(),
            last_motion: change.last().number(),
            name: label.and_then(|label| label.name.clone()),
            source: program.sources.of(change.motion).map(ToString::to_string),
            kind,
            change: change.to_string(),
        }
    }

    /// Returns true if the arm takes another path.
    pub(crate) fn bends(&self) -> bool {
        matches!(self.kind, "elbow" | "blend")
    }
}

/// Columns of changes: names and source lines only if a change has any.
pub(crate) struct ChangeColumns {
    has_name: bool,
    has_source: bool,
}

impl ChangeColumns {
    pub(crate) fn of<'a>(changes: impl Iterator<Item = &'a ChangeEntry>) -> Self {
        changes.fold(Self { has_name: false, has_source: false }, |columns, change| Self {
            has_name: columns.has_name || change.name.is_some(),
            has_source: columns.has_source || change.source.is_some(),
        })
    }

    pub(crate) fn head(&self) -> Vec<&'static str> {
        let mut head = vec!["motion"];
        head.extend(self.has_name.then_some("name"));
        head.extend(self.has_source.then_some("source"));
        head.push("change");
        head
    }

    pub(crate) fn cells(&self, change: &ChangeEntry) -> Vec<String> {
        let shown = |text: &Option<String>| printable(text.as_deref().unwrap_or_default());
        let mut cells = vec![change.motion.to_string()];
        if self.has_name {
            cells.push(shown(&change.name));
        }
        if self.has_source {
            cells.push(shown(&change.source).rsplit('/').next().unwrap_or_default().to_owned());
        }
        cells.push(change.change.clone());
        cells
    }
}

/// Changes as a table of texts.
#[derive(Clone, Debug, Serialize)]
pub struct ChangeTable {
    head: Vec<&'static str>,
    rows: Vec<Vec<String>>,
}

impl ChangeTable {
    pub(crate) fn new(changes: &[ChangeEntry]) -> Self {
        let columns = ChangeColumns::of(changes.iter());
        let rows = changes.iter().map(|change| columns.cells(change)).collect();
        Self { head: columns.head(), rows }
    }
}

/// Sentence for changes of the path that were not checked.
pub(crate) const NOT_CHECKED: &str =
    "Changes of E1 and of blends are not checked for collisions: that needs a scene.\n";
