//! Converts a data file to the tools, bases and frames of programs.

use std::collections::BTreeMap;

use iiwa_kin::{Pose, Status, Turn};
use iiwa_program::{Base, Frame, Target, Tool, Workcell};

use crate::{
    data_file::{DataFile, Teaching, ToolTemplate, WorldFrame},
    names::{Renamed, UniqueNames},
};

/// Names that are reserved in programs: the bare flange, and the robot base.
const FLANGE: &str = "flange";
const FOOT: &str = "robot";
/// Reserved name of the TCP frame, in which offsets are given.
const TCP: &str = "tcp";

/// Tools, bases and frames of a data file, with their names in programs.
#[derive(Clone, Debug, Default)]
pub struct ImportedCell {
    /// Tools, bases and frames for programs.
    pub workcell: Workcell,
    /// Tools in file order.
    pub tools: Vec<ImportedTool>,
    /// Frames in file order, each parent before its children.
    pub frames: Vec<ImportedFrame>,
    /// Entries whose name differs from the project's.
    pub renamed: Vec<Renamed>,
}

/// Tool of a data file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImportedTool {
    /// Name in programs.
    pub name: String,
    /// Path of the TCP frame, as `/FRAME`; `None` if the tool has no frames: then the flange is the
    /// TCP.
    pub tcp: Option<String>,
    /// Other frames of the tool, by their names in programs.
    pub tips: Vec<String>,
}

/// Frame of a data file.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedFrame {
    /// Path in the project, as `/FRAME/FRAME`.
    pub path: String,
    /// Name in programs.
    pub name: String,
    /// `true` if the frame is a base: other frames are given in it.
    pub is_base: bool,
    /// `true` if the frame is a motion target.
    pub is_target: bool,
    /// Pose relative to the robot base.
    pub pose: Pose,
    /// Taught position of A3, in rad.
    pub e1_rad: Option<f64>,
    /// Taught status.
    pub status: Option<Status>,
    /// Taught turn.
    pub turn: Option<Turn>,
    /// Robot and TCP at the time of teaching.
    pub teaching: Option<Teaching>,
    /// Tool at the time of teaching, by its name in programs; `None` if the project no longer has
    /// that tool.
    pub tool: Option<String>,
    /// Change of the tool's TCP since teaching, if any.
    pub tcp_change: Option<TcpChange>,
}

/// Change of a TCP since a frame was taught.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TcpChange {
    /// Distance in mm.
    pub distance_mm: f64,
    /// Rotation angle in rad.
    pub turn_rad: f64,
}

/// TCPs by the names that taught frames use, with their names in programs and their poses in the
/// flange frame.
type Tcps = BTreeMap<String, (String, Pose)>;

impl TcpChange {
    /// Returns the change from one pose to another; `None` if they are equal within rounding.
    fn between(before: &Pose, now: &Pose) -> Option<Self> {
        let by = before.inverse().then(now);
        let distance_mm = 1e3 * by.position_m.iter().map(|v| v * v).sum::<f64>().sqrt();
        let [r, s, t] = [0, 1, 2].map(|i| by.rotation[i][i]);
        let turn_rad = ((r + s + t - 1.0) / 2.0).clamp(-1.0, 1.0).acos();
        // The arc cosine near 1 amplifies rounding errors to their square root.
        (distance_mm > 1e-3 || turn_rad > 1e-5).then_some(Self { distance_mm, turn_rad })
    }
}

impl ImportedCell {
    /// Converts `file`. A frame with children is a base; it is also a motion target if it was
    /// taught. All frames without children are motion targets. Names are paths such as `Table/P1`.
    #[must_use]
    pub fn new(file: &DataFile) -> Self {
        let mut cell = Self::default();
        let mut tcps = Tcps::new();
        let mut names = UniqueNames::without(&[FLANGE]);
        for template in &file.tools {
            let name = names.give(None, &template.name, &template.name);
            // The root of a tool is the flange.
            tcps.insert(template.name.clone(), (FLANGE.to_owned(), Pose::IDENTITY));
            tcps.extend(cell.add_tool(template, &name));
        }
        cell.renamed.append(&mut names.renamed);
        let mut names = UniqueNames::without(&[FOOT, TCP]);
        let mut open: Vec<_> = file.frames.iter().rev().map(|frame| (frame, None)).collect();
        while let Some((frame, parent)) = open.pop() {
            let parent: Option<usize> = parent;
            let index = cell.add_frame(frame, parent, &mut names, &tcps);
            open.extend(frame.children.iter().rev().map(|child| (child, Some(index))));
        }
        cell.renamed.append(&mut names.renamed);
        cell
    }

    /// Adds a tool. Returns its TCPs by the names that taught frames use, with their names in
    /// programs and their poses in the flange frame.
    fn add_tool(&mut self, template: &ToolTemplate, name: &str) -> Tcps {
        let mut names = UniqueNames::default();
        let mut entries = Vec::new();
        let mut open: Vec<_> = template
            .frames
            .iter()
            .rev()
            .map(|frame| (frame, String::new(), None, Pose::IDENTITY))
            .collect();
        while let Some((frame, above, parent, pose)) = open.pop() {
            let path = format!("{above}/{}", frame.name);
            let parent: Option<String> = parent;
            let from = format!("{}{path}", template.name);
            let tip = names.give(parent.as_deref(), &frame.name, &from);
            // A frame given in the flange keeps its numbers as written.
            let (pose, written) = if parent.is_none() {
                (frame.frame.pose(), frame.frame)
            } else {
                let pose = pose.then(&frame.frame.pose());
                (pose, Frame::from(&pose))
            };
            for child in frame.children.iter().rev() {
                open.push((child, path.clone(), Some(tip.clone()), pose));
            }
            entries.push((path, from, tip, written));
        }
        let is_default = |path: &String| Some(path) == template.default_frame.as_ref();
        let default = entries.iter().position(|(path, ..)| is_default(path)).unwrap_or(0);
        let mut tool = Tool { load: template.load.map(Into::into), ..Tool::default() };
        let mut imported = ImportedTool { name: name.to_owned(), tcp: None, tips: Vec::new() };
        let mut tcps = Tcps::new();
        for (index, (path, from, tip, frame)) in entries.into_iter().enumerate() {
            let is_tcp = index == default;
            let called = if is_tcp { name.to_owned() } else { format!("{name}/{tip}") };
            tcps.insert(from, (called, frame.pose()));
            if is_tcp {
                tool.tcp = frame;
                imported.tcp = Some(path);
            } else {
                tool.tips.insert(tip.clone(), frame);
                imported.tips.push(tip);
            }
        }
        self.renamed.append(&mut names.renamed);
        self.workcell.tools.insert(name.to_owned(), tool);
        self.tools.push(imported);
        tcps
    }

    /// Adds a frame and returns its index.
    fn add_frame(
        &mut self,
        frame: &WorldFrame,
        parent: Option<usize>,
        names: &mut UniqueNames,
        tcps: &Tcps,
    ) -> usize {
        let above = parent.map(|index| &self.frames[index]);
        let path = format!("{}/{}", above.map_or("", |above| &above.path), frame.name);
        let name = names.give(above.map(|above| above.name.as_str()), &frame.name, &path);
        let local_pose = frame.frame.pose();
        let pose = above.map_or(local_pose, |above| above.pose.then(&local_pose));
        let base = above.map(|above| above.name.clone());
        let redundancy = frame.redundancy.as_ref();
        let is_base = !frame.children.is_empty();
        let is_target = !is_base || redundancy.is_some() || frame.teaching.is_some();
        let imported = ImportedFrame {
            is_base,
            is_target,
            pose,
            e1_rad: redundancy.and_then(|redundancy| redundancy.e1_rad),
            status: redundancy.and_then(|redundancy| redundancy.status),
            turn: redundancy.and_then(|redundancy| redundancy.turn),
            tool: None,
            tcp_change: None,
            teaching: frame.teaching.clone(),
            path,
            name: name.clone(),
        };
        let imported = imported.with_tool(tcps);
        if is_base {
            self.workcell
                .bases
                .insert(name.clone(), Base { frame: frame.frame, base: base.clone() });
        }
        if is_target {
            let target = Target {
                frame: frame.frame,
                base: Some(base.unwrap_or_else(|| FOOT.to_owned())),
                e1_rad: imported.e1_rad,
                status: imported.status,
                turn: imported.turn.map(Turn::bits),
            };
            self.workcell.frames.insert(name, target);
        }
        self.frames.push(imported);
        self.frames.len() - 1
    }
}

impl ImportedFrame {
    /// Resolves the tool that the frame was taught with, and the change of its TCP since.
    fn with_tool(self, tcps: &Tcps) -> Self {
        let Some(teaching) = &self.teaching else { return self };
        let flange = || {
            let is_flange = teaching.tcp_name.eq_ignore_ascii_case(FLANGE);
            is_flange.then(|| (FLANGE.to_owned(), Pose::IDENTITY))
        };
        let Some((tool, now)) = tcps.get(&teaching.tcp_name).cloned().or_else(flange) else {
            return self;
        };
        let tcp_change = TcpChange::between(&teaching.tcp.pose(), &now);
        Self { tool: Some(tool), tcp_change, ..self }
    }
}
