//! Tools, workpieces and their frames: their motions and attachments.

use std::rc::Rc;

use crate::QuestionKind;
use iiwa_java::{EvaluationStop, HostValue, Value};
use iiwa_json::meant;
use iiwa_program::Frame;

use crate::application::{
    arguments::robot_value,
    body::{Body, BodyFrame},
    frame_value::inverse,
    missing::Missing,
    robot_value::{LoadRef, RobotValue, robot},
    robotics::Robotics,
    spot::Spot,
};

/// Maximum length of a chain of attached objects: following it recursively uses stack.
const MAX_ATTACHED: usize = 100;

impl Robotics<'_> {
    /// Calls a method of an object's frame, or of a tool or workpiece itself.
    pub(crate) fn call_spot(
        &mut self,
        spot: Spot,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        match (name, arguments) {
            ("move" | "moveAsync", _) => self.move_by(spot, name == "moveAsync", arguments),
            ("attachTo", [to, ..]) => self.attach(spot, to, arguments.get(1)),
            ("detach", _) => {
                self.detach(spot)?;
                Ok(Value::Null)
            }
            ("getFrame" | "getChild" | "createFrame", [path, ..]) => self.frame_within(spot, path),
            ("getRootFrame", []) => Ok(robot(RobotValue::Spot(match spot.body() {
                Some(body) => Spot::Root(body),
                None => spot,
            }))),
            ("getDefaultMotionFrame", []) => {
                Ok(robot(RobotValue::Spot(self.station.default_frame(spot))))
            }
            ("setDefaultMotionFrame", [frame]) => {
                if let Value::Unknown(unknown) = frame {
                    return self.reject_unknown("the frame that moves", unknown);
                }
                self.set_default_frame(spot, frame);
                Ok(Value::Null)
            }
            ("getName", []) => Ok(Value::text(self.last_name(spot))),
            ("getPath", []) => Ok(Value::text(self.station.path_in_parent(spot))),
            ("getParent", []) => Ok(self.parent_spot(spot)),
            ("getChildren", []) => {
                let children = self.children(spot).into_iter().map(RobotValue::Spot);
                Ok(Value::list(children.map(robot).collect()))
            }
            ("isReadyToMove" | "isAttached", _) => {
                let attached = self.station.in_flange(spot).is_some();
                Ok(Value::Boolean(attached))
            }
            ("getLoadData", []) => Ok(match spot.body() {
                Some(body) => robot(RobotValue::Load(LoadRef::Body(body))),
                None => robot(RobotValue::Load(LoadRef::Own(Rc::default()))),
            }),
            ("addChildFrame" | "addDefaultMotionFrame" | "addFrame", _) => {
                self.add_child(spot, name, arguments)
            }
            (
                "setTransformationFromParent" | "changeTransformation" | "setTransformation",
                [to],
            ) => self.change_frame(spot, to),
            _ if spot.body().is_some()
                && (name.starts_with("grip") || name.starts_with("release")) =>
            {
                self.grip(name)
            }
            ("equals", [other]) => {
                let other = robot_value(other);
                Ok(Value::Boolean(
                    other.is_some_and(|other| RobotValue::Spot(spot).is_same(&other)),
                ))
            }
            ("setAdditionalParameter", _) => {
                self.note("`setAdditionalParameter` of a frame is left out of the plan");
                Ok(Value::Null)
            }
            // Other tool settings, such as the force of a gripper, are not planned.
            _ if changes(name) && matches!(spot, Spot::Root(_)) => {
                self.note(format!("`{name}` of a tool is left out of the plan"));
                Ok(Value::Null)
            }
            _ if changes(name) => {
                let object = self.spot_name(spot);
                self.reject(format!("`{name}` changes {object}, and its effect is not known"))
            }
            _ => match self.spot_frame(spot) {
                Some(frame) => self.frame_method(&frame, name, arguments),
                None => Ok(self.not_known(&format!("ObjectFrame.{name}"))),
            },
        }
    }

    /// Sends motions: `move(motion)` and `moveAsync(motion, ...)`.
    pub(crate) fn move_by(
        &mut self,
        mover: Spot,
        is_async: bool,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        match arguments {
            [Value::Unknown(unknown), ..] => self.reject_unknown("this motion", unknown),
            [Value::Null, ..] => self.throw("NullPointerException", "the motion is null"),
            [motion, ..] => {
                if let Some(RobotValue::Motion(motion)) = robot_value(motion) {
                    return self.send(mover, &motion, is_async);
                }
                let kind = motion.kind();
                self.reject(format!("{kind} is not a motion that can be planned"))
            }
            [] => self.throw("IllegalArgumentException", "a motion is missing"),
        }
    }

    fn attach(
        &mut self,
        spot: Spot,
        to: &Value,
        offset: Option<&Value>,
    ) -> Result<Value, EvaluationStop> {
        let Some(body) = spot.body() else {
            let subject = self.spot_name(spot);
            return self
                .reject(format!("{subject} is attached, and only tools and workpieces can be"));
        };
        let to = match robot_value(to) {
            Some(RobotValue::Robot) => Spot::Flange,
            Some(RobotValue::Spot(to)) => to,
            _ => match to {
                Value::Unknown(unknown) => {
                    return self.reject_unknown("what this tool is attached to", unknown);
                }
                Value::Null => return self.throw("NullPointerException", "it is attached to null"),
                _ => {
                    let kind = to.kind();
                    return self.reject(format!(
                        "a tool is attached to {kind}, which is not a frame of an object"
                    ));
                }
            },
        };
        if self.station.attached_deep(to) > MAX_ATTACHED {
            return self
                .reject(format!("more than {MAX_ATTACHED} things are attached to one another"));
        }
        if self.station.hangs_on(to, body) {
            return self.reject("a tool is attached to itself, directly or through other tools");
        }
        // The attached frame of the body coincides with the target frame.
        let spot_offset = match spot {
            Spot::Of(_, frame) => {
                let frame = self.station.bodies.get(body).and_then(|body| body.frames.get(frame));
                frame.map_or(Frame::default(), |frame| inverse(&frame.frame))
            }
            _ => Frame::default(),
        };
        let frame = match offset {
            None => spot_offset,
            Some(Value::Unknown(unknown)) => {
                return self.reject_unknown("how this tool is attached", unknown);
            }
            Some(offset) => match robot_value(offset) {
                Some(RobotValue::Transformation(offset)) => {
                    crate::application::frame_value::then(&offset, &spot_offset)
                }
                _ => return self.reject("how this tool is attached is not known"),
            },
        };
        if let Some(body) = self.station.bodies.get_mut(body) {
            body.attached = Some((to, frame));
        }
        let missing = self.station.bodies.get(body).filter(|body| body.missing.is_some());
        if let Some(name) = missing.map(|body| body.name.clone()) {
            self.note(format!(
                "the data file has no template `{name}`: `{name}` is planned without load"
            ));
        }
        self.load_changed()?;
        Ok(Value::Null)
    }

    fn detach(&mut self, spot: Spot) -> Result<(), EvaluationStop> {
        let body = spot.body().and_then(|body| self.station.bodies.get_mut(body));
        if let Some(body) = body {
            body.attached = None;
            self.load_changed()?;
        }
        Ok(())
    }

    /// Returns a frame by its path within another frame, or within a tool or workpiece.
    fn frame_within(&mut self, spot: Spot, path: &Value) -> Result<Value, EvaluationStop> {
        let path = match path {
            Value::Text(path) => path.to_string(),
            Value::Unknown(unknown) => return Ok(Value::Unknown(unknown.clone())),
            _ => return Ok(self.not_known("getFrame")),
        };
        let child = match spot {
            Spot::Root(index) => {
                let body = self.station.bodies.get(index);
                body.and_then(|body| body.frame(&path)).map(|frame| Spot::Of(index, frame))
            }
            Spot::Of(index, frame_index) => {
                let body = self.station.bodies.get(index);
                let above = body
                    .and_then(|body| body.frames.get(frame_index))
                    .map(|frame| frame.path.clone());
                let below =
                    format!("{}/{}", above.unwrap_or_default(), path.trim_start_matches('/'));
                body.and_then(|body| body.frame(&below).or_else(|| body.frame(&path)))
                    .map(|frame| Spot::Of(index, frame))
            }
            Spot::Tree(index) => {
                let above = self.station.tree.get(index).map(|tree_frame| tree_frame.path.clone());
                let below =
                    format!("{}/{}", above.unwrap_or_default(), path.trim_start_matches('/'));
                self.station.tree_frame(&below).map(Spot::Tree)
            }
            Spot::World => return self.tree_frame(&path),
            Spot::Flange => None,
        };
        if let Some(child) = child {
            return Ok(robot(RobotValue::Spot(child)));
        }
        self.check_template(spot)?;
        let missing = match spot {
            Spot::Tree(_) => Some(Missing::Frame(format!(
                "{}/{}",
                self.station.path_in_parent(spot).trim_end_matches('/'),
                path.trim_start_matches('/')
            ))),
            _ => spot.body().and_then(|index| self.station.bodies.get(index)).map(|body| {
                Missing::TemplateFrame { template: body.name.clone(), path: path.clone() }
            }),
        };
        self.station.missing.replace(missing);
        let known: Vec<String> = match spot.body().and_then(|body| self.station.bodies.get(body)) {
            Some(body) => body.frames.iter().map(|frame| frame.path.clone()).collect(),
            None => self
                .children(spot)
                .into_iter()
                .map(|child| self.station.path_in_parent(child))
                .collect(),
        };
        let subject = self.spot_name(spot);
        self.reject(format!("{subject} has no frame `{path}`{}", suggestions(&path, &known)))
    }

    /// Returns a frame of the data file, by its path.
    pub(crate) fn tree_frame(&mut self, path: &str) -> Result<Value, EvaluationStop> {
        if let Some(tree_frame) = self.station.tree_frame(path) {
            return Ok(robot(RobotValue::Spot(Spot::Tree(tree_frame))));
        }
        self.station.missing.replace(Some(Missing::Frame(path.to_owned())));
        let known: Vec<String> = self.station.tree.iter().map(|frame| frame.path.clone()).collect();
        self.reject(format!("the data file has no frame `{path}`{}", suggestions(path, &known)))
    }

    /// Creates a tool or workpiece from a template.
    pub(crate) fn body_of_template(&mut self, name: &Value) -> Result<Value, EvaluationStop> {
        let name = match name {
            Value::Text(name) => name.to_string(),
            Value::Unknown(unknown) => {
                return self.reject_unknown("the name of this template", unknown);
            }
            _ => return self.reject("a template is named by a string"),
        };
        let Some(template) = self.template(&name).or_else(|| self.given_body(&name, false)) else {
            self.station.missing.replace(Some(Missing::Template(name.clone())));
            let known: Vec<String> =
                self.station.templates.iter().map(|template| template.name.clone()).collect();
            return self.reject(format!(
                "the data file has no template `{name}`{}; add it there, or answer with its TCP: \
                 `[tools]`, `{name}`",
                suggestions(&name, &known)
            ));
        };
        let add_body = self.station.add_body(&template);
        Ok(robot(RobotValue::Spot(Spot::Root(add_body))))
    }

    pub(crate) fn template(&self, name: &str) -> Option<Body> {
        self.station.templates.iter().find(|template| template.name == name).cloned()
    }

    /// Returns the injected tool or workpiece of a template: the same body each time.
    pub(crate) fn injected_body(&mut self, name: &str, is_workpiece: bool) -> Value {
        let known = self.station.injected.get(name).copied();
        let add_body = known.unwrap_or_else(|| {
            let template = self.template(name).or_else(|| self.given_body(name, is_workpiece));
            let template = template.unwrap_or_else(|| Body {
                missing: Some(self.place.clone()),
                ..Body::bare(name, is_workpiece)
            });
            self.station.add_body(&template)
        });
        self.station.injected.insert(name.to_owned(), add_body);
        robot(RobotValue::Spot(Spot::Root(add_body)))
    }

    /// Creates a tool or workpiece whose frames are given as answers: its TCP as `Name`, other
    /// frames as `Name/Frame`.
    fn given_body(&mut self, name: &str, is_workpiece: bool) -> Option<Body> {
        let given = self.station.answers.tools.clone();
        let mut body = Body::bare(name, is_workpiece);
        for (key, frame) in given {
            let path = if key == name {
                body.default = Some(body.frames.len());
                "/TCP".to_owned()
            } else {
                match key.strip_prefix(name) {
                    Some(path) if path.starts_with('/') => path.to_owned(),
                    _ => continue,
                }
            };
            body.frames.push(BodyFrame { path, frame, in_programs: None, unknown: None });
            let numbers = frame.xyz_mm.into_iter().chain(frame.abc_rad.map(f64::to_degrees));
            let numbers: Vec<_> = numbers.map(|number| number.to_string()).collect();
            self.record(QuestionKind::Tool, &key, Vec::new(), numbers.join(","), true);
        }
        (!body.frames.is_empty()).then_some(body)
    }

    /// Returns the only tool or workpiece template with this class.
    pub(crate) fn template_of_class(&self, class: &str) -> Option<&str> {
        let has_class = |body: &&Body| {
            let simple_name = body
                .class
                .as_deref()
                .map(|qualified| qualified.rsplit('.').next().unwrap_or(qualified));
            simple_name == Some(class)
        };
        let mut templates = self.station.templates.iter().filter(has_class);
        let only = templates.next()?;
        templates.next().is_none().then_some(only.name.as_str())
    }

    fn last_name(&self, spot: Spot) -> String {
        let path = self.station.path_in_parent(spot);
        path.rsplit('/').next().unwrap_or_default().to_owned()
    }

    fn parent_spot(&self, spot: Spot) -> Value {
        let parent = match spot {
            Spot::World => return Value::Null,
            Spot::Flange => Spot::World,
            Spot::Tree(index) => {
                let parent = self.station.tree.get(index).and_then(|frame| frame.parent);
                parent.map_or(Spot::World, Spot::Tree)
            }
            Spot::Of(index, _) => Spot::Root(index),
            Spot::Root(index) => {
                match self.station.bodies.get(index).and_then(|body| body.attached) {
                    Some((parent, _)) => parent,
                    None => return Value::Null,
                }
            }
        };
        robot(RobotValue::Spot(parent))
    }

    /// Returns the child frames of a frame in the data file.
    fn children(&self, spot: Spot) -> Vec<Spot> {
        let parent = match spot {
            Spot::World => None,
            Spot::Tree(index) => Some(index),
            _ => return Vec::new(),
        };
        let tree = self.station.tree.iter().enumerate();
        tree.filter(|(_, frame)| frame.parent == parent)
            .map(|(index, _)| Spot::Tree(index))
            .collect()
    }

    /// Evaluates `new Tool(name, ...)` and `new Workpiece(name, ...)`: from the template of that
    /// name, or bare.
    pub(crate) fn new_body(&mut self, is_workpiece: bool, arguments: &[Value]) -> Value {
        let name = match arguments.first() {
            Some(Value::Text(name)) => name.to_string(),
            _ => if is_workpiece { "Workpiece" } else { "Tool" }.to_owned(),
        };
        let body = self.template(&name).unwrap_or_else(|| Body::bare(&name, is_workpiece));
        let mut body = body;
        match arguments.get(1).map(robot_value) {
            None => {}
            Some(Some(RobotValue::Load(load))) => body.load = Some(self.load_in(&load)),
            Some(_) if body.load.is_some() => {}
            Some(_) => {
                self.note(format!(
                    "the weight of `{name}` in its constructor is left out of the plan"
                ));
            }
        }
        let add_body = self.station.add_body(&body);
        robot(RobotValue::Spot(Spot::Root(add_body)))
    }

    /// Notes which frame of a tool moves if its template has no default frame: the only one of a
    /// gripper, else the root.
    pub(crate) fn note_default_frame(&mut self, mover: Spot) {
        let Spot::Root(index) = mover else { return };
        let Some(body) = self.station.bodies.get_mut(index) else { return };
        let (None, Some(first)) = (body.default, body.frames.first()) else { return };
        let is_plain = body.class.as_deref().is_none_or(|class| class.contains(".geometricModel."));
        let (name, path) = (&body.name, &first.path);
        let text = if is_plain || body.frames.len() > 1 {
            format!("`{name}` has no default motion frame: its root is the TCP of its motions")
        } else {
            let text =
                format!("`{name}` has no default motion frame: its only frame `{path}` is the TCP");
            body.default = Some(0);
            text
        };
        self.note(text);
    }

    fn set_default_frame(&mut self, spot: Spot, frame: &Value) {
        if let (Some(body_index), Some(RobotValue::Spot(frame))) = (spot.body(), robot_value(frame))
            && let Some(body) = self.station.bodies.get_mut(body_index)
        {
            body.default = match frame {
                Spot::Of(owner, index) if owner == body_index => Some(index),
                _ => None,
            };
        }
    }
}

/// Returns true if a method changes an object, by its name.
fn changes(name: &str) -> bool {
    let begins = |verb: &&str| name.starts_with(*verb);
    ["set", "change", "transform", "add", "remove"].iter().any(begins)
        && !name.starts_with("transformation")
}

/// Suggests names in place of `name`.
fn suggestions(name: &str, known: &[String]) -> String {
    /// More names would hide the message.
    const MAX_NAMES: usize = 8;
    if let Some(meant) = meant(name, known.iter().map(String::as_str)) {
        return format!("; did you mean `{meant}`?");
    }
    let shown: Vec<String> = known.iter().take(MAX_NAMES).map(|name| format!("`{name}`")).collect();
    let more = if known.len() > MAX_NAMES { ", ..." } else { "" };
    match shown.len() {
        0 => "; it has none".to_owned(),
        1 => format!("; there is {}", shown.concat()),
        _ => format!("; there are {}{more}", shown.join(", ")),
    }
}
