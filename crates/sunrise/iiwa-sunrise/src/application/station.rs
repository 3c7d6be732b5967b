//! The station that an application moves: the arm, what is attached to it, its frames, and what people and signals say.

use std::{
    cell::{Cell, RefCell},
    collections::BTreeMap,
    rc::Rc,
};

use crate::{Answers, DataFile, FrameCheck, ImportedCell, ProcessData, Question, Verdict};
use iiwa_java::{Place, Unknown, Value};
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

/// What an application finds when it begins.
#[derive(Clone, Debug, Default)]
pub(crate) struct StationSetup {
    pub(crate) robot: Robot,
    /// The name of the robot in the program.
    pub(crate) robot_name: String,
    /// The flange that the program states, in m.
    pub(crate) flange_m: Option<f64>,
    pub(crate) data_file: DataFile,
    /// Where the arm stands, in rad.
    pub(crate) start_rad: Joints,
    /// True if the start was given; else it is assumed.
    pub(crate) is_start_known: bool,
    pub(crate) answers: Answers,
    /// True if the run only collects missing entries of the data file: frames need not be within reach then.
    pub(crate) is_survey: bool,
}

/// The state of the station.
#[derive(Debug)]
pub(crate) struct Station {
    pub(crate) robot: Robot,
    pub(crate) robot_name: String,
    pub(crate) flange_m: Option<f64>,
    pub(crate) start_rad: Joints,
    /// The end of a message that the first motion is not possible, if the start is not known.
    pub(crate) start_hint: Option<String>,
    pub(crate) is_survey: bool,
    /// The entry of the data file for whose lack the run was refused.
    pub(crate) missing: RefCell<Option<Missing>>,
    /// Where the arm stands, or will once it has done what it was told.
    pub(crate) at_rad: Joints,
    /// Where `ptpHome` goes.
    pub(crate) home_rad: Joints,
    /// Tools, bases and frames by their names in programs.
    pub(crate) workcell: Workcell,
    pub(crate) tree: Vec<TreeFrame>,
    /// Templates of tools and workpieces.
    pub(crate) templates: Vec<Body>,
    /// Tools and workpieces that were made.
    pub(crate) bodies: Vec<Body>,
    /// Templates by name that were asked for by injection, and which body they are.
    pub(crate) injected: BTreeMap<String, usize>,
    /// Tools of programs that were put together, and of which body.
    pub(crate) composed: Vec<(usize, Tool, String)>,
    pub(crate) schedule: Schedule,
    /// What the program's steps say is on the flange, once the arm has moved.
    pub(crate) carried: Option<Load>,
    /// Whether a motion was sent, so that the program's tool is settled.
    pub(crate) has_moved: bool,
    /// The place of the last change of what is attached.
    pub(crate) attached_at: Option<Place>,
    /// The place of the last drive of a mobile platform, until a frame of the world is a target.
    pub(crate) driven_at: Option<Place>,
    /// The share of its speed at which the application runs, and where that was set.
    pub(crate) speed_override: Option<(f64, Place)>,
    /// The share at the first motion.
    pub(crate) first_override: Option<f64>,
    pub(crate) answers: Answers,
    /// How often each dialog was answered.
    pub(crate) answered: BTreeMap<String, usize>,
    /// Number of questions about a condition, by place.
    pub(crate) fired: BTreeMap<String, usize>,
    pub(crate) questions: Vec<Question>,
    /// All questions, with their answers.
    pub(crate) asked: Vec<Asked>,
    /// Answers after which another one is given to the same dialog.
    pub(crate) continued: usize,
    /// A value of an input that is tried, and not an answer yet.
    pub(crate) trial: Option<(String, bool)>,
    /// Values of inputs that end loops, where none is given.
    pub(crate) supposed: BTreeMap<String, bool>,
    /// The loop without an end in which the evaluation ended.
    pub(crate) endless: Option<EndlessLoop>,
    /// Readings of the arm's position, and of outputs and process data.
    pub(crate) position_readings: Cell<usize>,
    pub(crate) readings: usize,
    /// What was set, by `Group.Name`.
    pub(crate) outputs: BTreeMap<String, Value>,
    pub(crate) process_data: Vec<ProcessData>,
    /// What the application has made of process data, by id.
    pub(crate) changed_data: BTreeMap<String, Value>,
}

/// The assumption on where the arm stands before the first motion; with the joints of the first taught frame, as a proposal.
fn start_hint(cell: &ImportedCell, robot: &Robot) -> String {
    let hint = "the start is not given: the arm is taken to stand with all joints at 0";
    let taught = cell.frames.iter().find_map(|frame| {
        let FrameCheck { joints_rad, verdict } = frame.check(robot);
        Some((&frame.name, joints_rad.filter(|_| verdict == Verdict::Agrees)?))
    });
    let Some((name, joints_rad)) = taught else { return hint.to_owned() };
    let joints: Vec<_> =
        joints_rad.map(|q| format!("{}", (1e3 * q.to_degrees()).round() / 1e3)).into();
    format!("{hint}; it was at the frame `{name}` with {} deg", joints.join(","))
}

/// A frame of the data file's tree.
#[derive(Clone, Debug)]
pub(crate) struct TreeFrame {
    /// As `/FRAME/FRAME`.
    pub(crate) path: String,
    /// Its name in programs.
    pub(crate) name: String,
    /// Where it is in its parent.
    pub(crate) frame: Frame,
    pub(crate) parent: Option<usize>,
    /// Where the data file has it in the robot's foot.
    pub(crate) pose: Pose,
    /// Whether the application has changed it.
    pub(crate) is_changed: bool,
    /// The value on which its place depends, if the application has changed it by one that is not known.
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

    /// A frame of the tree, by its path with or without the first `/`.
    pub(crate) fn tree_frame(&self, path: &str) -> Option<usize> {
        let path = path.trim_matches('/');
        self.tree.iter().position(|frame| frame.path.trim_matches('/') == path)
    }

    /// The body of a template, as another one each time.
    pub(crate) fn made(&mut self, template: &Body) -> usize {
        self.bodies.push(template.clone());
        self.bodies.len() - 1
    }

    /// Where a spot is in the flange's frame; none if it does not hang on the flange.
    pub(crate) fn in_flange(&self, spot: Spot) -> Option<Frame> {
        if self.unknown_of(spot).is_some() {
            return None;
        }
        match spot {
            Spot::Flange => Some(Frame::default()),
            Spot::World | Spot::Tree(_) => None,
            Spot::Root(index) => {
                let (at, frame) = self.bodies.get(index)?.attached?;
                Some(then(&self.in_flange(at)?, &frame))
            }
            Spot::Of(index, frame) => {
                let own = self.bodies.get(index)?.frames.get(frame)?.frame;
                Some(then(&self.in_flange(Spot::Root(index))?, &own))
            }
        }
    }

    /// Where a spot is in the robot's foot; none if it is of something that lies anywhere.
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
                let found = self.tree.get(index)?;
                match found.parent {
                    Some(parent) => Some(then(&self.in_world(Spot::Tree(parent))?, &found.frame)),
                    None => Some(found.frame),
                }
            }
            Spot::Root(index) => {
                let (at, frame) = self.bodies.get(index)?.attached?;
                Some(then(&self.in_world(at)?, &frame))
            }
            Spot::Of(index, frame) => {
                let own = self.bodies.get(index)?.frames.get(frame)?.frame;
                Some(then(&self.in_world(Spot::Root(index))?, &own))
            }
        }
    }

    /// Where a frame is in the robot's foot.
    pub(crate) fn frame_in_world(&self, value: &FrameValue) -> Option<Frame> {
        match &value.parent {
            Parent::Spot(Spot::World) => Some(value.frame),
            Parent::Spot(spot) => Some(then(&self.in_world(*spot)?, &value.frame)),
            Parent::Frame(parent) => {
                Some(then(&self.frame_in_world(&parent.borrow())?, &value.frame))
            }
        }
    }

    /// By how many others something is attached to what does not move by itself.
    pub(crate) fn attached_deep(&self, mut spot: Spot) -> usize {
        let mut depth = 0;
        while let Some((at, _)) =
            spot.body().and_then(|body| self.bodies.get(body)).and_then(|body| body.attached)
        {
            (spot, depth) = (at, depth + 1);
        }
        depth
    }

    /// Whether something hangs on something else, by way of others or not.
    pub(crate) fn hangs_on(&self, spot: Spot, body: usize) -> bool {
        let Some(own) = spot.body() else { return false };
        let at = || self.bodies.get(own).and_then(|own| own.attached);
        own == body || at().is_some_and(|(at, _)| self.hangs_on(at, body))
    }

    /// All that hangs on the flange; none if that weighs nothing.
    pub(crate) fn flange_load(&self) -> Option<Load> {
        let of = |(index, body): (usize, &Body)| {
            let load = body.load.filter(|load| load.mass_kg > 0.0)?;
            Some((self.in_flange(Spot::Root(index))?, load))
        };
        together(&self.bodies.iter().enumerate().filter_map(of).collect::<Vec<_>>())
    }

    /// The name in programs of a tool that is at the flange as its template says.
    pub(crate) fn tool_at_flange(&self, index: usize) -> Option<&str> {
        let body = self.bodies.get(index)?;
        let is_plain = body.attached == Some((Spot::Flange, Frame::default()));
        body.in_programs.as_deref().filter(|_| is_plain)
    }

    /// The name in programs of a TCP; a tool is put together for those that no template says. None if it does not hang on
    /// the flange.
    pub(crate) fn tcp_name(&mut self, spot: Spot) -> Option<String> {
        let at = self.in_flange(spot)?;
        if at == Frame::default() && !matches!(spot, Spot::Of(..)) {
            let own = spot.body().and_then(|body| {
                let has_frames = self.bodies.get(body).is_some_and(|body| !body.frames.is_empty());
                self.tool_at_flange(body).filter(|_| !has_frames)
            });
            return Some(own.unwrap_or(FLANGE).to_owned());
        }
        let index = spot.body()?;
        if self.tool_at_flange(index).is_some()
            && let Spot::Of(_, frame) = spot
            // A frame that the application has added or changed is of no template.
            && let Some(own) = &self.bodies.get(index)?.frames.get(frame)?.in_programs
        {
            return Some(own.clone());
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
        let known = self.composed.iter().find(|(of, known, _)| *of == index && *known == tool);
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

    /// The TCP that moves if a tool or a workpiece does.
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

/// The name of the bare flange among tools of programs.
pub(crate) const FLANGE: &str = "flange";
/// The name of the robot's foot among bases of programs.
pub(crate) const FOOT: &str = "robot";

/// The frames of a cell, each behind the one that it is given in.
fn tree(cell: &ImportedCell) -> Vec<TreeFrame> {
    let workcell = &cell.workcell;
    let own = |name: &String| {
        let base = workcell.bases.get(name).map(|base| (base.frame, base.base.clone()));
        base.or_else(|| workcell.frames.get(name).map(|own| (own.frame, own.base.clone())))
    };
    let mut tree: Vec<TreeFrame> = Vec::with_capacity(cell.frames.len());
    for found in &cell.frames {
        let (frame, base) = own(&found.name).unwrap_or_default();
        let parent = base.and_then(|base| tree.iter().position(|above| above.name == base));
        tree.push(TreeFrame {
            path: found.path.clone(),
            name: found.name.clone(),
            frame,
            parent,
            pose: found.pose,
            is_changed: false,
            unknown: None,
        });
    }
    tree
}
