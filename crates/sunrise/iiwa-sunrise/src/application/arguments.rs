//! Arguments of the API's methods.

use std::{any::Any, rc::Rc};

use iiwa_java::{Unknown, Value};
use iiwa_kin::Joints;
use iiwa_program::Frame;

use crate::application::robot_value::RobotValue;

/// What a value is for the robot's API: an object of a project's class that inherits from one of KUKA's is that one.
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

/// The first argument that is not known, also in an array, a list, a frame or a joint position.
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

/// The arguments, those of an array or a list one by one: `f(a, b)` and `f(new T[] {a, b})` are the same.
pub(crate) fn flattened(arguments: &[Value]) -> Vec<Value> {
    let elements = |argument: &Value| argument.elements().unwrap_or_else(|| vec![argument.clone()]);
    arguments.iter().flat_map(elements).collect()
}

/// The arguments as numbers, if all are.
pub(crate) fn numbers(arguments: &[Value]) -> Option<Vec<f64>> {
    flattened(arguments).iter().map(Value::number).collect()
}

/// Seven numbers, or a joint position that is known.
pub(crate) fn joints(arguments: &[Value]) -> Option<Joints> {
    if let [only] = arguments
        && let Some(RobotValue::Joints(joints)) = robot_value(only)
    {
        let joints = joints.borrow();
        return joints.unknown.is_none().then_some(joints.joints_rad);
    }
    numbers(arguments)?.try_into().ok()
}

/// Three numbers for a place in mm, or three more for angles in rad.
pub(crate) fn frame(numbers: &[f64]) -> Option<Frame> {
    match *numbers {
        [x, y, z] => Some(Frame { xyz_mm: [x, y, z], abc_rad: [0.0; 3] }),
        [x, y, z, a, b, c] => Some(Frame { xyz_mm: [x, y, z], abc_rad: [a, b, c] }),
        _ => None,
    }
}
