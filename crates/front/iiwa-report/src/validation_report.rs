//! Recording of a robot compared with the plan of its program, as a table with a score, for
//! sharing: it contains file names, but not their folders.

use std::{collections::HashMap, ffi::OsStr, fmt::Write as _, path::Path};

use comfy_table::Cell;
use iiwa_eval::{Comparison, MotionTime};
use iiwa_json::printable;
use iiwa_log::{JointLog, Loss};
use iiwa_plan::{AssumptionRecord, PlanFigures};
use iiwa_program::MotionType;
use serde::Serialize;

use crate::{
    plan_table::assumption_lines,
    signed::{rounded, signed},
    table::{fitted, shortened, table},
};

/// Recording compared with the plan of its program. As JSON, this is the object of `iiwasim
/// validate --json`.
#[derive(Clone, Debug, Serialize)]
pub struct ValidationReport {
    /// Version of iiwasim.
    version: &'static str,
    recording: String,
    program: String,
    robot: String,
    timing: String,
    override_percent: f64,
    /// Origin of the positions.
    positions: Option<String>,
    rate_hz: f64,
    noise_deg: f64,
    motions: Vec<ValidatedMotion>,
    /// Absolute errors over the motions that have a duration.
    score: Score,
    /// Assumptions of the plan that are not published figures.
    assumptions: Vec<String>,
    /// Assumptions about the controller.
    rests_on: Vec<AssumptionRecord>,
    /// Missing data and assumptions behind the figures.
    notes: Vec<String>,
}

/// Motion; durations are those at the override.
#[derive(Clone, Debug, Serialize)]
struct ValidatedMotion {
    index: usize,
    r#type: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    planned_s: f64,
    /// Measured duration; null if the recording does not show the motion.
    measured_s: Option<f64>,
    /// Planned minus measured, in per cent of the measured duration.
    error_percent: Option<f64>,
    /// Joint, from 1, that deviates most from the path, and its deviation; null without samples,
    /// and for waits.
    worst_joint: Option<usize>,
    joint_off_deg: Option<f64>,
    tcp_off_mm: Option<f64>,
}

/// Quality of the plan.
#[derive(Clone, Copy, Debug, Serialize)]
struct Score {
    /// Number of motions with a time error, without waits.
    motions: usize,
    time_percent: Option<Spread>,
    joint_off_deg: Option<Spread>,
    tcp_off_mm: Option<Spread>,
    /// Signed error of the whole program; both times include the plan's standstill at start and
    /// end.
    cycle_time_percent: f64,
}

/// Quantiles of absolute values: median, 95 % quantile and maximum.
#[derive(Clone, Copy, Debug, Serialize)]
struct Spread {
    median: f64,
    most: f64,
    worst: f64,
}

/// Threshold: if most motions deviate by more, the robot ran with other settings.
const SLOWER_PERCENT: f64 = -8.0;

/// Legend of the symbol for missing values.
pub(crate) const UNKNOWN: &str = "?: cannot be determined from the recording\n\n";

const PLAN: &str = "the recording is a plan: nothing of it was measured on a robot";

const SLOWER: &str = "most motions took far longer than planned: was the robot in T1, which caps \
    the speed of the flange, or at another override than stated?";

impl Spread {
    fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let mut all: Vec<f64> = values.map(f64::abs).collect();
        all.sort_by(f64::total_cmp);
        let worst = *all.last()?;
        // Smallest value that this percentage of the values does not exceed.
        let percentile = |percent: usize| all[(all.len() * percent).div_ceil(100).max(1) - 1];
        Some(Self { median: percentile(50), most: percentile(95), worst })
    }
}

impl ValidationReport {
    /// Creates the report on a recording and its program, each with its file.
    #[must_use]
    pub fn new(
        [recording, program]: [&Path; 2],
        log: &JointLog,
        figures: &PlanFigures,
        comparison: &Comparison,
    ) -> Self {
        let name = |path: &Path| {
            path.file_name().unwrap_or(OsStr::new("standard input")).to_string_lossy().into_owned()
        };
        let mut names: HashMap<_, _> = figures
            .motions
            .iter()
            .map(|motion| (motion.index, motion.label.name.clone()))
            .collect();
        let motions = comparison.motions.iter().map(|motion| {
            let name = names.remove(&motion.motion.number()).flatten();
            row(motion, name, comparison)
        });
        let motions: Vec<_> = motions.collect();
        let moving = || motions.iter().filter(|motion| moves(motion.r#type));
        let score = Score {
            motions: moving().filter(|motion| motion.error_percent.is_some()).count(),
            time_percent: Spread::of(moving().filter_map(|motion| motion.error_percent)),
            joint_off_deg: Spread::of(moving().filter_map(|motion| motion.joint_off_deg)),
            tcp_off_mm: Spread::of(moving().filter_map(|motion| motion.tcp_off_mm)),
            cycle_time_percent: comparison.cycle_time.error_percent,
        };
        let signed_errors = moving().filter_map(|motion| motion.error_percent);
        let slower = signed_errors.clone().filter(|percent| *percent < SLOWER_PERCENT).count();
        let plan = log.is_plan.then(|| PLAN.to_owned());
        let hint = (2 * slower > score.motions).then(|| SLOWER.to_owned());
        let read = log.losses.iter().filter(|loss| !matches!(loss, Loss::Gap { .. }));
        Self {
            version: env!("CARGO_PKG_VERSION"),
            recording: name(recording),
            program: name(program),
            robot: figures.robot.clone(),
            timing: figures.timing.to_string(),
            override_percent: figures.override_percent.unwrap_or(100.0),
            positions: log.source.map(|source| source.to_string()),
            rate_hz: 1.0 / comparison.step_s,
            noise_deg: comparison.noise_rad.to_degrees(),
            motions,
            score,
            assumptions: figures.assumptions.clone(),
            rests_on: figures.rests_on.clone(),
            notes: read
                .map(Loss::to_string)
                .chain(comparison.losses.clone())
                .chain(plan)
                .chain(hint)
                .collect(),
        }
    }

    /// Formats the report as a table and sentences. Cells of the table are wrapped to lines of at
    /// most `width` characters; see [`fitted`].
    #[must_use]
    pub fn text(&self, width: Option<u16>) -> String {
        let has_name = self.motions.iter().any(|row| row.name.is_some());
        let mut head = vec!["motion", "type"];
        head.extend(has_name.then_some("name"));
        head.extend(["planned s", "measured s", "error %", "joint off deg", "flange off mm"]);
        let mut rows = table(&head);
        let known = |value: Option<f64>, digits: u8| {
            let precision = usize::from(digits);
            let shown = |value| format!("{:.precision$}", rounded(value, i32::from(digits)));
            value.map_or_else(|| "?".to_owned(), shown)
        };
        shortened(&mut rows, &self.motions, |table, row| {
            let moves = moves(row.r#type) && row.planned_s > 0.0;
            let off = |value, digits| if moves { known(value, digits) } else { String::new() };
            let error = row.error_percent.map(|percent| signed(percent, 2));
            let mut cells = vec![Cell::new(row.index), Cell::new(row.r#type)];
            let name = row.name.as_deref().map(printable).unwrap_or_default();
            cells.extend(has_name.then(|| Cell::new(name)));
            cells.extend([
                Cell::new(format!("{:.3}", row.planned_s)),
                Cell::new(known(row.measured_s, 3)),
                Cell::new(error.unwrap_or_default()),
                Cell::new(off(row.joint_off_deg, 4)),
                Cell::new(off(row.tcp_off_mm, 3)),
            ]);
            table.add_row(cells);
        });
        let mut text = format!("{}\n\n", fitted(rows, width));
        let is_unknown = |row: &ValidatedMotion| {
            let moves = moves(row.r#type) && row.planned_s > 0.0;
            row.measured_s.is_none() || moves && row.joint_off_deg.is_none()
        };
        if self.motions.iter().any(is_unknown) {
            text.push_str(UNKNOWN);
        }
        let score = &self.score;
        for (quantity, spread, digits, unit) in [
            ("Time      ", score.time_percent, 2, "%"),
            ("Joints    ", score.joint_off_deg, 4, "deg"),
            ("Flange    ", score.tcp_off_mm, 3, "mm"),
        ] {
            let Some(Spread { median, most: max, worst }) = spread else { continue };
            let _ = writeln!(
                text,
                "{quantity}  off by {median:.digits$} {unit} (median), {max:.digits$} {unit} (95th \
                 percentile), {worst:.digits$} {unit} (maximum)"
            );
        }
        let cycle = signed(score.cycle_time_percent, 2);
        let _ = writeln!(text, "Cycle time  {cycle} %, over {} motions", score.motions);
        let positions = self.positions.as_deref().unwrap_or("unknown source");
        let _ = writeln!(
            text,
            "Recording   {}: {}, {:.0} Hz, noise {:.1e} deg",
            printable(&self.recording),
            printable(positions),
            self.rate_hz,
            self.noise_deg
        );
        let _ = writeln!(
            text,
            "Plan        {} for {}, timing {}, override {} %, iiwasim {}",
            printable(&self.program),
            printable(&self.robot),
            self.timing,
            self.override_percent,
            self.version
        );
        for assumption in &self.assumptions {
            let _ = writeln!(text, "Assumed, not from a source: {}", printable(assumption));
        }
        text.push_str(&assumption_lines(&self.rests_on));
        for note in &self.notes {
            let _ = writeln!(text, "Note: {}", printable(note));
        }
        text
    }
}

/// Returns true if entries of a type move the robot.
fn moves(type_name: &str) -> bool {
    MotionType::from_name(type_name).is_some_and(MotionType::moves)
}

/// Returns the row of a motion.
fn row(motion: &MotionTime, name: Option<String>, comparison: &Comparison) -> ValidatedMotion {
    let (planned_s, measured_s) = (motion.planned_s, motion.real_s);
    let error = |measured_s: f64| 100.0 * (planned_s - measured_s) / measured_s;
    let deviations = &comparison.motion_deviations;
    let off = deviations.iter().find(|off| off.motion == motion.motion);
    let off = off.filter(|_| motion.motion_type.moves());
    ValidatedMotion {
        index: motion.motion.number(),
        r#type: motion.motion_type.name(),
        name,
        planned_s,
        measured_s,
        error_percent: measured_s.filter(|measured_s| *measured_s > 0.0).map(error),
        worst_joint: off.map(|off| off.joint.number()),
        joint_off_deg: off.map(|off| off.joint_rad.to_degrees()),
        tcp_off_mm: off.map(|off| 1e3 * off.flange_m),
    }
}
