//! Figures of a plan as text.

use std::{collections::HashSet, fmt::Write as _};

use comfy_table::Table;
use iiwa_json::printable;
use iiwa_kin::part_name;
use iiwa_plan::{
    AssumptionRecord, ClearanceRecord, EnergyRecord, GroupRecord, LateBlendRecord, LimitRecord,
    LimitShareRecord, LoadRecord, MotionRecord, PlanFigures, PowerRecord, RepeatRecord,
    SelfClearanceRecord,
};
use iiwa_program::{MotionType, Round};

use crate::{
    robot_sheet::rounded,
    table::{fitted, shortened, table},
};

/// Formats the figures of a plan as a table with sentences. Cells of the table are wrapped to lines
/// of at most `width` characters; see [`fitted`].
#[must_use]
pub fn plan_table(figures: &PlanFigures, width: Option<u16>) -> String {
    let mut head = vec!["motion", "type"];
    let rows = EntryRow::all(figures);
    let has_name = rows.iter().any(|row| row.name().is_some());
    if has_name {
        head.push("name");
    }
    let has_round = figures.motions.iter().any(|motion| !motion.rounds.is_empty());
    if has_round {
        head.push("round");
    }
    let has_io = figures.motions.iter().any(|motion| motion.io.is_some());
    if has_io {
        head.push("I/O");
    }
    head.extend(["start s", "time s", "top %"]);
    let has_tcp = figures.motions.iter().any(|motion| motion.cartesian.is_some());
    if has_tcp {
        head.push("TCP mm/s");
    }
    let has_source = rows.iter().any(|row| row.source().is_some());
    if has_source {
        head.push("source");
    }
    head.push("limited by, % of its time");
    let mut table = table(&head);
    let columns = [has_name, has_round, has_io, has_tcp, has_source];
    shortened(&mut table, &rows, |table, row| row.add(table, columns));
    let mut text = format!("{}\n\n", fitted(table, width));
    let PlanFigures { cycle_time_s, motion_time_s, settle_time_s, wait_time_s, .. } = figures;
    let _ = writeln!(
        text,
        "Cycle time {cycle_time_s:.3} s = {motion_time_s:.3} s motion + {settle_time_s:.3} s \
         settling + {wait_time_s:.3} s waiting"
    );
    shortened_lines(&mut text, &figures.blends_too_late, late_blend);
    text.push_str(&group_lines(&figures.groups, width));
    text.push_str(&repeat_lines(&figures.repeats, width));
    let mut limits = vec!["velocity", "acceleration"];
    limits.extend((figures.timing != "acceleration").then_some("jerk"));
    let torque = figures.limit_torque_percent.map(|percent| format!("torque ({percent} %)"));
    limits.extend(torque.as_deref());
    let _ = writeln!(text, "Planned for {}; limits: {}", figures.robot, limits.join(", "));
    if figures.timing == "sunrise" {
        if let Some(line) = recorded_timing(figures) {
            let _ = writeln!(text, "{line}");
        }
        if figures.motions.iter().any(|motion| ["spline", "spl"].contains(&&*motion.r#type)) {
            text.push_str(
                "Splines: a model of Sunrise, which exceeds acceleration and jerk limits\n",
            );
        }
    }
    if let Some(mode) = &figures.mode {
        let speed = figures
            .t1_speed_mm_s
            .map(|mm_s| format!(": TCP and flange are limited to {} mm/s", rounded(mm_s)));
        let _ = writeln!(
            text,
            "Operating mode {}{}",
            printable(&mode.to_uppercase()),
            speed.unwrap_or_default()
        );
    }
    if let Some(percent) = figures.override_percent {
        let _ = writeln!(
            text,
            "Override {percent} %: slows down motions, but neither standstill after stops nor waits"
        );
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
        let _ = writeln!(text, "{}", clearance(nearest, figures));
    }
    if let Some(nearest) = &figures.self_clearance {
        let _ = writeln!(text, "{}", self_clearance(nearest, figures));
    }
    text.push_str(&assumed_inputs(figures).unwrap_or_default());
    for assumption in &figures.assumptions {
        let _ = writeln!(text, "Assumed, not from a source: {assumption}");
    }
    text
}

/// Describes the motions that are timed as recorded under Sunrise, PTP motions from rest to rest;
/// `None` if the plan has no such motion.
fn recorded_timing(figures: &PlanFigures) -> Option<String> {
    let blended: HashSet<usize> = figures.blends.iter().map(|blend| blend.after_motion).collect();
    let (mut moving, mut recorded) = (0, 0);
    let mut starts_at_rest = true;
    // Waits and motions without displacement have no speed.
    for motion in figures.motions.iter().filter(|motion| motion.peak_velocity_rel > 0.0) {
        let stops = !blended.contains(&motion.index);
        // With an active torque limit, a motion has no recorded timing.
        let torque_limited = motion.limits.iter().any(|active| active.limit.kind == "torque");
        moving += 1;
        if motion.r#type == "ptp" && starts_at_rest && stops && !torque_limited {
            recorded += 1;
        }
        starts_at_rest = stops;
    }
    match recorded {
        0 => None,
        all if all == moving => Some("Timing as recorded under Sunrise".to_owned()),
        some => Some(format!(
            "PTP motions from rest to rest ({some} of {moving} motions): timing as recorded under \
             Sunrise"
        )),
    }
}

/// Describes the assumed times of the waits for inputs; `None` if the plan has none of them.
fn assumed_inputs(figures: &PlanFigures) -> Option<String> {
    let waits = figures.motions.iter().filter(|row| row.r#type == MotionType::WaitFor.name());
    let first = waits.clone().next()?;
    let io = first.io_text().as_deref().map(printable).unwrap_or_default();
    let rests_s: f64 = waits.clone().map(|row| row.end_s - row.start_s).sum();
    let more = match waits.count() - 1 {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    Some(format!(
        "Assumed: the times until inputs have their values ({io}{more}), {rests_s:.3} s at rest\n"
    ))
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
        let _ = writeln!(text, "Assumption for {total}: {what}");
    }
    if text.is_empty() {
        text.push_str(
            "No assumptions about the controller: the time is based on recorded motions\n",
        );
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
fn clearance(nearest: &ClearanceRecord, figures: &PlanFigures) -> String {
    let ClearanceRecord { distance_mm, link, obstacle, at_s } = nearest;
    let part = part_name(*link);
    let obstacle = printable(obstacle);
    let place = printable(&figures.place_at(*at_s));
    if *distance_mm == 0.0 {
        format!("Clearance none: {part} touches {obstacle} {place}")
    } else {
        format!("Clearance {distance_mm:.1} mm: {part} to {obstacle} {place}")
    }
}

/// Describes the clearance of the arm to itself.
fn self_clearance(nearest: &SelfClearanceRecord, figures: &PlanFigures) -> String {
    let SelfClearanceRecord { distance_mm, link, other_link, at_s } = nearest;
    let [part, other] = [*link, *other_link].map(part_name);
    let place = printable(&figures.place_at(*at_s));
    if *distance_mm == 0.0 {
        format!("The arm touches itself: {part} and {other} {place}")
    } else {
        format!("Arm from itself {distance_mm:.1} mm: {part} to {other} {place}")
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

/// Row of a plan's table.
enum EntryRow<'a> {
    /// A motion or a wait.
    Motion(&'a MotionRecord),
    /// A change of the load, with its time in s.
    Load(&'a LoadRecord, f64),
}

impl<'a> EntryRow<'a> {
    /// Motions, waits and changes of the load, in the order of the program.
    fn all(figures: &'a PlanFigures) -> Vec<Self> {
        let mut rows = Vec::with_capacity(figures.motions.len() + figures.loads.len());
        let mut loads = figures.loads.iter().peekable();
        for motion in &figures.motions {
            while let Some(load) = loads.next_if(|load| load.index < motion.index) {
                rows.push(Self::Load(load, motion.start_s));
            }
            rows.push(Self::Motion(motion));
        }
        rows.extend(loads.map(|load| Self::Load(load, figures.cycle_time_s)));
        rows
    }

    fn name(&self) -> Option<&str> {
        match self {
            Self::Motion(motion) => motion.label.name.as_deref(),
            Self::Load(load, _) => load.label.name.as_deref(),
        }
    }

    /// Returns the source line, if known, without folders.
    fn source(&self) -> Option<String> {
        let source = match self {
            Self::Motion(motion) => motion.source.as_ref(),
            Self::Load(load, _) => load.source.as_ref(),
        };
        let source = source?.to_string();
        Some(printable(source.rsplit('/').next().unwrap_or_default()))
    }

    /// Rounds in repeat blocks; empty for a load.
    fn rounds(&self) -> String {
        let Self::Motion(motion) = self else { return String::new() };
        let round = |round: &Round| format!("{}/{}", round.number, round.count);
        motion.rounds.iter().map(round).collect::<Vec<_>>().join(" ")
    }

    /// Input or output with its value; empty for other rows.
    fn io(&self) -> String {
        let Self::Motion(motion) = self else { return String::new() };
        motion.io_text().as_deref().map(printable).unwrap_or_default()
    }

    /// Adds the row; with name, round, input or output, top TCP speed and source if any row has
    /// one.
    fn add(&self, table: &mut Table, columns: [bool; 5]) {
        let [has_name, has_round, has_io, has_tcp, has_source] = columns;
        let mut cells = match self {
            Self::Motion(motion) => vec![motion.index.to_string(), motion.r#type.to_string()],
            Self::Load(load, _) => {
                let mass = load.mass_kg.map(|mass_kg| format!("{} kg", rounded(mass_kg)));
                let mass = mass.as_deref().unwrap_or("removed");
                vec![load.index.to_string(), format!("load {mass}")]
            }
        };
        if has_name {
            cells.push(self.name().map(printable).unwrap_or_default());
        }
        if has_round {
            cells.push(self.rounds());
        }
        if has_io {
            cells.push(self.io());
        }
        let [tcp, limited_by] = match self {
            Self::Motion(motion) => {
                let limit = motion.limited_by.as_ref();
                let speed = limit.map(|_| format!("{:.1}", 100.0 * motion.peak_velocity_rel));
                cells.extend([
                    format!("{:.3}", motion.start_s),
                    format!("{:.3}", motion.end_s - motion.start_s),
                    speed.unwrap_or_default(),
                ]);
                let tcp = motion.cartesian.as_ref();
                [
                    tcp.map(|tcp| format!("{:.1}", tcp.tcp_speed_peak_mm_s)),
                    limit.map(|limit| limits(limit, &motion.limits)),
                ]
            }
            Self::Load(_, at_s) => {
                cells.extend([format!("{at_s:.3}"), String::new(), String::new()]);
                [None, None]
            }
        };
        if has_tcp {
            cells.push(tcp.unwrap_or_default());
        }
        if has_source {
            cells.push(self.source().unwrap_or_default());
        }
        cells.push(limited_by.unwrap_or_default());
        table.add_row(cells);
    }
}

/// Formats the times of groups as a table with remarks; empty without groups.
fn group_lines(groups: &[GroupRecord], width: Option<u16>) -> String {
    if groups.is_empty() {
        return String::new();
    }
    let mut table = table(&["group", "motions", "time s", "% of cycle"]);
    shortened(&mut table, groups, |table, group| {
        let GroupRecord { name, motions, duration_s, share, contiguous } = group;
        let name = printable(name);
        table.add_row([
            if *contiguous { name } else { format!("{name} *") },
            motions.to_string(),
            format!("{duration_s:.3}"),
            format!("{:.1}", 100.0 * share),
        ]);
    });
    let mut text = format!("\n{}\n\n", fitted(table, width));
    text.push_str("Time of a group: sum of its motions and waits, without settling after stops\n");
    if groups.iter().any(|group| !group.contiguous) {
        text.push_str("* Other motions lie between the motions of this group\n");
    }
    text
}

/// Formats the times of repeat blocks as a table with a remark; empty without blocks.
fn repeat_lines(repeats: &[RepeatRecord], width: Option<u16>) -> String {
    if repeats.is_empty() {
        return String::new();
    }
    let head = ["block", "from motion", "motions", "rounds", "time s", "% of cycle", "round s"];
    let mut table = table(&head);
    shortened(&mut table, repeats, |table, repeat| {
        let RepeatRecord { first_motion, motions, count, duration_s, share, .. } = repeat;
        let [min, max] = [repeat.min_round_s, repeat.max_round_s].map(|s| format!("{s:.3}"));
        let name = repeat.label.name.as_deref().map(printable).unwrap_or_default();
        table.add_row([
            format!("{}{name}", "> ".repeat(repeat.depth.saturating_sub(1))),
            first_motion.to_string(),
            motions.to_string(),
            count.to_string(),
            format!("{duration_s:.3}"),
            format!("{:.1}", 100.0 * share),
            if min == max { min } else { format!("{min} to {max}") },
        ]);
    });
    format!(
        "\n{}\n\nTime of a round: from the start of its first motion to the start of the motion \
         after the round, with settling after stops\n",
        fitted(table, width)
    )
}

#[cfg(test)]
mod tests {
    use iiwa_plan::{PlanRequest, ProgramSource};

    use super::*;

    const PROGRAM: &str = r#"{
        "version": 1,
        "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
        "motions": [
            { "type": "ptp", "joints_deg": [20, 0, 0, 0, 0, 0, 0] },
            { "type": "ptp", "joints_deg": [20, 20, 0, 0, 0, 0, 0] },
            { "type": "wait", "seconds": 0.1 },
            { "type": "ptp", "joints_deg": [20, 20, 0, 0, 0, 0, 0] },
            { "type": "ptp", "joints_deg": [0, 20, 0, 0, 0, 0, 0] }
        ]
    }"#;

    /// Tests programs with no, some and only PTP motions from rest to rest; one of the motions of
    /// `PROGRAM` has no displacement.
    #[test]
    fn recorded_timing_is_reported_for_ptp_motions_from_rest_to_rest_only() {
        let blended = PROGRAM.replacen(
            "[20, 0, 0, 0, 0, 0, 0] }",
            r#"[20, 0, 0, 0, 0, 0, 0], "blend": { "fraction": 0.25 } }"#,
            1,
        );
        let (head, _) = blended.split_once(r#"{ "type": "wait""#).unwrap();
        let all_blended = format!("{} ] }}", head.trim_end().trim_end_matches(','));
        let some =
            "PTP motions from rest to rest (1 of 3 motions): timing as recorded under Sunrise";
        let cases = [
            (PROGRAM, Some("Timing as recorded under Sunrise")),
            (blended.as_str(), Some(some)),
            (all_blended.as_str(), None),
        ];
        for (program, expected) in cases {
            let source = ProgramSource::from_json(program).unwrap();
            let figures = PlanRequest::default().plan(&source).unwrap().figures();
            assert_eq!(recorded_timing(&figures).as_deref(), expected, "{program}");
            let table = plan_table(&figures, None);
            assert_eq!(table.contains("as recorded under Sunrise"), expected.is_some(), "{table}");
        }
    }

    #[test]
    fn a_torque_limited_motion_has_no_recorded_timing() {
        let source = ProgramSource::from_json(PROGRAM).unwrap();
        let mut figures = PlanRequest::default().plan(&source).unwrap().figures();
        let limit = LimitRecord { joint: Some(2), kind: "torque".into() };
        figures.motions[1].limits.push(LimitShareRecord { limit, share: 0.5 });
        let line = recorded_timing(&figures).unwrap();
        assert!(line.contains("(2 of 3 motions)"), "{line}");
    }

    #[test]
    fn mode_and_place_of_the_clearance_are_stated() {
        let text = PROGRAM
            .replace("\"version\": 1,", "\"version\": 1, \"mode\": \"t1\",")
            .replacen("0] }", "0], \"name\": \"turn\" }", 2)
            .replacen("0], \"name\": \"turn\" }", "0] }", 1);
        let source = ProgramSource::from_json(&text).unwrap();
        let mut figures = PlanRequest::default().plan(&source).unwrap().figures();
        let at_s = figures.motions[0].start_s + 0.1;
        let obstacle = "column".to_owned();
        figures.add_clearance(ClearanceRecord { distance_mm: 12.0, link: 8, obstacle, at_s });
        let table = plan_table(&figures, None);
        let mode = "\nOperating mode T1: TCP and flange are limited to 225 mm/s\n";
        assert!(table.contains(mode), "{table}");
        let place = "\nClearance 12.0 mm: the tool to column at 0.100 s, in motion 1 \"turn\"\n";
        assert!(table.contains(place), "{table}");
        let source = ProgramSource::from_json(PROGRAM).unwrap();
        let figures = PlanRequest::default().plan(&source).unwrap().figures();
        assert!(!plan_table(&figures, None).contains("Operating mode"));
    }

    /// A load between two motions, one before the end, and a name of a load alone.
    #[test]
    fn loads_are_rows() {
        let load = |json: &str| format!(r#"{{ "type": "load", "load": {json} }},"#);
        let wait = r#"{ "type": "wait""#;
        let text = PROGRAM
            .replace(wait, &format!("{} {wait}", load(r#"{ "mass_kg": 4.2 }"#)))
            .replace("0, 0] }\n        ]", "0, 0] }, { \"type\": \"load\", \"load\": null } ]");
        let text = text.replacen("4.2 }", "4.2 }, \"name\": \"grip\"", 1);
        let source = ProgramSource::from_json(&text).unwrap();
        let plan = PlanRequest::default().plan(&source).unwrap();
        let figures = plan.figures();
        let table = plan_table(&figures, None);
        let wait = figures.motions.iter().find(|motion| motion.r#type == "wait").unwrap();
        let grip = format!("     3  load 4.2 kg   grip  {:>7.3}", wait.start_s);
        assert!(table.lines().any(|line| line == grip), "{table}");
        let last = format!("     7  load removed        {:>7.3}", figures.cycle_time_s);
        assert!(table.lines().any(|line| line == last), "{table}");
        // Section by section, the loads are the same.
        let planning = PlanRequest::default().begin(&source).unwrap();
        assert_eq!(planning.figures().loads, figures.loads);
    }

    #[test]
    fn names_and_groups_are_shown() {
        let (first, last) = PROGRAM.rsplit_once("[0, 20, 0, 0, 0, 0, 0] }").unwrap();
        let long = "approach above the left pallet";
        let named = format!(
            "{}[0, 20, 0, 0, 0, 0, 0], \"group\": \"pick\" }}{last}",
            first
                .replacen("0] }", &format!("0], \"name\": \"{long}\", \"group\": \"pick\" }}"), 2)
                .replace("0.1 }", "0.1, \"group\": \"hold\" }")
        );
        let plan = |text: &str| {
            PlanRequest::default().plan(&ProgramSource::from_json(text).unwrap()).unwrap().figures()
        };
        let plain = plan_table(&plan(PROGRAM), Some(80));
        assert!(plain.starts_with("motion  type  start s"), "{plain}");
        assert!(!plain.contains("group"), "{plain}");
        // The second name is that of the start pose.
        let named = named.replacen(&format!(", \"name\": \"{long}\", \"group\": \"pick\""), "", 1);
        let text = plan_table(&plan(&named), Some(80));
        assert!(text.starts_with("motion  type  name"), "{text}");
        assert!(text.contains("     1  ptp   approach above the "), "{text}");
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
        let rows: Vec<_> = text.lines().filter(|line| line.starts_with("pick *  ")).collect();
        assert!(rows[0].contains("      2  "), "{text}");
        assert!(text.contains("hold          1   0.100"), "{text}");
        assert!(text.contains("* Other motions lie between"), "{text}");
    }
}
