//! Frames of tools, workpieces and the data file that an application adds or changes.

use std::rc::Rc;

use iiwa_java::{EvaluationStop, Unknown, Value};
use iiwa_program::Frame;

use crate::application::{
    arguments::first_unknown,
    body::BodyFrame,
    frame_value::{inverse, then},
    frames_api::offset_of,
    missing::Missing,
    robot_value::{RobotValue, robot},
    robotics::Robotics,
    spot::Spot,
    station::Station,
};

impl Station {
    /// Returns the unknown value on which the pose of a frame depends, if any: of the frame itself,
    /// or of a parent.
    pub(crate) fn unknown_of(&self, spot: Spot) -> Option<Rc<Unknown>> {
        match spot {
            Spot::World | Spot::Flange => None,
            Spot::Tree(index) => {
                let frame = self.tree.get(index)?;
                let above = || self.unknown_of(Spot::Tree(frame.parent?));
                frame.unknown.clone().or_else(above)
            }
            Spot::Root(index) => self.unknown_of(self.bodies.get(index)?.attached?.0),
            Spot::Of(index, frame) => {
                let unknown = self.bodies.get(index)?.frames.get(frame)?.unknown.clone();
                unknown.or_else(|| self.unknown_of(Spot::Root(index)))
            }
        }
    }

    /// Returns true if the application has moved a frame of the data file, or one of its parents.
    pub(crate) fn is_changed(&self, index: usize) -> bool {
        let Some(frame) = self.tree.get(index) else { return false };
        frame.is_changed || frame.parent.is_some_and(|parent| self.is_changed(parent))
    }
}

impl Robotics<'_> {
    /// Refuses a frame whose pose is unknown.
    pub(crate) fn check_known(&self, spot: Spot) -> Result<(), EvaluationStop> {
        if let Some(unknown) = self.station.unknown_of(spot) {
            let subject = format!("the place of {}", self.spot_name(spot));
            return self.reject_unknown(&subject, &unknown);
        }
        self.check_template(spot)
    }

    /// Refuses a tool or workpiece that neither the data file nor an answer describes.
    pub(crate) fn check_template(&self, spot: Spot) -> Result<(), EvaluationStop> {
        let Some(body) = spot.body().and_then(|index| self.station.bodies.get(index)) else {
            return Ok(());
        };
        let Some(place) = &body.missing else { return Ok(()) };
        let name = &body.name;
        self.station.missing.replace(Some(Missing::Template(name.clone())));
        self.reject(format!(
            "the data file has no template `{name}`, which is injected at {place}: its frames are \
             not known; add the template, or answer with its frames: `[tools]`, `{name}` for the \
             TCP and `{name}/FRAME` for others"
        ))
    }

    /// Evaluates `addChildFrame(name, transformation)` and `addDefaultMotionFrame(name,
    /// transformation)` of a tool or workpiece, or of one of its frames.
    pub(crate) fn add_child(
        &mut self,
        spot: Spot,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let (Some(index), Some(Value::Text(frame_name))) = (spot.body(), arguments.first()) else {
            return self.reject(format!(
                "`{name}` takes a name and a transformation, of a tool or workpiece"
            ));
        };
        let unknown = first_unknown(arguments);
        let offset = match arguments.get(1) {
            None | Some(Value::Unknown(_)) => Some(Frame::default()),
            Some(other) => offset_of(other),
        };
        let Some(offset) = offset else {
            return self.reject(format!("`{name}` takes a name and a transformation"));
        };
        let Some(body) = self.station.bodies.get_mut(index) else {
            return self.reject("this tool is not known");
        };
        let above = match spot {
            Spot::Of(_, frame) => body.frames.get(frame),
            _ => None,
        };
        let path = format!(
            "{}/{}",
            above.map_or("", |above| &above.path),
            frame_name.trim_start_matches('/')
        );
        let frame = above.map_or(offset, |above| then(&above.frame, &offset));
        let unknown = unknown.or_else(|| above.and_then(|above| above.unknown.clone()));
        let added = BodyFrame { path, frame, in_programs: None, unknown };
        body.frames.push(added);
        let frame = body.frames.len() - 1;
        // The application defines the frames, so that no template is needed.
        body.missing = None;
        if name == "addDefaultMotionFrame" {
            body.default = Some(frame);
        }
        Ok(robot(RobotValue::Spot(Spot::Of(index, frame))))
    }

    /// Changes the transformation of an object's frame from its parent.
    pub(crate) fn change_frame(&mut self, spot: Spot, to: &Value) -> Result<Value, EvaluationStop> {
        let (frame, unknown) = match (offset_of(to), to) {
            (Some(frame), _) => (frame, None),
            (None, Value::Unknown(unknown)) => (Frame::default(), Some(Rc::clone(unknown))),
            (None, other) => {
                let kind = other.kind();
                return self.reject(format!(
                    "a frame is changed to {kind}, which is not a transformation"
                ));
            }
        };
        match spot {
            Spot::Tree(index) => {
                if let Some(tree_frame) = self.station.tree.get_mut(index) {
                    (tree_frame.frame, tree_frame.unknown, tree_frame.is_changed) =
                        (frame, unknown, true);
                }
            }
            Spot::Of(index, frame_index) => {
                if let Some(body) = self.station.bodies.get_mut(index) {
                    body.change(frame_index, frame, unknown.as_ref());
                }
                if self
                    .station
                    .bodies
                    .iter()
                    .any(|body| body.attached.is_some_and(|(parent, _)| parent == spot))
                {
                    self.load_changed()?;
                }
            }
            Spot::World | Spot::Flange | Spot::Root(_) => {
                let subject = self.spot_name(spot);
                return self.reject(format!("{subject} is changed, which cannot be planned"));
            }
        }
        Ok(robot(RobotValue::Spot(spot)))
    }

    /// Evaluates `changeFrameTransformation(frame, transformation)` of the application data.
    pub(crate) fn change_data_frame(
        &mut self,
        frame: &Value,
        to: &Value,
    ) -> Result<Value, EvaluationStop> {
        match (robot_value_of(frame), frame) {
            (Some(spot), _) => self.change_frame(spot, to),
            (None, Value::Unknown(unknown)) => {
                self.reject_unknown("which frame is changed", unknown)
            }
            _ => self.reject("a frame of the data file is changed, and it is not known which one"),
        }
    }
}

fn robot_value_of(value: &Value) -> Option<Spot> {
    match crate::application::arguments::robot_value(value)? {
        RobotValue::Spot(spot) => Some(spot),
        _ => None,
    }
}

impl crate::application::body::Body {
    /// Changes the pose of a frame in its parent; child frames move along.
    fn change(&mut self, changed_index: usize, frame: Frame, unknown: Option<&Rc<Unknown>>) {
        let Some(changed) = self.frames.get(changed_index) else { return };
        let (path, old) = (changed.path.clone(), changed.frame);
        let above = path.rsplit_once('/').map_or("", |(above, _)| above);
        let within = self.frames.iter().find(|frame| frame.path == above).map(|frame| frame.frame);
        let new = within.map_or(frame, |within| then(&within, &frame));
        let below = format!("{path}/");
        for (index, other) in self.frames.iter_mut().enumerate() {
            if index == changed_index {
                other.frame = new;
            } else if other.path.starts_with(&below) {
                other.frame = then(&new, &then(&inverse(&old), &other.frame));
            } else {
                continue;
            }
            other.unknown = unknown.cloned();
            other.in_programs = None;
        }
    }
}
