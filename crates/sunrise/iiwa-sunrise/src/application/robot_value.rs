//! Values of the robot API.

use std::{any::Any, cell::RefCell, rc::Rc};

use iiwa_java::{HostValue, Unknown, Value};
use iiwa_kin::{Joints, Load};
use iiwa_program::Frame;

use crate::application::{
    enum_constant::EnumConstant,
    frame_value::{FrameValue, RedundancyValue},
    motion_value::{MotionValue, PlanningObstacle},
    spot::Spot,
};

/// Value of KUKA's API; copies refer to the same object, as in Java.
#[derive(Clone, Debug)]
pub(crate) enum RobotValue {
    /// Robot, an `LBR`.
    Robot,
    /// `JointPosition`.
    Joints(Rc<RefCell<JointsValue>>),
    /// `Frame` that the program has created.
    Frame(Rc<RefCell<FrameValue>>),
    /// Frame of the data file, a tool, a workpiece or the robot, or one of these objects itself.
    Spot(Spot),
    Transformation(Rc<Frame>),
    Vector(Rc<[f64; 3]>),
    /// `LBRE1Redundancy`.
    Redundancy(Rc<RefCell<RedundancyValue>>),
    Motion(Rc<RefCell<MotionValue>>),
    /// Container of a sent motion.
    Container(Rc<Sent>),
    /// Joint limits of the robot.
    JointLimits,
    /// `LoadData`.
    Load(LoadRef),
    /// Process data, by their id.
    ProcessData(Rc<str>),
    /// I/O group, by its name.
    IoGroup(Rc<str>),
    Constant(Rc<EnumConstant>),
    Opaque(Rc<Opaque>),
}

/// One or several sent motions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sent {
    /// Number of motions sent up to and including this one.
    pub(crate) count: usize,
    /// `true` if a condition may end the motion.
    pub(crate) has_break: bool,
}

/// Reference to `LoadData`.
#[derive(Clone, Debug)]
pub(crate) enum LoadRef {
    /// Load of a tool or a workpiece, by its index among the created bodies.
    Body(usize),
    /// Load that the program has created.
    Own(Rc<RefCell<Load>>),
}

/// `JointPosition`.
#[derive(Clone, Debug)]
pub(crate) struct JointsValue {
    pub(crate) joints_rad: Joints,
    /// Unknown value on which the position depends, if any.
    pub(crate) unknown: Option<Rc<Unknown>>,
}

/// Object whose state does not affect the plan.
#[derive(Debug)]
pub(crate) struct Opaque {
    /// Simple name of the class.
    pub(crate) class: Rc<str>,
    /// Origin of its values, such as "a measured force"; otherwise they are results of unmodelled
    /// methods.
    pub(crate) gives: Option<Rc<str>>,
    /// Task of a thread or a timer.
    pub(crate) task: Option<Value>,
    /// Signal of an input, an output or a condition.
    pub(crate) signal: Option<SignalValue>,
}

/// Input or output, and the value that a condition compares it with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct SignalValue {
    /// Name as `Group.Name`.
    pub(crate) id: Rc<str>,
    /// Value of the condition; `None` for the signal itself.
    pub(crate) value: Option<bool>,
}

impl Opaque {
    fn new(class: &str) -> Self {
        Self { class: Rc::from(class), gives: None, task: None, signal: None }
    }

    /// Creates an input, an output or a condition.
    pub(crate) fn of_signal(class: &str, signal: SignalValue) -> Self {
        Self { signal: Some(signal), ..Self::new(class) }
    }
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

    /// Marks the contents of the value as unknown, where a program may change them.
    pub(crate) fn spoil(&self, unknown: &Rc<Unknown>) {
        let unknown = Rc::clone(unknown);
        match self {
            Self::Joints(joints) => joints.borrow_mut().unknown = Some(unknown),
            Self::Frame(frame) => frame.borrow_mut().unknown = Some(unknown),
            Self::Motion(motion) => {
                motion
                    .borrow_mut()
                    .obstruct(PlanningObstacle::Unknown("this motion".to_owned(), unknown));
            }
            _ => {}
        }
    }

    pub(crate) fn opaque(class: &str) -> Self {
        Self::Opaque(Rc::new(Opaque::new(class)))
    }

    /// Creates a thread, a timer or an executor; a thread has a task.
    pub(crate) fn thread(task: Option<Value>) -> Self {
        Self::Opaque(Rc::new(Opaque { task, ..Opaque::new("Thread") }))
    }

    /// Creates an object whose values are unknown, with their origin.
    pub(crate) fn source(class: &str, gives: &str) -> Self {
        Self::Opaque(Rc::new(Opaque { gives: Some(Rc::from(gives)), ..Opaque::new(class) }))
    }
}

/// Converts to a Java value.
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
