//! Difference of two plans, as text, as Markdown and as JSON.

use std::fmt::Write as _;

use comfy_table::{Table, presets};
use iiwa_eval::{MotionDifference, PlanDifference, PlanVersion};
use iiwa_json::{excerpt, printable};
use iiwa_plan::{ClearanceRecord, LimitRecord, MotionRecord, SelfClearanceRecord, is_above};
use iiwa_program::IoValue;
use serde::Serialize;

use crate::{
    difference_clearance::ClearanceChange,
    difference_groups::{GroupRow, group_table},
    markdown::escaped,
    signed::{rounded, signed},
    table::{fitted, shortened, table},
};

/// Smallest change of a duration that counts, in s: the tables print milliseconds.
const LEAST_CHANGE_S: f64 = 5e-4;

/// Smallest change of a flange path that counts, in mm: the tables print tenths.
const LEAST_CHANGE_MM: f64 = 0.05;

/// Smallest change of a path in joint space that counts, in deg: the tables print tenths.
const LEAST_CHANGE_DEG: f64 = 0.05;

/// Difference of two plans of one program. As JSON, this is the object of `iiwasim diff --json`.
#[derive(Clone, Debug, Serialize)]
pub struct DifferenceReport {
    /// Robots of the old and of the new plan.
    robots: [String; 2],
    /// Timing methods of the old and of the new plan.
    timings: [String; 2],
    cycle_time_s: Times,
    motion_time_s: Times,
    settle_time_s: Times,
    wait_time_s: Times,
    /// Smallest distances between the arm and the scene, if both are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    clearance: Option<ClearanceChange<ClearanceRecord>>,
    /// Smallest distances of the arm from itself, if both are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    self_clearance: Option<ClearanceChange<SelfClearanceRecord>>,
    /// Number of motions that are equal in both plans.
    unchanged: usize,
    /// Motions that differ, in order.
    motions: Vec<DifferenceRow>,
    /// All groups of motions.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    groups: Vec<GroupRow>,
}

/// A time in both plans.
#[derive(Clone, Copy, Debug, Serialize)]
struct Times {
    old: f64,
    new: f64,
}

impl Times {
    fn change(self) -> f64 {
        self.new - self.old
    }
}

/// A motion that differs.
#[derive(Clone, Debug, Serialize)]
struct DifferenceRow {
    /// `changed`, `renamed`, `added` or `removed`. Only the name of a renamed motion differs.
    change: &'static str,
    r#type: String,
    old: Option<MotionSide>,
    new: Option<MotionSide>,
    /// Largest distance of the flange path from the other one, in mm; null if a plan lacks the
    /// motion.
    flange_mm: Option<f64>,
    /// Largest distance of the path in joint space from the other one, in deg.
    joints_deg: Option<f64>,
}

/// A motion in one of the plans.
#[derive(Clone, Debug, Serialize)]
struct MotionSide {
    /// Number in the program, from 1.
    index: usize,
    /// Duration, in s.
    time_s: f64,
    /// Limit that is active for the longest time, if any.
    limited_by: Option<LimitRecord>,
    /// Name, if the motion has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    /// Input or output, if the entry has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    io: Option<String>,
    /// Value of the input or output.
    #[serde(skip_serializing_if = "Option::is_none")]
    value: Option<IoValue>,
    /// Source line, if known.
    #[serde(skip_serializing_if = "Option::is_none")]
    source: Option<String>,
}

impl MotionSide {
    fn new(motion: &MotionRecord) -> Self {
        Self {
            index: motion.index,
            time_s: rounded(motion.end_s - motion.start_s, 9),
            limited_by: motion.limited_by.clone(),
            name: motion.label.name.clone(),
            io: motion.io.clone(),
            value: motion.value,
            source: motion.source.as_ref().map(ToString::to_string),
        }
    }
}

impl DifferenceRow {
    /// Creates the row of a motion; `None` if the plans do not differ in it.
    fn new(difference: &MotionDifference) -> Option<Self> {
        let MotionDifference { old, new, path } = difference;
        let [old_side, new_side] = [old, new].map(|side| side.as_ref().map(MotionSide::new));
        let flange_mm = path.map(|path| rounded(1e3 * path.flange_m, 3));
        let joints_deg = path.map(|path| rounded(path.joints_rad.to_degrees(), 3));
        let change = match (&old_side, &new_side) {
            (None, _) => "added",
            (_, None) => "removed",
            (Some(old), Some(new)) => {
                let is_same = (new.time_s - old.time_s).abs() < LEAST_CHANGE_S
                    && flange_mm.is_none_or(|change| change < LEAST_CHANGE_MM)
                    && joints_deg.is_none_or(|change| change < LEAST_CHANGE_DEG)
                    && old.limited_by == new.limited_by
                    && (&old.io, old.value) == (&new.io, new.value);
                match is_same {
                    false => "changed",
                    true if old.name != new.name => "renamed",
                    true => return None,
                }
            }
        };
        let motion = new.as_ref().or(old.as_ref())?;
        let r#type = motion.r#type.to_string();
        Some(Self { change, r#type, old: old_side, new: new_side, flange_mm, joints_deg })
    }

    /// Returns the name of the motion, in the new plan if it is there; with the old name if the
    /// names differ.
    fn name(&self) -> Option<String> {
        let [old, new] = [&self.old, &self.new]
            .map(|side| side.as_ref().map(|side| side.name.as_deref().map(printable)));
        match (old, new) {
            (Some(Some(old)), Some(new)) if new.as_ref() != Some(&old) => {
                Some(format!("{}, was {old}", new.unwrap_or_else(|| "none".to_owned())))
            }
            (_, Some(name)) | (Some(name), None) => name,
            (None, None) => None,
        }
    }

    /// Returns input or output and value, in the new plan if the entry is there; with those in the
    /// old plan if they differ.
    fn io(&self) -> Option<String> {
        let text = |side: &MotionSide| {
            let (io, value) = (side.io.as_deref()?, side.value?);
            Some(printable(&format!("{io} = {value}")))
        };
        let [old, new] = [&self.old, &self.new].map(|side| side.as_ref().and_then(text));
        match (old, new) {
            (Some(old), Some(new)) if old != new => Some(format!("{new}, was {old}")),
            (old, new) => new.or(old),
        }
    }

    /// Returns the source line, without folders, if known.
    fn source(&self) -> Option<String> {
        let side = self.new.as_ref().or(self.old.as_ref())?;
        Some(printable(side.source.as_deref()?.rsplit('/').next()?))
    }

    /// Returns the cells of the row; with name, I/O and source line if any row has one.
    fn cells(&self, [has_name, has_io, has_source]: [bool; 3]) -> Vec<String> {
        let [old, new] = [&self.old, &self.new].map(Option::as_ref);
        let number = |side: Option<&MotionSide>| side.map(|side| side.index.to_string());
        let tenths = |change: Option<f64>| change.map(|it| format!("{it:.1}")).unwrap_or_default();
        let time = |side: Option<&MotionSide>| side.map(|side| format!("{:.3}", side.time_s));
        let limit = |side: Option<&MotionSide>| {
            let limit = side.and_then(|side| side.limited_by.as_ref());
            limit.map(ToString::to_string).unwrap_or_default()
        };
        let limited_by = match (limit(old), limit(new)) {
            (before, after) if before == after || old.is_none() => after,
            (before, _) if new.is_none() => before,
            (before, after) => {
                let [before, after] = [before, after]
                    .map(|limit| if limit.is_empty() { "none".to_owned() } else { limit });
                format!("{after}, was {before}")
            }
        };
        let change_s = new.map_or(0.0, |new| new.time_s) - old.map_or(0.0, |old| old.time_s);
        let mut cells = vec![
            number(old).unwrap_or_default(),
            number(new).unwrap_or_default(),
            self.r#type.clone(),
        ];
        if has_name {
            cells.push(self.name().unwrap_or_default());
        }
        if has_io {
            cells.push(self.io().unwrap_or_default());
        }
        cells.extend([
            time(old).unwrap_or_default(),
            time(new).unwrap_or_default(),
            signed(change_s, 3),
            tenths(self.flange_mm),
            tenths(self.joints_deg),
        ]);
        if has_source {
            cells.push(self.source().unwrap_or_default());
        }
        cells.push(limited_by);
        cells
    }
}

impl DifferenceReport {
    /// Compares two plans.
    #[must_use]
    pub fn new(old: &PlanVersion, new: &PlanVersion) -> Self {
        let difference = PlanDifference::between(old, new);
        let motions: Vec<_> = difference.motions.iter().filter_map(DifferenceRow::new).collect();
        let [a, b] = [old.figures(), new.figures()];
        let times = |old, new| Times { old, new };
        Self {
            robots: [a, b].map(|figures| figures.robot.clone()),
            timings: [a, b].map(|figures| figures.timing.to_string()),
            cycle_time_s: times(a.cycle_time_s, b.cycle_time_s),
            motion_time_s: times(a.motion_time_s, b.motion_time_s),
            settle_time_s: times(a.settle_time_s, b.settle_time_s),
            wait_time_s: times(a.wait_time_s, b.wait_time_s),
            clearance: ClearanceChange::new([a, b], |figures| figures.clearance.as_ref()),
            self_clearance: ClearanceChange::new([a, b], |figures| figures.self_clearance.as_ref()),
            unchanged: difference.motions.len() - motions.len(),
            motions,
            groups: difference.groups.iter().map(GroupRow::new).collect(),
        }
    }

    /// Returns true if the plans have the same motions, names, times of groups, times, paths,
    /// limits and clearances.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let of_scene = self.clearance.as_ref();
        let of_itself = self.self_clearance.as_ref();
        self.motions.is_empty()
            && !self.has_other_groups()
            && !of_scene.is_some_and(|it| it.differs(LEAST_CHANGE_MM))
            && !of_itself.is_some_and(|it| it.differs(LEAST_CHANGE_MM))
            && self.robots[0] == self.robots[1]
            && self.timings[0] == self.timings[1]
            && self.cycle_time_s.change().abs() < LEAST_CHANGE_S
    }

    /// Cycle times of the old and of the new plan, in s.
    #[must_use]
    pub fn cycle_times_s(&self) -> [f64; 2] {
        [self.cycle_time_s.old, self.cycle_time_s.new]
    }

    /// Growth of the cycle time, in per cent of the old one; infinite if that was 0.
    #[must_use]
    pub fn growth_percent(&self) -> f64 {
        match self.cycle_time_s.change() {
            0.0 => 0.0,
            change => 100.0 * change / self.cycle_time_s.old,
        }
    }

    /// Returns the reason why a gate on the growth of the cycle time is not met, if it is not: the
    /// growth is judged as it is printed, to a tenth of a per cent.
    #[must_use]
    pub fn complaint(&self, max_growth_percent: Option<f64>) -> Option<String> {
        let max_percent = max_growth_percent?;
        let growth = self.growth_percent();
        if growth.is_infinite() {
            return Some(format!("the cycle time grows from 0 s, by more than {max_percent} %"));
        }
        is_above(growth, max_percent, 1)
            .then(|| format!("the cycle time grows by {growth:.1} %, more than {max_percent} %"))
    }

    /// Formats the difference as a table and sentences. Cells of the table are wrapped to lines of
    /// at most `width` characters; see [`fitted`].
    #[must_use]
    pub fn text(&self, width: Option<u16>) -> String {
        let mut text = String::new();
        if !self.motions.is_empty() {
            let _ = writeln!(text, "{}\n", fitted(self.table(str::to_owned), width));
        }
        if self.has_other_groups() {
            let table = group_table(self.other_groups(), str::to_owned);
            let _ = writeln!(text, "{}\n", fitted(table, width));
        }
        self.sentences().for_each(|line| _ = writeln!(text, "{line}"));
        text
    }

    /// Formats the difference as Markdown.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut text = String::new();
        self.sentences().for_each(|line| _ = writeln!(text, "{}  ", escaped(&line)));
        if !self.motions.is_empty() {
            let mut table = self.table(escaped);
            table.load_style(presets::ASCII_MARKDOWN);
            let _ = writeln!(text, "\n{table}");
        }
        if self.has_other_groups() {
            let mut table = group_table(self.other_groups(), escaped);
            table.load_style(presets::ASCII_MARKDOWN);
            let _ = writeln!(text, "\n{table}");
        }
        text
    }

    /// Returns the groups that differ.
    fn other_groups(&self) -> impl Iterator<Item = &GroupRow> {
        self.groups.iter().filter(|group| group.differs(LEAST_CHANGE_S))
    }

    fn has_other_groups(&self) -> bool {
        self.other_groups().next().is_some()
    }

    /// Returns true if any motion has a name.
    fn has_name(&self) -> bool {
        self.motions.iter().any(|row| row.name().is_some())
    }

    /// Returns true if any row has an input or output.
    fn has_io(&self) -> bool {
        self.motions.iter().any(|row| row.io().is_some())
    }

    /// Returns true if the source line of any motion is known.
    fn has_source(&self) -> bool {
        self.motions.iter().any(|row| row.source().is_some())
    }

    /// Returns the table of all motions that differ; `format` formats the cells. Number and time of
    /// a motion are those in the old and in the new plan.
    fn table(&self, format: impl Fn(&str) -> String) -> Table {
        let columns = [self.has_name(), self.has_io(), self.has_source()];
        let [has_name, has_io, has_source] = columns;
        let mut head = vec!["old", "new", "type"];
        head.extend(has_name.then_some("name"));
        head.extend(has_io.then_some("I/O"));
        head.extend(["old s", "new s", "change s", "flange mm", "joints deg"]);
        head.extend(has_source.then_some("source"));
        head.push("limited by");
        let mut table = table(&head);
        shortened(&mut table, &self.motions, |table, row| {
            table.add_row(row.cells(columns).iter().map(|cell| format(cell)));
        });
        table
    }

    /// Returns the summary, a sentence per line.
    fn sentences(&self) -> impl Iterator<Item = String> {
        let Self { robots, timings, cycle_time_s, unchanged, motions, .. } = self;
        let percent = match self.growth_percent() {
            growth if growth.is_finite() => format!(" ({} %)", signed(growth, 1)),
            _ => String::new(),
        };
        let mut lines = vec![format!(
            "Cycle time {:.3} s before, {:.3} s after: {} s{percent}",
            cycle_time_s.old,
            cycle_time_s.new,
            signed(cycle_time_s.change(), 3),
        )];
        let parts = [
            ("motion", self.motion_time_s),
            ("settling", self.settle_time_s),
            ("waiting", self.wait_time_s),
        ];
        let parts: Vec<_> = parts
            .into_iter()
            .filter(|(_, times)| times.change().abs() >= LEAST_CHANGE_S)
            .map(|(part, times)| format!("{part} {} s", signed(times.change(), 3)))
            .collect();
        if parts.len() > 1 {
            lines.push(format!("Parts of the change: {}", parts.join(", ")));
        }
        let count = |change: &str| motions.iter().filter(|row| row.change == change).count();
        let counts: Vec<_> = ["changed", "renamed", "added", "removed"]
            .into_iter()
            .filter(|change| count(change) > 0)
            .map(|change| format!("{} {change}", count(change)))
            .chain([format!("{unchanged} unchanged")])
            .collect();
        lines.push(format!("Motions and waits: {}", counts.join(", ")));
        let farthest = motions
            .iter()
            .filter_map(|row| Some((row.flange_mm?, row.new.as_ref()?)))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((change_mm, motion)) = farthest.filter(|(change, _)| *change >= LEAST_CHANGE_MM)
        {
            let MotionSide { index, name, .. } = motion;
            let name = name.as_deref().map(|name| format!(" \"{}\"", excerpt(name)));
            lines.push(format!(
                "Largest change of the flange path: {change_mm:.1} mm, in motion {index}{}",
                name.unwrap_or_default()
            ));
        }
        let clearance = self.clearance.as_ref().map(|it| it.sentence("Clearance"));
        let of_itself = self.self_clearance.as_ref().map(|it| it.sentence("Arm from itself"));
        lines.extend(clearance.into_iter().chain(of_itself));
        for (name, [old, new]) in [("robots", robots), ("timing methods", timings)] {
            if old != new {
                lines.push(format!("Planned with different {name}: {old} before, {new} after"));
            }
        }
        lines.into_iter()
    }
}
