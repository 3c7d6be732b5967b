//! Content imported from a Sunrise project, as JSON and as text.

use std::{fmt::Write as _, path::Path};

use iiwa_json::printable;
use iiwa_kin::Robot;
use iiwa_sunrise::{
    DataFile, ImportedCell, ImportedFrame, OTHER_FLANGE_M, TOUCH_FLANGE_M, TcpChange, Verdict,
};
use serde::Serialize;

use crate::table::{fitted, shortened, table};

/// Content imported from a Sunrise project, and the frames that a robot reaches as taught. As JSON,
/// this is the object of `iiwasim import --json`.
#[derive(Clone, Debug, Serialize)]
pub struct ImportReport {
    robot: String,
    project: String,
    tools: Vec<ToolRow>,
    bases: usize,
    frames: Vec<FrameRow>,
    /// Number of frames taught with E1, status and a TCP, and number of those that the robot
    /// reaches as taught.
    taught: usize,
    agreeing: usize,
    /// Number of frames reached with another flange, if larger.
    #[serde(skip_serializing_if = "Option::is_none")]
    other_flange: Option<OtherFlange>,
    renamed: Vec<RenamedRow>,
    not_taken: Vec<NotTakenRow>,
    output: Option<String>,
    /// Built-in model on which the frames were taught, unless it is the robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    taught_on: Option<&'static str>,
}

#[derive(Clone, Debug, Serialize)]
struct ToolRow {
    name: String,
    /// Frame that is the TCP; null for the flange.
    tcp: Option<String>,
    tips: Vec<String>,
    mass_kg: Option<f64>,
}

#[derive(Clone, Debug, Serialize)]
struct FrameRow {
    path: String,
    name: String,
    is_base: bool,
    is_target: bool,
    /// TCP by its name in the project.
    taught_with: Option<String>,
    /// TCP by its name in programs; null if the project no longer has it.
    tool: Option<String>,
    /// Displacement of the TCP since the frame was taught.
    #[serde(skip_serializing_if = "Option::is_none")]
    tcp_change: Option<TcpChangeRow>,
    joints_deg: Option<[f64; 7]>,
    /// `None` without data to check.
    agrees: Option<bool>,
    check: String,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct TcpChangeRow {
    distance_mm: f64,
    turn_deg: f64,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct OtherFlange {
    flange_mm: f64,
    agreeing: usize,
}

#[derive(Clone, Debug, Serialize)]
struct RenamedRow {
    from: String,
    to: String,
    why: &'static str,
}

#[derive(Clone, Debug, Serialize)]
struct NotTakenRow {
    what: String,
    count: usize,
    why: String,
}

impl ImportReport {
    /// Creates the report on `cell` from the project `file`, checked on `robot`; `output` is the
    /// file of the imported cell.
    #[must_use]
    pub fn new(
        project: &Path,
        file: &DataFile,
        cell: &ImportedCell,
        robot: &Robot,
        output: Option<&Path>,
    ) -> Self {
        let frames: Vec<_> = cell.frames.iter().map(|frame| FrameRow::new(frame, robot)).collect();
        let count = |agrees| frames.iter().filter(|row| row.agrees == Some(agrees)).count();
        let agreeing = count(true);
        let tools = cell.tools.iter().map(|tool| ToolRow {
            name: tool.name.clone(),
            tcp: tool.tcp.clone(),
            tips: tool.tips.clone(),
            mass_kg: cell
                .workcell
                .tools
                .get(&tool.name)
                .and_then(|tool| tool.load.as_ref())
                .map(|payload| payload.load.mass_kg),
        });
        let renamed = cell.renamed.iter().map(|entry| RenamedRow {
            from: entry.from.clone(),
            to: entry.to.clone(),
            why: entry.reason,
        });
        let not_taken = file.not_taken.iter().map(|entry| NotTakenRow {
            what: entry.kind.clone(),
            count: entry.count,
            why: entry.reason.clone(),
        });
        Self {
            robot: robot.name().to_owned(),
            project: project.display().to_string(),
            tools: tools.collect(),
            bases: cell.workcell.bases.len(),
            taught: agreeing + count(false),
            agreeing,
            other_flange: other_flange(cell, robot).filter(|other| other.agreeing > agreeing),
            renamed: renamed.collect(),
            not_taken: not_taken.collect(),
            output: output.map(|path| path.display().to_string()),
            taught_on: taught_on(cell).filter(|name| *name != robot.name()),
            frames,
        }
    }

    /// Built-in model on which the frames were taught, unless it is the robot on which they were
    /// checked.
    #[must_use]
    pub fn taught_on(&self) -> Option<&'static str> {
        self.taught_on
    }

    /// Formats the report as text. Cells of tables are wrapped to lines of at most `width`
    /// characters; see [`fitted`].
    #[must_use]
    pub fn text(&self, width: Option<u16>) -> String {
        let mut text = String::new();
        if !self.tools.is_empty() {
            let mut rows = table(&["tool", "TCP", "tips", "load kg"]);
            shortened(&mut rows, &self.tools, |rows, tool| {
                let load = tool.mass_kg.map_or_else(|| "-".to_owned(), |kg| format!("{kg:.3}"));
                let tcp = tool.tcp.as_deref().unwrap_or("the flange");
                let [name, tcp, tips] = [&tool.name, tcp, &tool.tips.join(", ")].map(printable);
                rows.add_row([name, tcp, tips, load]);
            });
            let _ = writeln!(text, "{}\n", fitted(rows, width));
        }
        if !self.frames.is_empty() {
            let mut rows = table(&["frame", "used as", "taught with", "check"]);
            shortened(&mut rows, &self.frames, |rows, frame| {
                let used = match (frame.is_base, frame.is_target) {
                    (true, true) => "base, frame",
                    (true, false) => "base",
                    _ => "frame",
                };
                let check = if frame.is_target { &frame.check } else { "-" };
                rows.add_row([&frame.name, used, &frame.tool_text(), check].map(printable));
            });
            let _ = writeln!(text, "{}\n", fitted(rows, width));
        }
        if !self.renamed.is_empty() {
            let mut rows = table(&["renamed", "to", "why"]);
            shortened(&mut rows, &self.renamed, |rows, entry| {
                rows.add_row([&entry.from, &entry.to, entry.why].map(printable));
            });
            let _ = writeln!(text, "{}\n", fitted(rows, width));
        }
        if !self.not_taken.is_empty() {
            let mut rows = table(&["not taken", "count", "why"]);
            shortened(&mut rows, &self.not_taken, |rows, entry| {
                rows.add_row([
                    printable(&entry.what),
                    entry.count.to_string(),
                    printable(&entry.why),
                ]);
            });
            let _ = writeln!(text, "{}\n", fitted(rows, width));
        }
        let targets = self.frames.iter().filter(|frame| frame.is_target).count();
        let _ = writeln!(
            text,
            "{}, {}, {} from {}",
            counted(self.tools.len(), "tool"),
            counted(self.bases, "base"),
            counted(targets, "frame"),
            printable(&self.project)
        );
        let _ = writeln!(
            text,
            "{} of {} taught frames agree with {}: within reach and limits, with the status and \
             the turn that were taught",
            self.agreeing, self.taught, self.robot
        );
        if let Some(OtherFlange { flange_mm, agreeing }) = &self.other_flange {
            let _ = writeln!(
                text,
                "With a flange of {flange_mm:.0} mm (wrist to face), {agreeing} would agree"
            );
        }
        if let Some(output) = &self.output {
            let _ = writeln!(text, "Frames in {}", printable(output));
        }
        text
    }
}

fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

impl FrameRow {
    fn new(frame: &ImportedFrame, robot: &Robot) -> Self {
        let check = frame.check(robot);
        let agrees = match check.verdict {
            Verdict::NotTaught => None,
            Verdict::Agrees => Some(true),
            _ => Some(false),
        };
        let change = |change: TcpChange| TcpChangeRow {
            distance_mm: change.distance_mm,
            turn_deg: change.turn_rad.to_degrees(),
        };
        Self {
            path: frame.path.clone(),
            name: frame.name.clone(),
            is_base: frame.is_base,
            is_target: frame.is_target,
            taught_with: frame.teaching.as_ref().map(|teaching| teaching.tcp_name.clone()),
            tool: frame.tool.clone(),
            tcp_change: frame.tcp_change.map(change),
            joints_deg: check.joints_rad.map(|joints| joints.map(f64::to_degrees)),
            agrees,
            check: check.verdict.to_string(),
        }
    }

    fn tool_text(&self) -> String {
        match (&self.tool, &self.taught_with, self.tcp_change) {
            (Some(tool), _, Some(TcpChangeRow { distance_mm, turn_deg })) => {
                format!("{tool} (since then moved by {distance_mm:.2} mm, {turn_deg:.2} deg)")
            }
            (Some(tool), _, None) => tool.clone(),
            (None, Some(tcp), _) => format!("{tcp} (no longer there)"),
            (None, None, _) => "-".to_owned(),
        }
    }
}

/// Returns the flange, other than the robot's, with which most frames agree, and their number.
fn other_flange(cell: &ImportedCell, robot: &Robot) -> Option<OtherFlange> {
    let others = [OTHER_FLANGE_M, TOUCH_FLANGE_M]
        .into_iter()
        .filter(|flange_m| *flange_m != robot.lengths().flange_m);
    let counted = others.filter_map(|flange_m| {
        let other = robot.clone().with_flange_m(flange_m).ok()?;
        let [_, agreeing] = cell.taught_and_agreeing(&other);
        Some(OtherFlange { flange_mm: 1e3 * flange_m, agreeing })
    });
    counted.max_by_key(|other| other.agreeing)
}

/// Returns the built-in model on which most frames were taught: device names are model names with a
/// number.
fn taught_on(cell: &ImportedCell) -> Option<&'static str> {
    let devices = cell.frames.iter().filter_map(|frame| frame.teaching.as_ref());
    let devices: Vec<_> = devices.map(|teaching| teaching.device.to_ascii_lowercase()).collect();
    let count = |name: &&str| devices.iter().filter(|device| device.starts_with(name)).count();
    let candidate = Robot::BUILT_IN.into_iter().max_by_key(count)?;
    (2 * count(&candidate) > devices.len()).then_some(candidate)
}
