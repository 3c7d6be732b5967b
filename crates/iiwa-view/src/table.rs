//! Tables on the terminal.

use std::fmt::Write as _;

use comfy_table::{Cell, CellAlignment, ContentArrangement, LineStyle, Table, presets};
use iiwa_log::{
    ClearanceRecord, LimitRecord, LimitShareRecord, MotionRecord, PlanFigures, SelfClearanceRecord,
};
use iiwa_scene::part_name;

use crate::printable;

/// Motions that are shown at the start and at the end of a long program.
const SHOWN: usize = 100;

/// Width of a plan's table: that of the narrowest terminal that is usual. Longer cells are wrapped.
const WIDTH: u16 = 80;

/// A table with a head; columns of numbers are aligned to the right.
#[must_use]
pub fn table(head: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::NOTHING.header_separator(LineStyle::none().fill('─').junction('─')));
    table.set_header(head.iter().copied());
    for (index, title) in head.iter().enumerate() {
        let words = [
            "",
            "name",
            "direction",
            "value",
            "type",
            "limited by",
            "limited by, % of its time",
            "robot",
            "quantity",
            "unit",
            "program",
            "result",
            "tool",
            "TCP",
            "tips",
            "frame",
            "used as",
            "taught with",
            "check",
            "not taken",
            "renamed",
            "to",
            "why",
        ];
        if let Some(column) = table.column_mut(index) {
            column.set_padding((0, u16::from(index + 1 < head.len())));
            if !words.contains(title) {
                column.set_cell_alignment(CellAlignment::Right);
            }
        }
    }
    table
}

/// Adds a row for each motion; of a long program, for the first and the last ones.
pub(crate) fn shortened<T>(table: &mut Table, rows: &[T], mut add: impl FnMut(&mut Table, &T)) {
    let hidden = rows.len().saturating_sub(2 * SHOWN);
    for (index, row) in rows.iter().enumerate() {
        if hidden == 0 || index < SHOWN || index >= rows.len() - SHOWN {
            add(table, row);
        } else if index == SHOWN {
            table.add_row(["...".to_owned(), format!("{hidden} more in the JSON output")]);
        }
    }
}

/// The figures of a plan, for people.
#[must_use]
pub fn plan_table(figures: &PlanFigures) -> String {
    let mut head = vec!["motion", "type", "start s", "time s", "top %"];
    let has_tcp = figures.motions.iter().any(|motion| motion.cartesian.is_some());
    if has_tcp {
        head.push("TCP mm/s");
    }
    head.push("limited by, % of its time");
    let mut table = table(&head);
    table.set_content_arrangement(ContentArrangement::Dynamic).set_width(WIDTH);
    shortened(&mut table, &figures.motions, |table, row| add(table, row, has_tcp));
    let mut text = format!("{}\n\n", table.trim_fmt());
    let PlanFigures { cycle_time_s, motion_time_s, settle_time_s, wait_time_s, .. } = figures;
    let _ = writeln!(
        text,
        "Cycle time {cycle_time_s:.3} s = {motion_time_s:.3} s motion + {settle_time_s:.3} s settling \
         + {wait_time_s:.3} s waiting"
    );
    let _ = writeln!(
        text,
        "{}, limits of {}",
        figures.robot,
        match &*figures.timing {
            "acceleration" => "velocity and acceleration",
            "jerk" => "velocity, acceleration and jerk",
            other => other,
        }
    );
    if let Some(nearest) = &figures.clearance {
        let _ = writeln!(text, "{}", clearance(nearest));
    }
    if let Some(nearest) = &figures.self_clearance {
        let _ = writeln!(text, "{}", self_clearance(nearest));
    }
    for assumption in &figures.assumptions {
        let _ = writeln!(text, "Assumed, not from a source: {assumption}");
    }
    text
}

/// How near the arm comes to what.
fn clearance(nearest: &ClearanceRecord) -> String {
    let ClearanceRecord { distance_mm, link, obstacle, at_s } = nearest;
    let part = part_name(*link);
    let obstacle = printable(obstacle);
    if *distance_mm == 0.0 {
        format!("Clearance none: {part} touches {obstacle} at {at_s:.3} s")
    } else {
        format!("Clearance {distance_mm:.1} mm: {part} to {obstacle} at {at_s:.3} s")
    }
}

/// How near the arm comes to itself.
fn self_clearance(nearest: &SelfClearanceRecord) -> String {
    let SelfClearanceRecord { distance_mm, link, other_link, at_s } = nearest;
    let [part, other] = [*link, *other_link].map(part_name);
    if *distance_mm == 0.0 {
        format!("The arm touches itself: {part} and {other} at {at_s:.3} s")
    } else {
        format!("Arm from itself {distance_mm:.1} mm: {part} to {other} at {at_s:.3} s")
    }
}

/// What a motion is limited by and for how long, as far as it matters.
fn limits(first: &LimitRecord, all: &[LimitShareRecord]) -> String {
    /// Shares of the time below which a limit is left out.
    const SHOWN_SHARE: f64 = 0.05;
    let shown: Vec<_> = all
        .iter()
        .filter(|limit| limit.share >= SHOWN_SHARE)
        .take(2)
        .map(|limit| format!("{} {:.0}", limit.limit, 100.0 * limit.share))
        .collect();
    if shown.is_empty() { first.to_string() } else { shown.join(", ") }
}

/// A row; with the TCP's top speed if any motion has one.
fn add(table: &mut Table, row: &MotionRecord, has_tcp: bool) {
    let limit = row.limited_by.as_ref();
    let limited_by = limit.map(|limit| limits(limit, &row.limits));
    let speed = limit.map(|_| format!("{:.1}", 100.0 * row.peak_velocity_rel));
    let mut cells = vec![
        Cell::new(row.index),
        Cell::new(&row.r#type),
        Cell::new(format!("{:.3}", row.start_s)),
        Cell::new(format!("{:.3}", row.end_s - row.start_s)),
        Cell::new(speed.unwrap_or_default()),
    ];
    if has_tcp {
        let tcp = row.cartesian.as_ref();
        cells.push(Cell::new(
            tcp.map(|tcp| format!("{:.1}", tcp.tcp_speed_peak_mm_s)).unwrap_or_default(),
        ));
    }
    cells.push(Cell::new(limited_by.unwrap_or_default()));
    table.add_row(cells);
}
