//! Values that the robot's API gives.

use std::{any::Any, cell::RefCell, rc::Rc};

use iiwa_java::{HostValue, Unknown, Value};
use iiwa_kin::{Joints, Load};
use iiwa_program::Frame;

use crate::application::{
    enum_constant::EnumConstant,
    frame_value::{FrameValue, RedundancyValue},
    motion_value::{MotionValue, Obstacle},
    spot::Spot,
};

/// A value of KUKA's API; copies are the same object, as in Java.
#[derive(Clone, Debug)]
pub(crate) enum RobotValue {
    /// The robot itself, an `LBR`.
    Robot,
    /// A `JointPosition`.
    Joints(Rc<RefCell<JointsValue>>),
    /// A `Frame` that the program has made.
    Frame(Rc<RefCell<FrameValue>>),
    /// A frame of the data file, of a tool, a workpiece or the robot, or one of these themselves.
    Spot(Spot),
    Transformation(Rc<Frame>),
    Vector(Rc<[f64; 3]>),
    /// An `LBRE1Redundancy`.
    Redundancy(Rc<RefCell<RedundancyValue>>),
    Motion(Rc<RefCell<MotionValue>>),
    /// The container of a motion that was sent.
    Container(Rc<Sent>),
    /// The limits of the robot's joints.
    JointLimits,
    /// A `LoadData`.
    Load(LoadRef),
    /// A value of the operator's, by its id.
    ProcessData(Rc<str>),
    /// A group of inputs and outputs, by its name.
    IoGroup(Rc<str>),
    Constant(Rc<EnumConstant>),
    Opaque(Rc<Opaque>),
}

/// A motion that was sent, or several.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sent {
    /// Number of motions sent by then.
    pub(crate) count: usize,
    /// True if a condition may end it.
    pub(crate) has_break: bool,
}

/// A `LoadData`.
#[derive(Clone, Debug)]
pub(crate) enum LoadRef {
    /// That of a tool or a workpiece, by its place among those that were made.
    Body(usize),
    /// One that the program has made.
    Own(Rc<RefCell<Load>>),
}

/// A `JointPosition`.
#[derive(Clone, Debug)]
pub(crate) struct JointsValue {
    pub(crate) joints_rad: Joints,
    /// What it depends on, if it is not known.
    pub(crate) unknown: Option<Rc<Unknown>>,
}

/// An object whose inside does not change what is planned.
#[derive(Debug)]
pub(crate) struct Opaque {
    /// Its class, by its simple name.
    pub(crate) class: Rc<str>,
    /// What values that it gives depend on, as "a measured force"; else they are results of methods that are not known.
    pub(crate) gives: Option<Rc<str>>,
    /// The task of a thread or a timer.
    pub(crate) task: Option<Value>,
}

impl RobotValue {
    pub(crate) fn joints(joints_rad: Joints) -> Self {
        Self::Joints(Rc::new(RefCell::new(JointsValue { joints_rad, unknown: None })))
    }

    pub(crate) fn frame(frame: FrameValue) -> Self {
        Self::Frame(Rc::new(RefCell::new(frame)))
    }

    pub(crate) fn motion(motion: MotionValue) -> Self {
        Self::Motion(Rc::new(RefCell::new(motion)))
    }

    /// Makes unknown what a program may change of the value.
    pub(crate) fn spoil(&self, unknown: &Rc<Unknown>) {
        let unknown = Rc::clone(unknown);
        match self {
            Self::Joints(own) => own.borrow_mut().unknown = Some(unknown),
            Self::Frame(own) => own.borrow_mut().unknown = Some(unknown),
            Self::Motion(own) => {
                own.borrow_mut().obstruct(Obstacle::Unknown("this motion".to_owned(), unknown));
            }
            _ => {}
        }
    }

    pub(crate) fn opaque(class: &str) -> Self {
        Self::Opaque(Rc::new(Opaque { class: Rc::from(class), gives: None, task: None }))
    }

    /// A thread, a timer or an executor; a thread has a task.
    pub(crate) fn thread(task: Option<Value>) -> Self {
        Self::Opaque(Rc::new(Opaque { class: Rc::from("Thread"), gives: None, task }))
    }

    /// An object from which values come that cannot be known, for a reason.
    pub(crate) fn source(class: &str, gives: &str) -> Self {
        Self::Opaque(Rc::new(Opaque {
            class: Rc::from(class),
            gives: Some(Rc::from(gives)),
            task: None,
        }))
    }
}

/// As a value of Java.
pub(crate) fn robot(value: RobotValue) -> Value {
    Value::Host(Rc::new(value))
}

impl HostValue for RobotValue {
    fn is_same(&self, other: &dyn HostValue) -> bool {
        let other: &dyn Any = other;
        let Some(other) = other.downcast_ref::<Self>() else { return false };
        match (self, other) {
            (Self::Robot, Self::Robot) | (Self::JointLimits, Self::JointLimits) => true,
            (Self::Joints(a), Self::Joints(b)) => Rc::ptr_eq(a, b),
            (Self::Frame(a), Self::Frame(b)) => Rc::ptr_eq(a, b),
            (Self::Spot(a), Self::Spot(b)) => a == b,
            (Self::Transformation(a), Self::Transformation(b)) => Rc::ptr_eq(a, b),
            (Self::Vector(a), Self::Vector(b)) => Rc::ptr_eq(a, b),
            (Self::Redundancy(a), Self::Redundancy(b)) => Rc::ptr_eq(a, b),
            (Self::Motion(a), Self::Motion(b)) => Rc::ptr_eq(a, b),
            (Self::Container(a), Self::Container(b)) => Rc::ptr_eq(a, b),
            (Self::ProcessData(a), Self::ProcessData(b)) | (Self::IoGroup(a), Self::IoGroup(b)) => {
                a == b
            }
            (Self::Load(LoadRef::Body(a)), Self::Load(LoadRef::Body(b))) => a == b,
            (Self::Load(LoadRef::Own(a)), Self::Load(LoadRef::Own(b))) => Rc::ptr_eq(a, b),
            (Self::Constant(a), Self::Constant(b)) => a == b,
            (Self::Opaque(a), Self::Opaque(b)) => Rc::ptr_eq(a, b),
            _ => false,
        }
    }

    fn kind(&self) -> &str {
        match self {
            Self::Robot => "a robot",
            Self::Joints(_) => "a joint position",
            Self::Frame(_) => "a frame",
            Self::Spot(Spot::Root(_)) => "a tool or workpiece",
            Self::Spot(_) => "a frame of an object",
            Self::Transformation(_) => "a transformation",
            Self::Vector(_) => "a vector",
            Self::Redundancy(_) => "a redundancy",
            Self::Motion(_) => "a motion",
            Self::Container(_) => "a motion container",
            Self::JointLimits => "the limits of the joints",
            Self::Load(_) => "load data",
            Self::ProcessData(_) => "process data",
            Self::IoGroup(_) => "a group of inputs and outputs",
            Self::Constant(_) => "a constant",
            Self::Opaque(_) => "an object of a library",
        }
    }

    fn class(&self) -> &str {
        match self {
            Self::Robot => "LBR",
            Self::Joints(_) => "JointPosition",
            Self::Frame(_) => "Frame",
            Self::Spot(Spot::Root(_)) => "Tool",
            Self::Spot(_) => "ObjectFrame",
            Self::Transformation(_) => "Transformation",
            Self::Vector(_) => "Vector",
            Self::Redundancy(_) => "LBRE1Redundancy",
            Self::Motion(_) => "RobotMotion",
            Self::Container(_) => "IMotionContainer",
            Self::JointLimits => "JointLimits",
            Self::Load(_) => "LoadData",
            Self::ProcessData(_) => "IProcessData",
            Self::IoGroup(_) => "AbstractIOGroup",
            Self::Constant(constant) => &constant.class,
            Self::Opaque(opaque) => &opaque.class,
        }
    }

    fn is_mutable(&self) -> bool {
        matches!(
            self,
            Self::Joints(_)
                | Self::Frame(_)
                | Self::Redundancy(_)
                | Self::Motion(_)
                | Self::Load(_)
        )
    }

    fn forget(&self, unknown: &Rc<Unknown>) {
        self.spoil(unknown);
    }

    fn can_act(&self) -> bool {
        matches!(self, Self::Robot | Self::Spot(_))
    }
}
