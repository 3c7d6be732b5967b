//! Station that an application controls: the robot, its payload, its frames, and the answers of
//! operators and signals.

use std::{
    cell::{Cell, RefCell},
    collections::BTreeMap,
    rc::Rc,
};

use crate::{Answers, DataFile, FrameCheck, ImportedCell, ProcessData, Question, Verdict};
use iiwa_java::{SourceLine, Unknown, Value};
use iiwa_kin::{Joints, Load, Pose, Robot};
use iiwa_program::{Frame, Tool, Workcell};

use crate::application::{
    asked::{Asked, EndlessLoop},
    body::{Body, tip_name},
    flange_load::together,
    frame_value::{FrameValue, Parent, then},
    missing::Missing,
    schedule::Schedule,
    spot::Spot,
};

/// Initial state of a station.
#[derive(Clone, Debug, Default)]
pub(crate) struct StationSetup {
    pub(crate) robot: Robot,
    /// Name of the robot in the program.
    pub(crate) robot_name: String,
    /// Flange length that the program states, in m.
    pub(crate) flange_m: Option<f64>,
    pub(crate) data_file: DataFile,
    /// Joint positions at the start, in rad.
    pub(crate) start_rad: Joints,
    /// `true` if the start was given; otherwise it is assumed.
    pub(crate) is_start_known: bool,
    pub(crate) answers: Answers,
    /// `true` if the run only collects missing entries of the data file: frames need not be
    /// reachable then.
    pub(crate) is_survey: bool,
}

/// State of the station.
#[derive(Debug)]
pub(crate) struct Station {
    pub(crate) robot: Robot,
    pub(crate) robot_name: String,
    pub(crate) flange_m: Option<f64>,
    pub(crate) start_rad: Joints,
    /// Suffix of a message that the first motion is not possible, if the start is not known.
    pub(crate) start_hint: Option<String>,
    pub(crate) is_survey: bool,
    /// Missing entry of the data file because of which the run was refused.
    pub(crate) missing: RefCell<Option<Missing>>,
    /// Joint positions after all commanded motions.
    pub(crate) at_rad: Joints,
    /// Target of `ptpHome`.
    pub(crate) home_rad: Joints,
    /// Tools, bases and frames by their names in programs.
    pub(crate) workcell: Workcell,
    pub(crate) tree: Vec<TreeFrame>,
    /// Templates of tools and workpieces.
    pub(crate) templates: Vec<Body>,
    /// Created tools and workpieces.
    pub(crate) bodies: Vec<Body>,
    /// Indices of injected bodies, by the names of their templates.
    pub(crate) injected: BTreeMap<String, usize>,
    /// Composed program tools: body index, tool and name.
    pub(crate) composed: Vec<(usize, Tool, String)>,
    pub(crate) schedule: Schedule,
    /// Payload after the load changes so far, once the robot has moved.
    pub(crate) carried: Option<Load>,
    /// `true` if a motion was sent, so that the program's tool is fixed.
    pub(crate) has_moved: bool,
    /// Place of the last attachment or detachment.
    pub(crate) attached_at: Option<SourceLine>,
    /// Place of the last drive of a mobile platform, until a world frame is a target.
    pub(crate) driven_at: Option<SourceLine>,
    /// Override of the application, and the place where it was set.
    pub(crate) speed_override: Option<(f64, SourceLine)>,
    /// Override at the first motion.
    pub(crate) first_override: Option<f64>,
    pub(crate) answers: Answers,
    /// Number of answers, by dialog.
    pub(crate) answered: BTreeMap<String, usize>,
    /// Number of queries of a condition, by place.
    pub(crate) fired: BTreeMap<String, usize>,
    pub(crate) questions: Vec<Question>,
    /// All questions, with their answers.
    pub(crate) asked: Vec<Asked>,
    /// Number of answers after which another one is given to the same dialog or condition.
    pub(crate) continued: usize,
    /// Input value on trial, which is not yet an answer.
    pub(crate) trial: Option<(String, bool)>,
    /// Input values that end loops, where none is given.
    pub(crate) supposed: BTreeMap<String, bool>,
    /// Endless loop in which the evaluation ended.
    pub(crate) endless: Option<EndlessLoop>,
    /// Number of readings of the robot position, and of outputs and process data.
    pub(crate) position_readings: Cell<usize>,
    pub(crate) readings: usize,
    /// Output values, by `Group.Name`.
    pub(crate) outputs: BTreeMap<String, Value>,
    pub(crate) process_data: Vec<ProcessData>,
    /// Process data that the application has set, by id.
    pub(crate) changed_data: BTreeMap<String, Value>,
}

/// Returns the assumption on the start position; with the joint positions of the first taught
/// frame, as a proposal.
fn start_hint(cell: &ImportedCell, robot: &Robot) -> String {
    let hint = "the start is not given: all joints at 0 are assumed";
    let taught = cell.frames.iter().find_map(|frame| {
        let FrameCheck { joints_rad, verdict } = frame.check(robot);
        Some((&frame.name, joints_rad.filter(|_| verdict == Verdict::Agrees)?))
    });
    let Some((name, joints_rad)) = taught else { return hint.to_owned() };
    let joints: Vec<_> =
        joints_rad.map(|q| format!("{}", (1e3 * q.to_degrees()).round() / 1e3)).into();
    format!("{hint}; it was at the frame `{name}` with {} deg", joints.join(","))
}

/// Frame of the data file's tree.
#[derive(Clone, Debug)]
pub(crate) struct TreeFrame {
    /// Path as `/FRAME/FRAME`.
    pub(crate) path: String,
    /// Name in programs.
    pub(crate) name: String,
    /// Pose relative to the parent.
    pub(crate) frame: Frame,
    pub(crate) parent: Option<usize>,
    /// Pose in the data file, relative to the robot base.
    pub(crate) pose: Pose,
    /// `true` if the application has changed the frame.
    pub(crate) is_changed: bool,
    /// Unknown value on which the pose depends, if the application has changed the frame by one.
    pub(crate) unknown: Option<Rc<Unknown>>,
}

impl Station {
    pub(crate) fn new(setup: StationSetup) -> Self {
        let StationSetup { robot, robot_name, flange_m, data_file, start_rad, answers, .. } = setup;
        let cell = ImportedCell::new(&data_file);
        let start_hint = (!setup.is_start_known).then(|| start_hint(&cell, &robot));
        let tools = data_file.tools.iter().zip(&cell.tools);
        let tools = tools.map(|(template, imported)| Body::of_template(template, Some(imported)));
        let workpieces = data_file.workpieces.iter();
        let workpieces = workpieces.map(|template| Body::of_template(template, None));
        Self {
            robot,
            robot_name,
            flange_m,
            start_rad,
            start_hint,
            is_survey: setup.is_survey,
            missing: RefCell::new(None),
            at_rad: start_rad,
            home_rad: [0.0; 7],
            tree: tree(&cell),
            templates: tools.chain(workpieces).collect(),
            workcell: cell.workcell,
            bodies: Vec::new(),
            injected: BTreeMap::new(),
            composed: Vec::new(),
            schedule: Schedule::default(),
            carried: None,
            has_moved: false,
            attached_at: None,
            driven_at: None,
            speed_override: None,
            first_override: None,
            answers,
            answered: BTreeMap::new(),
            fired: BTreeMap::new(),
            questions: Vec::new(),
            asked: Vec::new(),
            continued: 0,
            trial: None,
            supposed: BTreeMap::new(),
            endless: None,
            position_readings: Cell::new(0),
            readings: 0,
            outputs: BTreeMap::new(),
            process_data: data_file.process_data,
            changed_data: BTreeMap::new(),
        }
    }

    /// Returns the index of a tree frame by its path, with or without the first `/`.
    pub(crate) fn tree_frame(&self, path: &str) -> Option<usize> {
        let path = path.trim_matches('/');
        self.tree.iter().position(|frame| frame.path.trim_matches('/') == path)
    }

    /// Creates a new body from a template, and returns its index.
    pub(crate) fn add_body(&mut self, template: &Body) -> usize {
        self.bodies.push(template.clone());
        self.bodies.len() - 1
    }

    /// Returns a frame relative to the flange; `None` if it is not attached to the flange, or
    /// unknown.
    pub(crate) fn in_flange(&self, spot: Spot) -> Option<Frame> {
        if self.unknown_of(spot).is_some() {
            return None;
        }
        match spot {
            Spot::Flange => Some(Frame::default()),
            Spot::World | Spot::Tree(_) => None,
            Spot::Root(index) => {
                let (parent, frame) = self.bodies.get(index)?.attached?;
                Some(then(&self.in_flange(parent)?, &frame))
            }
            Spot::Of(index, frame) => {
                let frame_pose = self.bodies.get(index)?.frames.get(frame)?.frame;
                Some(then(&self.in_flange(Spot::Root(index))?, &frame_pose))
            }
        }
    }

    /// Returns a frame relative to the robot base; `None` if its object is not attached, or
    /// unknown.
    pub(crate) fn in_world(&self, spot: Spot) -> Option<Frame> {
        if self.unknown_of(spot).is_some() {
            return None;
        }
        match spot {
            Spot::World => Some(Frame::default()),
            Spot::Flange => {
                self.position_readings.set(self.position_readings.get() + 1);
                Some(Frame::from(&self.robot.flange_pose(&self.at_rad)))
            }
            Spot::Tree(index) => {
                let tree_frame = self.tree.get(index)?;
                match tree_frame.parent {
                    Some(parent) => {
                        Some(then(&self.in_world(Spot::Tree(parent))?, &tree_frame.frame))
                    }
                    None => Some(tree_frame.frame),
                }
            }
            Spot::Root(index) => {
                let (parent, frame) = self.bodies.get(index)?.attached?;
                Some(then(&self.in_world(parent)?, &frame))
            }
            Spot::Of(index, frame) => {
                let frame_pose = self.bodies.get(index)?.frames.get(frame)?.frame;
                Some(then(&self.in_world(Spot::Root(index))?, &frame_pose))
            }
        }
    }

    /// Returns the pose of a frame relative to the robot base.
    pub(crate) fn frame_in_world(&self, value: &FrameValue) -> Option<Frame> {
        match &value.parent {
            Parent::Spot(Spot::World) => Some(value.frame),
            Parent::Spot(spot) => Some(then(&self.in_world(*spot)?, &value.frame)),
            Parent::Frame(parent) => {
                Some(then(&self.frame_in_world(&parent.borrow())?, &value.frame))
            }
        }
    }

    /// Returns the number of attachments between a frame and an unattached one.
    pub(crate) fn attached_deep(&self, mut spot: Spot) -> usize {
        let mut depth = 0;
        while let Some((parent, _)) =
            spot.body().and_then(|body| self.bodies.get(body)).and_then(|body| body.attached)
        {
            (spot, depth) = (parent, depth + 1);
        }
        depth
    }

    /// Returns true if a frame belongs to a body, or is attached to it directly or indirectly.
    pub(crate) fn hangs_on(&self, spot: Spot, body: usize) -> bool {
        let Some(spot_body) = spot.body() else { return false };
        let attached = || self.bodies.get(spot_body).and_then(|attachment| attachment.attached);
        spot_body == body || attached().is_some_and(|(parent, _)| self.hangs_on(parent, body))
    }

    /// Returns the total payload at the flange; `None` if it has no mass.
    pub(crate) fn flange_load(&self) -> Option<Load> {
        let load_of = |(index, body): (usize, &Body)| {
            let load = body.load.filter(|load| load.mass_kg > 0.0)?;
            Some((self.in_flange(Spot::Root(index))?, load))
        };
        together(&self.bodies.iter().enumerate().filter_map(load_of).collect::<Vec<_>>())
    }

    /// Returns the program name of a tool that is attached at the flange as in its template.
    pub(crate) fn tool_at_flange(&self, index: usize) -> Option<&str> {
        let body = self.bodies.get(index)?;
        let is_plain = body.attached == Some((Spot::Flange, Frame::default()));
        body.in_programs.as_deref().filter(|_| is_plain)
    }

    /// Returns the name of a TCP in programs; a tool is composed for a TCP without a template.
    /// `None` if the TCP is not attached to the flange.
    pub(crate) fn tcp_name(&mut self, spot: Spot) -> Option<String> {
        let pose = self.in_flange(spot)?;
        if pose == Frame::default() && !matches!(spot, Spot::Of(..)) {
            let tool_name = spot.body().and_then(|body| {
                let has_frames = self.bodies.get(body).is_some_and(|body| !body.frames.is_empty());
                self.tool_at_flange(body).filter(|_| !has_frames)
            });
            return Some(tool_name.unwrap_or(FLANGE).to_owned());
        }
        let index = spot.body()?;
        if self.tool_at_flange(index).is_some()
            && let Spot::Of(_, frame) = spot
            // A frame that the application has added or changed has no template name.
            && let Some(name) = &self.bodies.get(index)?.frames.get(frame)?.in_programs
        {
            return Some(name.clone());
        }
        let root = self.in_flange(Spot::Root(index))?;
        let body = self.bodies.get(index)?;
        let (tool, tip) = match spot {
            Spot::Of(_, frame) => {
                let tip = body.frames.get(frame).filter(|_| Some(frame) != body.default);
                (body.as_tool(&root), tip.map(|tip| tip_name(&tip.path)))
            }
            _ if body.default.is_none() => (body.as_tool(&root), None),
            _ => (Tool { tcp: root, ..Tool::default() }, None),
        };
        let wanted = body.name.replace('/', "_");
        let known = self
            .composed
            .iter()
            .find(|(composed_body, known, _)| *composed_body == index && *known == tool);
        let name = if let Some((.., name)) = known {
            name.clone()
        } else {
            let is_free = |name: &String| {
                name != FLANGE && !name.is_empty() && !self.workcell.tools.contains_key(name)
            };
            let numbered = (2..).map(|number| format!("{wanted}_{number}"));
            let name = std::iter::once(wanted.clone()).chain(numbered).find(is_free)?;
            self.workcell.tools.insert(name.clone(), tool.clone());
            self.composed.push((index, tool, name.clone()));
            name
        };
        Some(tip.map_or_else(|| name.clone(), |tip| format!("{name}/{tip}")))
    }

    /// Returns the default TCP of a tool or a workpiece.
    pub(crate) fn default_frame(&self, spot: Spot) -> Spot {
        match spot {
            Spot::Root(index) => {
                let default = self.bodies.get(index).and_then(|body| body.default);
                default.map_or(spot, |frame| Spot::Of(index, frame))
            }
            other => other,
        }
    }
}

/// Name of the bare flange among program tools.
pub(crate) const FLANGE: &str = "flange";
/// Name of the robot base among program bases.
pub(crate) const FOOT: &str = "robot";

/// Returns the frames of a cell, each after its parent.
fn tree(cell: &ImportedCell) -> Vec<TreeFrame> {
    let workcell = &cell.workcell;
    let frame_and_base = |name: &String| {
        let base = workcell.bases.get(name).map(|base| (base.frame, base.base.clone()));
        base.or_else(|| workcell.frames.get(name).map(|entry| (entry.frame, entry.base.clone())))
    };
    let mut tree: Vec<TreeFrame> = Vec::with_capacity(cell.frames.len());
    for cell_frame in &cell.frames {
        let (frame, base) = frame_and_base(&cell_frame.name).unwrap_or_default();
        let parent = base.and_then(|base| tree.iter().position(|above| above.name == base));
        tree.push(TreeFrame {
            path: cell_frame.path.clone(),
            name: cell_frame.name.clone(),
            frame,
            parent,
            pose: cell_frame.pose,
            is_changed: false,
            unknown: None,
        });
    }
    tree
}
