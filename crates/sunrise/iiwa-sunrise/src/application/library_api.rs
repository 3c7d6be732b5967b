//! KUKA and Java classes: their static methods, constructors and constants.

use std::rc::Rc;

use iiwa_java::{EvaluationStop, HostValue, Value};

use crate::application::{
    arguments::{first_unknown, numbers, robot_value},
    enum_constant::EnumConstant,
    frames_api::{new_redundancy, transformation_static},
    robot_value::{RobotValue, robot},
    robotics::Robotics,
    signals::signal_condition,
    spot::Spot,
};

/// Classes whose objects return values unknown before run time, by parts of their names, with the
/// origin of the values.
const SOURCES: [(&str, &str); 22] = [
    ("Socket", "data of a socket"),
    ("DatagramPacket", "data of a socket"),
    ("DatagramChannel", "data of a socket"),
    ("InetAddress", "data of a network"),
    ("URL", "data of a network"),
    ("InputStream", "data of a file or a socket"),
    ("OutputStream", "data of a file or a socket"),
    ("Reader", "data of a file or a socket"),
    ("Writer", "data of a file or a socket"),
    ("Scanner", "data of a file or a socket"),
    ("Properties", "data of a file"),
    ("File", "a file"),
    ("Files", "a file"),
    ("Paths", "a file"),
    ("Random", "a random number"),
    ("UUID", "a random number"),
    ("Date", "the clock"),
    ("SimpleDateFormat", "the clock"),
    ("Calendar", "the clock"),
    ("GregorianCalendar", "the clock"),
    ("Stopwatch", "the clock"),
    ("ObservableCommandBase", "a command of another device"),
];

/// Java classes for concurrent execution.
const CONCURRENT: [&str; 6] =
    ["Thread", "Timer", "TimerTask", "Executors", "ExecutorService", "CompletableFuture"];

/// KUKA classes whose objects do not affect the plan, by ends of their names.
const OPAQUE: [&str; 11] = [
    "ControlMode",
    "FRIConfiguration",
    "FRISession",
    "FRIJointOverlay",
    "Trigger",
    "Inertia",
    "Listener",
    "SafetyState",
    "DataRecorder",
    "ESM",
    "ErrorHandler",
];

/// Returns the origin of a class's values, if they are unknown before run time.
fn source(class: &str) -> Option<&'static str> {
    let sources = SOURCES
        .iter()
        .find(|(name, _)| class == *name || (name.len() > 5 && class.ends_with(name)));
    sources.map(|(_, gives)| *gives)
}

fn is_condition(class: &str) -> bool {
    class.ends_with("Condition")
}

impl Robotics<'_> {
    /// Calls a static method of a class outside the project; `None` if the class or the method is
    /// not modelled.
    pub(crate) fn robot_static(
        &mut self,
        class: &str,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        match (class, name, arguments) {
            ("BasicMotions" | "MMCMotions", ..) => self.new_motion(name, arguments),
            ("ThreadUtil" | "Thread", "milliSleep" | "sleep", [amount, ..]) => {
                self.sleep_ms(amount).map(Some)
            }
            ("Thread", "currentThread", []) => Ok(Some(robot(RobotValue::opaque("Thread")))),
            ("Thread", "interrupted", []) => Ok(Some(Value::Boolean(false))),
            ("Thread", "yield", []) => Ok(Some(Value::Null)),
            ("Class", "forName", _) => self.reject(
                "`Class.forName` finds a class while the program runs, which is not followed: name \
                 the class itself",
            ),
            ("System", "currentTimeMillis" | "nanoTime", _) => Ok(Some(self.unknown("the clock"))),
            ("Math" | "StrictMath", "random", _) => Ok(Some(self.unknown("a random number"))),
            ("Transformation" | "XyzAbcTransformation" | "MatrixTransformation", ..) => {
                Ok(transformation_static(name, arguments))
            }
            ("Vector", "of", _) => Ok(new_vector(arguments)),
            ("JointPosition", "ofDeg" | "ofRad", _) => {
                self.joints_static(name, arguments).map(Some)
            }
            ("FRIConfiguration", ..) => Ok(Some(robot(RobotValue::opaque("FRIConfiguration")))),
            ("ServoMotion", "validateForImpedanceMode", _) => Ok(Some(Value::Boolean(true))),
            (_, "values", []) => Ok(EnumConstant::all(class).map(|all| {
                let constants = all.into_iter().map(constant).collect();
                Value::array(class, constants)
            })),
            (_, "valueOf", [Value::Text(name)]) => {
                Ok(EnumConstant::named(class, name).map(constant))
            }
            _ if is_condition(class) => Ok(Some(condition())),
            _ if CONCURRENT.contains(&class) => Ok(Some(robot(RobotValue::opaque("Thread")))),
            _ => Ok(source(class).map(|gives| self.unknown(gives))),
        }
    }

    /// Creates an object of a class outside the project; `None` if the class is not modelled.
    pub(crate) fn robot_new(
        &mut self,
        class: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        match class {
            "Frame" => return Ok(Some(self.new_frame(arguments))),
            "JointPosition" => return self.new_joints(arguments).map(Some),
            "LoadData" => return Ok(Some(self.new_load(arguments))),
            "LBRE1Redundancy" => return Ok(Some(new_redundancy(arguments))),
            "Vector" => return Ok(new_vector(arguments)),
            "Tool" | "Workpiece" => {
                return Ok(Some(self.new_body(class == "Workpiece", arguments)));
            }
            _ => {}
        }
        if let Some(motion) = self.new_motion(class, arguments)? {
            return Ok(Some(motion));
        }
        if CONCURRENT.contains(&class) {
            let task = arguments.iter().find(|argument| argument.is_task()).cloned();
            return Ok(Some(robot(RobotValue::thread(task))));
        }
        if is_condition(class) {
            return Ok(Some(signal_condition(class, arguments).unwrap_or_else(condition)));
        }
        if let Some(gives) = source(class) {
            // A reader on a socket returns the socket's data.
            if let Some(unknown) = first_unknown(arguments) {
                return Ok(Some(Value::Unknown(unknown)));
            }
            return Ok(Some(robot(RobotValue::source(class, gives))));
        }
        if OPAQUE.iter().any(|end| class.ends_with(end)) {
            return Ok(Some(robot(RobotValue::opaque(class))));
        }
        Ok(match class.strip_suffix("IOGroup") {
            Some(group) if !group.is_empty() => Some(robot(RobotValue::IoGroup(Rc::from(group)))),
            _ => None,
        })
    }

    /// Returns a constant of a class outside the project; `None` if it is not modelled.
    pub(crate) fn robot_constant(
        &mut self,
        class: &str,
        name: &str,
    ) -> Result<Option<Value>, EvaluationStop> {
        Ok(match (class, name) {
            ("World", "Current") => Some(robot(RobotValue::Spot(Spot::World))),
            ("Transformation", "IDENTITY") => {
                Some(robot(RobotValue::Transformation(Rc::default())))
            }
            _ => match (EnumConstant::named(class, name), EnumConstant::all(class)) {
                (Some(enum_constant), _) => Some(constant(enum_constant)),
                (None, Some(_)) => {
                    return self.reject(format!("the enum `{class}` has no constant `{name}`"));
                }
                (None, None) => None,
            },
        })
    }

    /// Returns a field of an API value.
    #[expect(clippy::unnecessary_wraps, reason = "so are all that the language asks for")]
    pub(crate) fn robot_field(
        &mut self,
        receiver: &RobotValue,
        name: &str,
    ) -> Result<Value, EvaluationStop> {
        if let RobotValue::Constant(receiver_constant) = receiver
            && let Some(enum_constant) = EnumConstant::named(&receiver_constant.class, name)
        {
            return Ok(constant(enum_constant));
        }
        Ok(self.not_known(&format!("{}.{name}", receiver.class())))
    }
}

fn new_vector(arguments: &[Value]) -> Option<Value> {
    if let Some(unknown) = first_unknown(arguments) {
        return Some(Value::Unknown(unknown));
    }
    if let [only] = arguments
        && let Some(RobotValue::Vector(other)) = robot_value(only)
    {
        return Some(robot(RobotValue::Vector(other)));
    }
    let xyz: [f64; 3] = numbers(arguments)?.try_into().ok()?;
    Some(robot(RobotValue::Vector(Rc::new(xyz))))
}

fn constant(constant: EnumConstant) -> Value {
    robot(RobotValue::Constant(Rc::new(constant)))
}

/// Creates a condition, whose outcome is measured at run time.
fn condition() -> Value {
    robot(RobotValue::opaque("ICondition"))
}
