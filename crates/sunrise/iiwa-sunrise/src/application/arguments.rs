//! Arguments of API methods.

use std::{any::Any, rc::Rc};

use iiwa_java::{Unknown, Value};
use iiwa_kin::Joints;
use iiwa_program::Frame;

use crate::application::robot_value::RobotValue;

/// Returns the API value of a Java value; an object of a project class that inherits from a KUKA
/// class is the inherited value.
pub(crate) fn robot_value(value: &Value) -> Option<RobotValue> {
    match value {
        Value::Host(value) => {
            let value: &dyn Any = &**value;
            value.downcast_ref().cloned()
        }
        Value::Object(object) => object.inherited.borrow().as_ref().and_then(robot_value),
        _ => None,
    }
}

/// Returns the first unknown argument, also in an array, a list, a frame or a joint position.
pub(crate) fn first_unknown(arguments: &[Value]) -> Option<Rc<Unknown>> {
    arguments.iter().find_map(|argument| match argument {
        Value::Unknown(unknown) => Some(Rc::clone(unknown)),
        Value::Array(_) | Value::List(_) => first_unknown(&argument.elements()?),
        other => match robot_value(other)? {
            RobotValue::Joints(joints) => joints.borrow().unknown.clone(),
            RobotValue::Frame(frame) => frame.borrow().unknown.clone(),
            _ => None,
        },
    })
}

/// Flattens arrays and lists: `f(a, b)` and `f(new T[] {a, b})` are the same.
pub(crate) fn flattened(arguments: &[Value]) -> Vec<Value> {
    let elements = |argument: &Value| argument.elements().unwrap_or_else(|| vec![argument.clone()]);
    arguments.iter().flat_map(elements).collect()
}

/// Returns the arguments as numbers, if all are numbers.
pub(crate) fn numbers(arguments: &[Value]) -> Option<Vec<f64>> {
    flattened(arguments).iter().map(Value::number).collect()
}

/// Returns seven numbers, or a known joint position.
pub(crate) fn joints(arguments: &[Value]) -> Option<Joints> {
    if let [only] = arguments
        && let Some(RobotValue::Joints(joints)) = robot_value(only)
    {
        let joints = joints.borrow();
        return joints.unknown.is_none().then_some(joints.joints_rad);
    }
    numbers(arguments)?.try_into().ok()
}

/// Returns the frame of a position in mm, optionally with three angles in rad.
pub(crate) fn frame(numbers: &[f64]) -> Option<Frame> {
    match *numbers {
        [x, y, z] => Some(Frame { xyz_mm: [x, y, z], abc_rad: [0.0; 3] }),
        [x, y, z, a, b, c] => Some(Frame { xyz_mm: [x, y, z], abc_rad: [a, b, c] }),
        _ => None,
    }
}
