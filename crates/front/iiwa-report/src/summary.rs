//! Results of many programs in one table.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write as _,
};

use comfy_table::Cell;
use iiwa_plan::PlanFigures;

use crate::table::{fitted, table};
use iiwa_json::printable;
use iiwa_plan::PlanGates;

/// Result of one program.
#[derive(Clone, Debug)]
pub struct SummaryRow {
    /// Name of the program.
    pub program: String,
    /// Times of the plan; `None` if planning failed.
    pub times: Option<PlannedTimes>,
    /// `true` if the cycle time exceeds its limit.
    pub too_long: bool,
    /// `true` if the clearance to an obstacle falls below its limit.
    pub too_near: bool,
    /// `true` if a joint torque exceeds its limit.
    pub overloaded: bool,
}

impl SummaryRow {
    /// Creates the result of a program that was not planned.
    #[must_use]
    pub fn failed(program: String) -> Self {
        let [too_long, too_near, overloaded] = [false; 3];
        Self { program, times: None, too_long, too_near, overloaded }
    }

    fn result(&self) -> String {
        if self.times.is_none() {
            return "failed".to_owned();
        }
        let unmet = [
            (self.too_long, "too long"),
            (self.too_near, "too near"),
            (self.overloaded, "overloaded"),
        ];
        let unmet: Vec<_> = unmet
            .into_iter()
            .filter_map(|(is_unmet, message)| is_unmet.then_some(message))
            .collect();
        if unmet.is_empty() { "planned".to_owned() } else { unmet.join(", ") }
    }
}

/// Times of a planned program; the size of this value does not grow with the program.
#[derive(Clone, Debug)]
pub struct PlannedTimes {
    motions: usize,
    cycle_s: f64,
    motion_s: f64,
    standing_s: f64,
    limited_by: Option<String>,
    clearance_mm: Option<f64>,
    torque_percent: Option<f64>,
    assumptions: Vec<String>,
}

impl From<&PlanFigures> for PlannedTimes {
    fn from(figures: &PlanFigures) -> Self {
        Self {
            motions: figures.motions.len(),
            cycle_s: figures.cycle_time_s,
            motion_s: figures.motion_time_s,
            standing_s: figures.settle_time_s + figures.wait_time_s,
            limited_by: longest_limit(figures),
            clearance_mm: figures.clearance.as_ref().map(|nearest| nearest.distance_mm),
            torque_percent: figures.largest_torque().map(|largest| largest.percent),
            assumptions: figures
                .assumptions
                .iter()
                .map(|assumption| format!("{}: {assumption}", figures.robot))
                .collect(),
        }
    }
}

/// Returns the limit with the longest total time of motions.
fn longest_limit(figures: &PlanFigures) -> Option<String> {
    let mut times = BTreeMap::new();
    for motion in &figures.motions {
        if let Some(limit) = &motion.limited_by {
            let (time_s, _) = times.entry((limit.joint, &*limit.kind)).or_insert((0.0, limit));
            *time_s += motion.end_s - motion.start_s;
        }
    }
    let longest = times.into_values().max_by(|(a, _), (b, _)| a.total_cmp(b));
    longest.map(|(_, limit)| limit.to_string())
}

/// Results of all programs.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    rows: Vec<SummaryRow>,
    /// Limits without a source, each with its robot.
    assumptions: BTreeSet<String>,
}

impl Summary {
    /// Adds the next program.
    pub fn add(&mut self, mut row: SummaryRow) {
        if let Some(times) = &mut row.times {
            self.assumptions.extend(std::mem::take(&mut times.assumptions));
        }
        self.rows.push(row);
    }

    /// Number of programs so far.
    #[must_use]
    pub fn programs(&self) -> usize {
        self.rows.len()
    }

    /// Describes the failures, if any: failed programs, and violated gates.
    #[must_use]
    pub fn complaint(&self, gates: &PlanGates) -> Option<String> {
        let count = self.programs();
        let mut unmet = Vec::new();
        if self.failed() > 0 {
            unmet.push(format!("{} of {count} programs failed", self.failed()));
        }
        let too_long = self.rows.iter().filter(|row| row.too_long).count();
        if let (Some(limit), 1..) = (gates.max_cycle_time_s, too_long) {
            unmet.push(format!("{too_long} of {count} programs over {limit} s"));
        }
        let too_near = self.rows.iter().filter(|row| row.too_near).count();
        if let (Some(limit), 1..) = (gates.min_clearance_mm, too_near) {
            unmet.push(format!("{too_near} of {count} programs with a clearance below {limit} mm"));
        }
        let overloaded = self.rows.iter().filter(|row| row.overloaded).count();
        if let (Some(limit), 1..) = (gates.max_torque_percent, overloaded) {
            unmet.push(format!(
                "{overloaded} of {count} programs over {limit} % of a joint's torque"
            ));
        }
        (!unmet.is_empty()).then(|| unmet.join(", "))
    }

    /// Number of failed programs.
    #[must_use]
    pub fn failed(&self) -> usize {
        self.rows.iter().filter(|row| row.times.is_none()).count()
    }

    fn times(&self) -> impl Iterator<Item = &PlannedTimes> {
        self.rows.iter().filter_map(|row| row.times.as_ref())
    }

    /// Formats a row per program, and the totals. Cells are wrapped to lines of at most `width`
    /// characters; see [`fitted`].
    #[must_use]
    pub fn text(&self, width: Option<u16>) -> String {
        let mut head = vec![
            "program",
            "motions",
            "cycle time s",
            "motion s",
            "at rest s",
            "limited by",
            "torque %",
        ];
        let clearances = self.times().any(|times| times.clearance_mm.is_some());
        if clearances {
            head.push("clearance mm");
        }
        head.push("result");
        let mut table = table(&head);
        for row in &self.rows {
            let mut cells = vec![printable(&row.program)];
            let figures = row.times.as_ref().map(|times| {
                [
                    times.motions.to_string(),
                    format!("{:.3}", times.cycle_s),
                    format!("{:.3}", times.motion_s),
                    format!("{:.3}", times.standing_s),
                    times.limited_by.clone().unwrap_or_default(),
                    times.torque_percent.map(|percent| format!("{percent:.1}")).unwrap_or_default(),
                ]
            });
            cells.extend(figures.unwrap_or_default());
            if clearances {
                let clearance_mm = row.times.as_ref().and_then(|times| times.clearance_mm);
                cells.push(clearance_mm.map(|mm| format!("{mm:.1}")).unwrap_or_default());
            }
            cells.push(row.result());
            table.add_row(cells.into_iter().map(Cell::new));
        }
        let mut text = format!("{}\n\n", fitted(table, width));
        let _ = writeln!(
            text,
            "{} planned, {} failed; cycle times together {:.3} s",
            self.times().count(),
            self.failed(),
            // Starts at 0.0: an empty sum is -0.0.
            self.times().fold(0.0, |sum, times| sum + times.cycle_s)
        );
        for assumption in &self.assumptions {
            let _ = writeln!(text, "Assumed, not from a source, of {assumption}");
        }
        text
    }
}
