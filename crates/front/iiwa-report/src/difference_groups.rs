//! Groups of motions in the difference of two plans.

use comfy_table::Table;
use iiwa_eval::GroupDifference;
use iiwa_json::printable;
use iiwa_plan::GroupRecord;
use serde::Serialize;

use crate::{
    signed::{rounded, signed},
    table::{shortened, table},
};

/// Group of motions of the old plan, of the new plan, or of both.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct GroupRow {
    name: String,
    /// `null` if a plan lacks the group.
    old: Option<GroupSide>,
    new: Option<GroupSide>,
}

/// Group in one of the plans.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct GroupSide {
    /// Number of motions, waits, inputs and outputs.
    motions: usize,
    /// Sum of the times of the motions, in s, without the settling after stops.
    duration_s: f64,
}

impl GroupSide {
    fn new(group: &GroupRecord) -> Self {
        Self { motions: group.motions, duration_s: rounded(group.duration_s, 9) }
    }
}

impl GroupRow {
    pub(crate) fn new(difference: &GroupDifference) -> Self {
        let GroupDifference { name, old, new } = difference;
        let [old, new] = [old, new].map(|side| side.as_ref().map(GroupSide::new));
        Self { name: name.clone(), old, new }
    }

    /// Returns true if a plan lacks the group, or if its number of motions differs, or its time by
    /// `least_s` or more.
    pub(crate) fn differs(&self, least_s: f64) -> bool {
        match (self.old, self.new) {
            (Some(old), Some(new)) => {
                old.motions != new.motions || self.change_s().abs() >= least_s
            }
            _ => true,
        }
    }

    fn change_s(&self) -> f64 {
        let [old, new] = [self.old, self.new].map(|side| side.map_or(0.0, |side| side.duration_s));
        new - old
    }

    fn cells(&self) -> [String; 6] {
        let sides = [self.old, self.new];
        let [old_motions, new_motions] =
            sides.map(|side| side.map(|side| side.motions.to_string()).unwrap_or_default());
        let [old_s, new_s] = sides
            .map(|side| side.map(|side| format!("{:.3}", side.duration_s)).unwrap_or_default());
        let change_s = signed(self.change_s(), 3);
        [printable(&self.name), old_motions, new_motions, old_s, new_s, change_s]
    }
}

/// Returns the table of some groups; `format` formats the cells.
pub(crate) fn group_table<'g>(
    groups: impl Iterator<Item = &'g GroupRow>,
    format: impl Fn(&str) -> String,
) -> Table {
    let head = ["group", "old motions", "new motions", "old s", "new s", "change s"];
    let mut table = table(&head);
    let groups: Vec<_> = groups.collect();
    shortened(&mut table, &groups, |table, row| {
        table.add_row(row.cells().iter().map(|cell| format(cell)));
    });
    table
}
