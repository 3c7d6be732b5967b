//! The fastest order of tasks, as text and as JSON.

use std::fmt::Write as _;

use iiwa_json::printable;
use iiwa_optimise::OrderedTasks;
use iiwa_program::{MotionIndex, Program};
use serde::Serialize;

use crate::{
    signed::rounded,
    table::{fitted, table},
};

/// The fastest order of tasks that was found. As JSON, this is the object of
/// `iiwasim order --json`.
#[derive(Clone, Debug, Serialize)]
pub struct OrderReport {
    cycle_time_s: f64,
    changed_cycle_time_s: f64,
    /// `true` if the order was checked for collisions with a scene.
    checked_for_collisions: bool,
    /// `true` if all allowed orders were compared.
    all_compared: bool,
    /// Number of plans that were compared.
    plans: u64,
    /// Tasks in the fastest order.
    tasks: Vec<OrderedTask>,
}

/// A task in the fastest order.
#[derive(Clone, Debug, Serialize)]
struct OrderedTask {
    /// Its place in the program as it is, from 1.
    was: usize,
    /// Its group of motions.
    group: String,
    /// Numbers of its first and last motion in the program as it is, from 1.
    motions: [usize; 2],
}

impl OrderReport {
    /// Creates the report of an order of the tasks of `program`. `is_checked` says whether the
    /// order was checked for collisions.
    #[must_use]
    pub fn new(found: &OrderedTasks, program: &Program, is_checked: bool) -> Self {
        let tasks = program.tasks().unwrap_or_default();
        let row = |index: &usize| {
            let task = tasks.get(*index)?;
            let motions = [task.entries.start, task.entries.end.saturating_sub(1)];
            Some(OrderedTask {
                was: index + 1,
                group: task.group.clone(),
                motions: motions.map(|motion| MotionIndex::new(motion).number()),
            })
        };
        Self {
            cycle_time_s: rounded(found.cycle_time_s, 9),
            changed_cycle_time_s: rounded(found.changed_cycle_time_s, 9),
            checked_for_collisions: is_checked,
            all_compared: found.is_exact,
            plans: found.plans,
            tasks: found.order.iter().filter_map(row).collect(),
        }
    }

    /// Returns true if the fastest order is not that of the program.
    fn is_changed(&self) -> bool {
        self.tasks.iter().enumerate().any(|(index, task)| task.was != index + 1)
    }

    /// Writes the report as text, with a table that is at most `width` columns wide, if given.
    #[must_use]
    pub fn text(&self, width: Option<u16>) -> String {
        let Self { cycle_time_s, changed_cycle_time_s: changed_s, plans, tasks, .. } = self;
        let compared = if self.all_compared {
            "all allowed orders compared"
        } else {
            "not all orders compared: a faster one may exist"
        };
        let mut text = String::new();
        if self.is_changed() {
            let mut rows = table(&["place", "was", "task", "motions"]);
            for (index, OrderedTask { was, group, motions: [first, last] }) in
                tasks.iter().enumerate()
            {
                let motions =
                    if first == last { first.to_string() } else { format!("{first} to {last}") };
                let [place, was] = [index + 1, *was].map(|number| number.to_string());
                rows.add_row([place, was, printable(group), motions]);
            }
            let percent = 100.0 * (changed_s / cycle_time_s - 1.0);
            let _ = writeln!(
                text,
                "{}\n\nCycle time {cycle_time_s:.3} s before, {changed_s:.3} s in this order: \
                 {:+.3} s ({percent:+.1} %)",
                fitted(rows, width),
                changed_s - cycle_time_s
            );
        } else {
            let _ = writeln!(
                text,
                "No other order{} saves a millisecond of the cycle time of {cycle_time_s:.3} s",
                if self.checked_for_collisions { " that keeps the clearances" } else { "" }
            );
        }
        let _ = writeln!(text, "{plans} plans; {compared}");
        if self.is_changed() && !self.checked_for_collisions {
            text.push_str("The order is not checked for collisions: that needs a scene.\n");
        }
        text
    }
}
