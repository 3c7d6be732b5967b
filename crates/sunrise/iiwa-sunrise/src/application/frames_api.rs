//! Frames, transformations, vectors and redundancies.

use std::{cell::RefCell, rc::Rc};

use iiwa_java::{EvaluationStop, Value};
use iiwa_kin::{
    Pose, Status, Turn,
    rotation::{norm, product, sub, transposed},
};
use iiwa_program::Frame;

use crate::application::{
    arguments::{first_unknown, frame, numbers, robot_value},
    frame_value::{FrameValue, Parent, RedundancyValue, inverse, then},
    robot_value::{RobotValue, robot},
    robotics::Robotics,
    spot::Spot,
};

/// Indices of a frame's numbers by the ends of its method names.
const NUMBERS: [(&str, usize); 6] =
    [("X", 0), ("Y", 1), ("Z", 2), ("AlphaRad", 3), ("BetaRad", 4), ("GammaRad", 5)];

/// Returns one of x, y, z, a, b, c.
fn number_of(frame: &Frame, index: usize) -> f64 {
    frame.xyz_mm.iter().chain(&frame.abc_rad).nth(index).copied().unwrap_or_default()
}

fn with_number(frame: &mut Frame, index: usize, value: f64) {
    if let Some(number) = frame.xyz_mm.iter_mut().chain(&mut frame.abc_rad).nth(index) {
        *number = value;
    }
}

fn index_of(name: &str, verb: &str) -> Option<usize> {
    let component = name.strip_prefix(verb)?;
    NUMBERS.iter().find(|(end, _)| *end == component).map(|(_, index)| *index)
}

fn transformation(frame: Frame) -> Value {
    robot(RobotValue::Transformation(Rc::new(frame)))
}

fn vector(xyz: [f64; 3]) -> Value {
    robot(RobotValue::Vector(Rc::new(xyz)))
}

/// Offsets `frame` by `offset`, given along the axes of `reference`.
fn offset_along(frame: &Frame, offset: &Frame, reference: &Pose) -> Frame {
    let pose = frame.pose();
    let by = offset.pose();
    let axes = &reference.rotation;
    let moved = iiwa_kin::rotation::apply(axes, &by.position_m);
    let turn = product(&product(axes, &by.rotation), &transposed(axes));
    Frame::from(&Pose {
        position_m: std::array::from_fn(|i| pose.position_m[i] + moved[i]),
        rotation: product(&turn, &pose.rotation),
    })
}

impl Robotics<'_> {
    /// Calls a method of a frame that the program has created.
    pub(crate) fn call_frame(
        &mut self,
        this: &Rc<RefCell<FrameValue>>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let changes = name.starts_with("set") || name == "transform";
        let result = self.frame_call(this, changes, name, arguments)?;
        // After an unmodelled change, the pose of a frame is unknown.
        if changes && let Value::Unknown(unknown) = &result {
            this.borrow_mut().unknown.get_or_insert(Rc::clone(unknown));
            return Ok(robot(RobotValue::Frame(Rc::clone(this))));
        }
        Ok(result)
    }

    fn frame_call(
        &mut self,
        this: &Rc<RefCell<FrameValue>>,
        changes: bool,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let this_frame = || robot(RobotValue::Frame(Rc::clone(this)));
        if changes && let Some(unknown) = first_unknown(arguments) {
            this.borrow_mut().unknown.get_or_insert(unknown);
            return Ok(this_frame());
        }
        if !changes && let Some(unknown) = &this.borrow().unknown {
            return Ok(Value::Unknown(Rc::clone(unknown)));
        }
        if let Some(index) = index_of(name, "set") {
            let Some([value]) =
                numbers(arguments).as_deref().and_then(|n| n.first_chunk().copied())
            else {
                return Ok(self.not_known(&format!("Frame.{name}")));
            };
            with_number(&mut this.borrow_mut().frame, index, value);
            return Ok(this_frame());
        }
        match (name, arguments) {
            ("transform", [offset]) => {
                let Some(offset) = offset_of(offset) else {
                    return Ok(self.not_known("Frame.transform"));
                };
                let mut frame = this.borrow_mut();
                frame.frame = then(&frame.frame, &offset);
                drop(frame);
                Ok(this_frame())
            }
            ("transform", [reference, offset]) => Ok(self.transform_in(this, reference, offset)),
            ("setRedundancyInformation", [.., redundancy]) => {
                let Some(RobotValue::Redundancy(redundancy)) = robot_value(redundancy) else {
                    return Ok(self.not_known("Frame.setRedundancyInformation"));
                };
                this.borrow_mut().redundancy = *redundancy.borrow();
                Ok(this_frame())
            }
            ("setParent", [parent, rest @ ..]) => {
                let keeps_place = !matches!(rest, [Value::Boolean(false)]);
                self.set_parent(this, parent, keeps_place)
            }
            ("setTransformationFromParent", [transformation]) => {
                let Some(frame) = offset_of(transformation) else {
                    return Ok(self.not_known("Frame.setTransformationFromParent"));
                };
                this.borrow_mut().frame = frame;
                Ok(this_frame())
            }
            _ => {
                let value = this.borrow().clone();
                self.frame_method(&value, name, arguments)
            }
        }
    }

    /// Rotates and moves a frame along the axes of another frame.
    fn transform_in(
        &mut self,
        this: &Rc<RefCell<FrameValue>>,
        reference: &Value,
        offset: &Value,
    ) -> Value {
        let frame = this.borrow().clone();
        let reference =
            self.frame_of(reference).and_then(|frame| self.station.frame_in_world(&frame));
        let parent = self.parent_in_world(&frame);
        let (Some(reference), Some(parent), Some(offset)) = (reference, parent, offset_of(offset))
        else {
            return self.not_known("Frame.transform");
        };
        let in_world = offset_along(&then(&parent, &frame.frame), &offset, &reference.pose());
        this.borrow_mut().frame = then(&inverse(&parent), &in_world);
        robot(RobotValue::Frame(Rc::clone(this)))
    }

    fn parent_in_world(&self, frame: &FrameValue) -> Option<Frame> {
        match &frame.parent {
            Parent::Spot(spot) => self.station.in_world(*spot),
            Parent::Frame(parent) => self.station.frame_in_world(&parent.borrow()),
        }
    }

    fn set_parent(
        &mut self,
        this: &Rc<RefCell<FrameValue>>,
        parent: &Value,
        keeps_place: bool,
    ) -> Result<Value, EvaluationStop> {
        let Some(parent) = self.parent_of(parent) else {
            return Ok(self.not_known("Frame.setParent"));
        };
        let mut frame = this.borrow().clone();
        let in_world = self.station.frame_in_world(&frame);
        frame.parent = parent;
        if keeps_place {
            let (Some(in_world), Some(parent)) = (in_world, self.parent_in_world(&frame)) else {
                return self.reject(
                    "a frame is given relative to an object that is not attached to anything",
                );
            };
            frame.frame = then(&inverse(&parent), &in_world);
        }
        *this.borrow_mut() = frame;
        Ok(robot(RobotValue::Frame(Rc::clone(this))))
    }

    /// Calls a method that does not change the frame.
    pub(crate) fn frame_method(
        &mut self,
        this: &FrameValue,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        if let Some(unknown) = &this.unknown {
            return Ok(Value::Unknown(Rc::clone(unknown)));
        }
        if let Some(index) = index_of(name, "get") {
            return Ok(Value::Double(number_of(&this.frame, index)));
        }
        match (name, arguments) {
            ("copy", []) => {
                let redundancy = RedundancyValue::default();
                let copy = FrameValue { redundancy, ..this.clone() };
                Ok(robot(RobotValue::frame(copy)))
            }
            ("copyWithRedundancy", []) => Ok(robot(RobotValue::frame(this.clone()))),
            ("copy" | "copyWithRedundancy", [parent]) => {
                let Some(new_parent) = self.parent_of(parent) else {
                    return Ok(self.not_known(&format!("Frame.{name}")));
                };
                let redundancy =
                    if name == "copy" { RedundancyValue::default() } else { this.redundancy };
                let Some(in_world) = self.station.frame_in_world(this) else {
                    return self.reject(
                        "a frame is given relative to an object that is not attached to anything",
                    );
                };
                let mut copy = FrameValue { redundancy, parent: new_parent, ..this.clone() };
                let parent = self.parent_in_world(&copy).unwrap_or_default();
                copy.frame = then(&inverse(&parent), &in_world);
                Ok(robot(RobotValue::frame(copy)))
            }
            ("getTransformationFromParent", []) => Ok(transformation(this.frame)),
            ("transformationFromWorld", []) => Ok(match self.station.frame_in_world(this) {
                Some(frame) => transformation(frame),
                None => self.not_known("Frame.transformationFromWorld"),
            }),
            ("transformationTo" | "staticTransformationTo" | "distanceTo", [other]) => {
                let from = self.station.frame_in_world(this);
                let to = self.frame_of(other).and_then(|frame| self.station.frame_in_world(&frame));
                let (Some(from), Some(to)) = (from, to) else {
                    return Ok(self.not_known(&format!("Frame.{name}")));
                };
                if name == "distanceTo" {
                    return Ok(Value::Double(norm(&sub(&to.xyz_mm, &from.xyz_mm))));
                }
                Ok(transformation(then(&inverse(&from), &to)))
            }
            ("getParent", []) => Ok(match &this.parent {
                Parent::Spot(spot) => robot(RobotValue::Spot(*spot)),
                Parent::Frame(parent) => robot(RobotValue::Frame(Rc::clone(parent))),
            }),
            ("getRedundancyInformationForDevice" | "getRedundancyInformation", _) => {
                let redundancy = Rc::new(RefCell::new(this.redundancy));
                Ok(robot(RobotValue::Redundancy(redundancy)))
            }
            ("hasRedundancyInformation" | "hasRedundancyInformationForDevice", _) => {
                Ok(Value::Boolean(this.redundancy != RedundancyValue::default()))
            }
            ("getPosition" | "getTranslation", []) => Ok(vector(this.frame.xyz_mm)),
            _ => Ok(self.unmodelled_result(name, " of a frame")),
        }
    }

    /// Returns the frame of a value, with its parent.
    pub(crate) fn frame_of(&self, value: &Value) -> Option<FrameValue> {
        match robot_value(value)? {
            RobotValue::Frame(frame) => {
                let frame = frame.borrow().clone();
                Some(frame).filter(|frame| frame.unknown.is_none())
            }
            RobotValue::Spot(spot) => self.spot_frame(spot).filter(|frame| frame.unknown.is_none()),
            RobotValue::Transformation(frame) => Some(FrameValue::within(Spot::World, *frame)),
            _ => None,
        }
    }

    /// Returns a station frame relative to its parent; relative to the world if it moves with the
    /// robot.
    pub(crate) fn spot_frame(&self, spot: Spot) -> Option<FrameValue> {
        if let Some(unknown) = self.station.unknown_of(spot) {
            let root = FrameValue::within(Spot::World, Frame::default());
            return Some(FrameValue { unknown: Some(unknown), ..root });
        }
        let Spot::Tree(index) = spot else {
            return Some(FrameValue::within(Spot::World, self.station.in_world(spot)?));
        };
        let tree_frame = self.station.tree.get(index)?;
        let parent = tree_frame.parent.map_or(Spot::World, Spot::Tree);
        let target = self.station.workcell.frames.get(&tree_frame.name);
        let redundancy = target.map_or(RedundancyValue::default(), |target| RedundancyValue {
            e1_rad: target.e1_rad,
            status: target.status,
            turn: target.turn,
        });
        Some(FrameValue { redundancy, ..FrameValue::within(parent, tree_frame.frame) })
    }

    /// Returns the parent for a new frame. A parent frame is copied with its current pose, since a
    /// frame does not move when its parent is set later.
    fn parent_of(&self, value: &Value) -> Option<Parent> {
        match robot_value(value)? {
            RobotValue::Spot(spot) => Some(Parent::Spot(spot)),
            RobotValue::Frame(frame) => {
                let frame = frame.borrow().clone();
                let place = self.station.frame_in_world(&frame)?;
                let parent =
                    FrameValue { frame: place, parent: Parent::Spot(Spot::World), ..frame };
                Some(Parent::Frame(Rc::new(RefCell::new(parent))))
            }
            _ => None,
        }
    }

    /// Evaluates `new Frame(...)`.
    pub(crate) fn new_frame(&mut self, arguments: &[Value]) -> Value {
        if let Some(unknown) = first_unknown(arguments) {
            return Value::Unknown(unknown);
        }
        let (parent, rest) = match arguments {
            [] => (Parent::Spot(Spot::World), arguments),
            [first, rest @ ..] => match self.parent_of(first) {
                Some(parent) => (parent, rest),
                None => (Parent::Spot(Spot::World), arguments),
            },
        };
        let transformation = match rest {
            [] => Some(Frame::default()),
            [only] if only.number().is_none() => offset_of(only),
            numbers => frame(&self::numbers(numbers).unwrap_or_default()),
        };
        let Some(transformation) = transformation else { return self.not_known("new Frame") };
        let frame = FrameValue { parent, ..FrameValue::within(Spot::World, transformation) };
        robot(RobotValue::frame(frame))
    }

    /// Calls a method of a transformation.
    pub(crate) fn call_transformation(
        &mut self,
        this: &Frame,
        name: &str,
        arguments: &[Value],
    ) -> Value {
        if let Some(unknown) = first_unknown(arguments) {
            return Value::Unknown(unknown);
        }
        if let Some(index) = index_of(name, "get") {
            return Value::Double(number_of(this, index));
        }
        match (name, arguments) {
            ("invert" | "inverse", []) => transformation(inverse(this)),
            ("compose", [other]) => match offset_of(other) {
                Some(other) => transformation(then(this, &other)),
                None => self.not_known("Transformation.compose"),
            },
            ("getTranslation", []) => vector(this.xyz_mm),
            ("withTranslation", [by]) => match robot_value(by) {
                Some(RobotValue::Vector(xyz)) => transformation(Frame { xyz_mm: *xyz, ..*this }),
                _ => self.not_known("Transformation.withTranslation"),
            },
            _ => self.not_known(&format!("Transformation.{name}")),
        }
    }

    /// Calls a method of a vector.
    pub(crate) fn call_vector(
        &mut self,
        this: &[f64; 3],
        name: &str,
        arguments: &[Value],
    ) -> Value {
        if let Some(unknown) = first_unknown(arguments) {
            return Value::Unknown(unknown);
        }
        let other = match arguments {
            [only] => robot_value(only),
            _ => None,
        };
        match (name, other, numbers(arguments).as_deref()) {
            ("getX", ..) => Value::Double(this[0]),
            ("getY", ..) => Value::Double(this[1]),
            ("getZ", ..) => Value::Double(this[2]),
            ("length", ..) => Value::Double(norm(this)),
            ("invert", ..) => vector(this.map(|x| -x)),
            ("add", Some(RobotValue::Vector(other)), _) => {
                vector(std::array::from_fn(|i| this[i] + other[i]))
            }
            ("subtract", Some(RobotValue::Vector(other)), _) => {
                vector(std::array::from_fn(|i| this[i] - other[i]))
            }
            ("multiply", _, Some([factor])) => vector(this.map(|x| x * factor)),
            _ => self.not_known(&format!("Vector.{name}")),
        }
    }

    /// Calls a method of a redundancy.
    pub(crate) fn call_redundancy(
        &mut self,
        this: &Rc<RefCell<RedundancyValue>>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        if let Some(unknown) = first_unknown(arguments) {
            return self.reject_unknown("the redundancy of a frame", &unknown);
        }
        let this_value = robot(RobotValue::Redundancy(Rc::clone(this)));
        let mut redundancy = this.borrow_mut();
        let whole = |bits: Option<u8>| bits.map_or(Value::Null, |bits| Value::Int(bits.into()));
        Ok(match (name, arguments) {
            ("setE1", [e1]) => {
                redundancy.e1_rad = e1.number();
                this_value
            }
            ("setStatus", [status]) => {
                redundancy.status = bits(status).and_then(Status::new);
                this_value
            }
            ("setTurn", [turn]) => {
                redundancy.turn = bits(turn).and_then(Turn::new).map(Turn::bits);
                this_value
            }
            ("getE1", []) => redundancy.e1_rad.map_or(Value::Null, Value::Double),
            ("getStatus", []) => whole(redundancy.status.map(Status::bits)),
            ("getTurn", []) => whole(redundancy.turn),
            _ => self.not_known(&format!("LBRE1Redundancy.{name}")),
        })
    }
}

/// Returns the transformation of a value.
pub(crate) fn offset_of(value: &Value) -> Option<Frame> {
    match robot_value(value)? {
        RobotValue::Transformation(offset) => Some(*offset),
        RobotValue::Frame(frame) => {
            let frame = frame.borrow();
            frame.unknown.is_none().then_some(frame.frame)
        }
        _ => None,
    }
}

/// Evaluates `Transformation.ofDeg(...)` and similar methods; `None` if the method does not exist.
pub(crate) fn transformation_static(name: &str, arguments: &[Value]) -> Option<Value> {
    if let Some(unknown) = first_unknown(arguments) {
        return Some(Value::Unknown(unknown));
    }
    let given = numbers(arguments);
    let add_body = match (name, given.as_deref()) {
        ("ofDeg", Some([x, y, z, a, b, c])) => {
            let abc_rad = [*a, *b, *c].map(f64::to_radians);
            Frame { xyz_mm: [*x, *y, *z], abc_rad }
        }
        ("ofRad" | "of", Some(numbers @ [_, _, _, _, _, _]))
        | ("ofTranslation", Some(numbers @ [_, _, _])) => frame(numbers)?,
        ("ofRotationDeg", Some([a, b, c])) => {
            Frame { xyz_mm: [0.0; 3], abc_rad: [*a, *b, *c].map(f64::to_radians) }
        }
        ("ofRotationRad", Some([a, b, c])) => Frame { xyz_mm: [0.0; 3], abc_rad: [*a, *b, *c] },
        ("ofTranslation", None) => match robot_value(arguments.first()?)? {
            RobotValue::Vector(xyz) => Frame { xyz_mm: *xyz, abc_rad: [0.0; 3] },
            _ => return None,
        },
        _ => return None,
    };
    Some(transformation(add_body))
}

/// Evaluates `new LBRE1Redundancy(...)`.
pub(crate) fn new_redundancy(arguments: &[Value]) -> Value {
    if let Some(unknown) = first_unknown(arguments) {
        return Value::Unknown(unknown);
    }
    let mut add_body = RedundancyValue::default();
    if let [e1, status, turn] = arguments {
        add_body.e1_rad = e1.number();
        add_body.status = bits(status).and_then(Status::new);
        add_body.turn = bits(turn).and_then(Turn::new).map(Turn::bits);
    }
    robot(RobotValue::Redundancy(Rc::new(RefCell::new(add_body))))
}

fn bits(value: &Value) -> Option<u8> {
    value.integer().and_then(|bits| u8::try_from(bits).ok())
}
