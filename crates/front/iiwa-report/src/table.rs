//! Tables for the terminal.

use std::fmt::Write as _;

use comfy_table::{Cell, CellAlignment, ContentArrangement, LineStyle, Table, presets};
use iiwa_kin::part_name;
use iiwa_plan::{
    AssumptionRecord, ClearanceRecord, EnergyRecord, LateBlendRecord, LimitRecord,
    LimitShareRecord, MotionRecord, PlanFigures, PowerRecord, SelfClearanceRecord,
};

use iiwa_json::printable;

/// Number of motions shown at the start and at the end of a long program.
const SHOWN: usize = 100;

/// Width of a plan table: that of the narrowest usual terminal. Longer cells are wrapped.
const WIDTH: u16 = 80;

/// Creates a table with a header; columns of numbers are right-aligned.
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
            "source",
            "question",
            "answer",
            "option",
            "application",
            "line",
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
            "trend",
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

/// Adds a row per motion; for a long program, only for the first and the last ones.
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

/// Formats the figures of a plan as a table.
#[must_use]
pub fn plan_table(figures: &PlanFigures) -> String {
    let mut head = vec!["motion", "type", "start s", "time s", "top %"];
    let has_tcp = figures.motions.iter().any(|motion| motion.cartesian.is_some());
    if has_tcp {
        head.push("TCP mm/s");
    }
    let has_source = figures.motions.iter().any(|motion| motion.source.is_some());
    if has_source {
        head.push("source");
    }
    head.push("limited by, % of its time");
    let mut table = table(&head);
    table.set_content_arrangement(ContentArrangement::Dynamic).set_width(WIDTH);
    shortened(&mut table, &figures.motions, |table, row| add(table, row, has_tcp, has_source));
    let mut text = format!("{}\n\n", table.trim_fmt());
    let PlanFigures { cycle_time_s, motion_time_s, settle_time_s, wait_time_s, .. } = figures;
    let _ = writeln!(
        text,
        "Cycle time {cycle_time_s:.3} s = {motion_time_s:.3} s motion + {settle_time_s:.3} s \
         settling + {wait_time_s:.3} s waiting"
    );
    shortened_lines(&mut text, &figures.blends_too_late, late_blend);
    let mut limits = vec!["velocity", "acceleration"];
    limits.extend((figures.timing != "acceleration").then_some("jerk"));
    let torque = figures.limit_torque_percent.map(|percent| format!("torque ({percent} %)"));
    limits.extend(torque.as_deref());
    let _ = writeln!(text, "Planned for {}; limits: {}", figures.robot, limits.join(", "));
    if figures.timing == "sunrise" {
        text.push_str("PTP motions from rest to rest: timing as recorded under Sunrise\n");
        if figures.motions.iter().any(|motion| ["spline", "spl"].contains(&&*motion.r#type)) {
            text.push_str(
                "Splines: a model of Sunrise, which exceeds acceleration and jerk limits\n",
            );
        }
    }
    if let Some(percent) = figures.override_percent {
        let _ =
            writeln!(text, "Override {percent} %: slows down motions, but not pauses and waits");
    }
    if let Some(largest) = figures.largest_torque() {
        let _ = writeln!(text, "Largest torque: {largest}");
    }
    if let (Some(EnergyRecord { positive, negative }), Some(power)) =
        (&figures.energy_j, &figures.power)
    {
        let [delivered, absorbed] = [positive, negative].map(|work| work.iter().sum::<f64>().abs());
        let PowerRecord { peak_w, at_s } = power;
        let _ = writeln!(
            text,
            "Joints (link side): {delivered:.1} J delivered, {absorbed:.1} J absorbed, peak power \
             {peak_w:.0} W at {at_s:.3} s"
        );
    }
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

/// Formats the assumptions about the controller that the time depends on, one line each.
#[must_use]
pub fn assumption_lines(rests_on: &[AssumptionRecord]) -> String {
    let mut text = String::new();
    for AssumptionRecord { what, motions, first, .. } in rests_on {
        let total = match motions {
            1 => format!("motion {first}"),
            more => format!("{more} motions, the first is {first}"),
        };
        let _ = writeln!(text, "Assumed of {total}: {what}");
    }
    if text.is_empty() {
        text.push_str("Nothing assumed of the controller: the time rests on what was recorded\n");
    }
    text
}

/// Adds a line per entry, or for the first entries of a long list.
fn shortened_lines<T>(text: &mut String, all: &[T], line: impl Fn(&T) -> String) {
    /// Maximum number of lines.
    const NAMED: usize = 10;
    for one in all.iter().take(NAMED) {
        let _ = writeln!(text, "{}", line(one));
    }
    if all.len() > NAMED {
        let _ = writeln!(text, "and {} more in the JSON output", all.len() - NAMED);
    }
}

/// Describes a blend that the arm could not pass without stopping.
fn late_blend(late: &LateBlendRecord) -> String {
    let LateBlendRecord { after_motion, known_s, needed_s } = late;
    format!(
        "Blend after motion {after_motion} missed: the next motion is known at {known_s:.3} s, but \
         was needed by {needed_s:.3} s"
    )
}

/// Describes the clearance between the arm and an obstacle.
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

/// Describes the clearance of the arm to itself.
fn self_clearance(nearest: &SelfClearanceRecord) -> String {
    let SelfClearanceRecord { distance_mm, link, other_link, at_s } = nearest;
    let [part, other] = [*link, *other_link].map(part_name);
    if *distance_mm == 0.0 {
        format!("The arm touches itself: {part} and {other} at {at_s:.3} s")
    } else {
        format!("Arm from itself {distance_mm:.1} mm: {part} to {other} at {at_s:.3} s")
    }
}

/// Lists the relevant active limits of a motion with their shares of its time.
fn limits(first: &LimitRecord, all: &[LimitShareRecord]) -> String {
    /// Smallest share of the time that is shown.
    const SHOWN_SHARE: f64 = 0.05;
    let shown: Vec<_> = all
        .iter()
        .filter(|limit| limit.share >= SHOWN_SHARE)
        .take(2)
        .map(|limit| format!("{} {:.0}", limit.limit, 100.0 * limit.share))
        .collect();
    if shown.is_empty() { first.to_string() } else { shown.join(", ") }
}

/// Adds a row; with the top TCP speed, and with the source of the motion if any motion has one.
fn add(table: &mut Table, row: &MotionRecord, has_tcp: bool, has_source: bool) {
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
    if has_source {
        // Omits the folders, which would fill the width of the table.
        let short = |source: String| source.rsplit('/').next().unwrap_or_default().to_owned();
        let source = row.source.as_ref().map(|source| printable(&short(source.to_string())));
        cells.push(Cell::new(source.unwrap_or_default()));
    }
    cells.push(Cell::new(limited_by.unwrap_or_default()));
    table.add_row(cells);
}
