//! Creation of motions: methods of `BasicMotions`, and motion classes.

use std::{cell::RefCell, rc::Rc};

use iiwa_java::{EvaluationStop, Unknown, Value};
use iiwa_program::Frame;

use crate::application::{
    arguments::{first_unknown, flattened, frame, joints, numbers, robot_value},
    durations::hold_time,
    frame_value::FrameValue,
    motion_value::{HoldTime, MotionPath, MotionValue, PlanningObstacle, TargetFrame},
    robot_value::{RobotValue, robot},
    robotics::Robotics,
    spot::Spot,
};

/// Motion classes and methods of `BasicMotions` that cannot be planned, with the reason.
const REFUSED: [(&str, &str); 13] = [
    ("SmartServo", SERVO),
    ("SmartServoLIN", SERVO),
    ("DirectServo", SERVO),
    ("ServoMotion", SERVO),
    ("ServoMotionJP", SERVO),
    (
        "SplineJP",
        "its blends in joint space are not known; write its segments as ptp motions with a \
         blending",
    ),
    ("HandGuidingMotion", HAND_GUIDING),
    ("handGuiding", HAND_GUIDING),
    ("GMSReferencing", TESTS),
    ("BrakeTest", TESTS),
    ("BrakeMotion", TESTS),
    ("SafetyMotion", TESTS),
    ("CartesianSineMotion", "its time depends on the controller"),
];

const SERVO: &str = "its targets are given while it moves; plan it as motions to the targets, or \
    leave it out of the project's run";
const HAND_GUIDING: &str = "a person moves the arm, by a way and in a time that are not known; \
    leave it out, or go there by ptp";
const TESTS: &str =
    "it is a test of the robot's brakes or sensors, which runs on the controller alone";

/// Returns the kind of motion that a class or a method creates.
fn maker(name: &str) -> Option<&'static str> {
    Some(match name {
        "ptp" | "PTP" | "CartesianPTP" => "ptp",
        "ptpHome" => "ptpHome",
        "lin" | "LIN" => "lin",
        "linRel" | "RelativeLIN" => "linRel",
        "circ" | "CIRC" => "circ",
        "spl" | "SPL" => "spl",
        "Spline" => "spline",
        "batch" | "MotionBatch" => "batch",
        "positionHold" | "PositionHold" => "positionHold",
        _ => return None,
    })
}

impl Robotics<'_> {
    /// Creates a motion by the name of its class or of its method in `BasicMotions`; `None` if no
    /// such motion exists.
    pub(crate) fn new_motion(
        &mut self,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        if let Some((_, reason)) = REFUSED.iter().find(|(refused, _)| *refused == name) {
            let reason = format!("`{name}` cannot be planned ahead: {reason}");
            return Ok(Some(robot(RobotValue::motion(MotionValue::refused(reason)))));
        }
        let Some(kind) = maker(name) else { return Ok(None) };
        let way = match kind {
            "batch" | "spline" => return self.sequence(kind, arguments).map(Some),
            "positionHold" => return Ok(Some(position_hold(arguments))),
            _ if first_unknown(arguments).is_some() => {
                let mut motion = MotionValue::new(MotionPath::Refused);
                if let Some(unknown) = first_unknown(arguments) {
                    motion.obstruct(target_unknown(unknown));
                }
                return Ok(Some(robot(RobotValue::motion(motion))));
            }
            "ptpHome" => Some(MotionPath::Home),
            "ptp" => self.ptp(arguments)?,
            "lin" => goal(arguments).map(MotionPath::Lin),
            "spl" => goal(arguments).map(MotionPath::Spl),
            "circ" => match arguments {
                [aux, to] => {
                    let aux = goal(std::slice::from_ref(aux));
                    let to = goal(std::slice::from_ref(to));
                    aux.zip(to).map(|(aux, to)| MotionPath::Circ { aux, to })
                }
                _ => None,
            },
            _ => lin_rel(arguments),
        };
        match way {
            Some(way) => Ok(Some(robot(RobotValue::motion(MotionValue::new(way))))),
            None if arguments.iter().any(|argument| matches!(argument, Value::Null)) => {
                self.throw("NullPointerException", format!("the target of `{name}` is null"))
            }
            None => {
                let kinds: Vec<String> = arguments.iter().map(Value::kind).collect();
                let kinds = kinds.join(", ");
                self.reject(format!("`{name}` of {kinds} is not known: it takes joints or a frame"))
            }
        }
    }

    fn ptp(&mut self, arguments: &[Value]) -> Result<Option<MotionPath>, EvaluationStop> {
        if let [only] = arguments
            && let Some(RobotValue::Joints(joints)) = robot_value(only)
            && let Some(unknown) = &joints.borrow().unknown
        {
            return self.reject_unknown("the target of this motion", unknown);
        }
        if let Some(joints_rad) = joints(arguments) {
            return Ok(Some(MotionPath::Joints(joints_rad)));
        }
        if let Some(numbers) = numbers(arguments) {
            let count = numbers.len();
            return self.throw(
                "IllegalArgumentException",
                format!("a motion to joints takes 7 numbers, and here are {count}"),
            );
        }
        Ok(goal(arguments).map(MotionPath::Ptp))
    }

    /// Creates a batch or a spline.
    fn sequence(&mut self, kind: &str, arguments: &[Value]) -> Result<Value, EvaluationStop> {
        let arguments = flattened(arguments);
        let mut motions = Vec::with_capacity(arguments.len());
        for argument in &arguments {
            match robot_value(argument) {
                Some(RobotValue::Motion(motion)) => motions.push(motion),
                _ => match argument {
                    Value::Unknown(unknown) => {
                        let mut motion = MotionValue::new(MotionPath::Refused);
                        motion.obstruct(target_unknown(Rc::clone(unknown)));
                        motions.push(Rc::new(RefCell::new(motion)));
                    }
                    Value::Null => {
                        return self.throw("NullPointerException", "a motion of a batch is null");
                    }
                    other => {
                        let kind = other.kind();
                        return self.reject(format!(
                            "{kind} is not a motion: batches and splines have motions"
                        ));
                    }
                },
            }
        }
        let way =
            if kind == "spline" { MotionPath::Spline(motions) } else { MotionPath::Batch(motions) };
        let (depth, count) = way.extent();
        if depth > MAX_DEPTH || count > MAX_MOTIONS {
            return self.reject(format!(
                "a batch has {count} motions, {depth} batches deep; it can have {MAX_MOTIONS}, \
                 {MAX_DEPTH} deep"
            ));
        }
        Ok(robot(RobotValue::motion(MotionValue::new(way))))
    }
}

/// Maximum nesting depth of batches: following them recursively uses stack.
const MAX_DEPTH: usize = 20;
/// Maximum number of motions in a batch.
const MAX_MOTIONS: usize = 10_000;

/// Returns the target frame of a motion.
fn goal(arguments: &[Value]) -> Option<TargetFrame> {
    let [only] = arguments else { return None };
    match robot_value(only) {
        Some(RobotValue::Frame(frame)) => Some(TargetFrame::Frame(frame)),
        Some(RobotValue::Spot(spot)) => Some(TargetFrame::Spot(spot)),
        // A transformation is a frame in the world.
        Some(RobotValue::Transformation(frame)) => {
            let frame = FrameValue::within(Spot::World, *frame);
            Some(TargetFrame::Frame(Rc::new(RefCell::new(frame))))
        }
        _ => None,
    }
}

fn lin_rel(arguments: &[Value]) -> Option<MotionPath> {
    let (offset, within) = match arguments {
        // The setters define the offset.
        [] => (Some(Frame::default()), None),
        [offset] => (offset_of(std::slice::from_ref(offset)), None),
        [offset, within] if !is_number(offset) => {
            (offset_of(std::slice::from_ref(offset)), Some(within))
        }
        [numbers @ .., within] if !is_number(within) => (offset_of(numbers), Some(within)),
        numbers => (offset_of(numbers), None),
    };
    let within = match within {
        Some(within) => Some(goal(std::slice::from_ref(within))?),
        None => None,
    };
    Some(MotionPath::LinRel { offset: offset?, within })
}

/// Creates a position hold.
fn position_hold(arguments: &[Value]) -> Value {
    let mut motion = MotionValue::new(MotionPath::Hold(HoldTime::UntilEnded));
    match arguments {
        [_, Value::Unknown(unknown), _] | [_, _, Value::Unknown(unknown)] => {
            let subject = "the time of this hold".to_owned();
            motion.obstruct(PlanningObstacle::Unknown(subject, Rc::clone(unknown)));
        }
        [_, time, unit] => {
            let amount = time.number();
            let seconds = match robot_value(unit) {
                Some(RobotValue::Constant(unit)) => amount.and_then(|time| unit.seconds(time)),
                _ => None,
            };
            if let Some(seconds) = seconds {
                motion.way = MotionPath::Hold(hold_time(seconds));
            } else {
                let reason = "the time of this hold is not a number and a unit of time";
                motion.obstruct(PlanningObstacle::Refused(reason.to_owned()));
            }
        }
        // Without a time, the hold is unlimited.
        _ => {}
    }
    robot(RobotValue::motion(motion))
}

fn target_unknown(unknown: Rc<Unknown>) -> PlanningObstacle {
    PlanningObstacle::Unknown("the target of this motion".to_owned(), unknown)
}

fn is_number(value: &Value) -> bool {
    value.number().is_some()
}

/// Returns an offset from numbers, or from a transformation.
fn offset_of(arguments: &[Value]) -> Option<Frame> {
    match arguments {
        [only] if !is_number(only) => match robot_value(only)? {
            RobotValue::Transformation(offset) => Some(*offset),
            RobotValue::Vector(vector) => Some(Frame { xyz_mm: *vector, abc_rad: [0.0; 3] }),
            _ => None,
        },
        numbers => frame(&self::numbers(numbers)?),
    }
}
