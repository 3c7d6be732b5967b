//! Joint positions.

use std::{cell::RefCell, rc::Rc};

use iiwa_java::{EvaluationStop, Value};
use iiwa_kin::Joints;

use crate::application::{
    arguments::{first_unknown, joints, numbers, robot_value},
    robot_value::{JointsValue, RobotValue, robot},
    robotics::Robotics,
};

impl Robotics<'_> {
    /// Evaluates `new JointPosition(...)`: of seven numbers, an array or another joint position, or
    /// all zero for a number of joints.
    pub(crate) fn new_joints(&mut self, arguments: &[Value]) -> Result<Value, EvaluationStop> {
        if let Some(unknown) = first_unknown(arguments) {
            return Ok(Value::Unknown(unknown));
        }
        if let [only] = arguments
            && let Some(RobotValue::Joints(other)) = robot_value(only)
        {
            let copy = other.borrow().clone();
            return Ok(robot(RobotValue::Joints(Rc::new(RefCell::new(copy)))));
        }
        if let Some(joints_rad) = joints(arguments) {
            return Ok(robot(RobotValue::joints(joints_rad)));
        }
        match numbers(arguments).as_deref() {
            Some([7.0]) => Ok(robot(RobotValue::joints([0.0; 7]))),
            Some(other) => {
                let count = other.len();
                let message =
                    format!("a joint position of this robot has 7 numbers, and here are {count}");
                self.throw("IllegalArgumentException", message)
            }
            None => Ok(self.not_known("new JointPosition")),
        }
    }

    /// Evaluates `JointPosition.ofDeg(...)` and `JointPosition.ofRad(...)` of Sunrise 2, with seven
    /// numbers or an array.
    pub(crate) fn joints_static(
        &mut self,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let add_body = self.new_joints(arguments)?;
        if name == "ofDeg"
            && let Some(RobotValue::Joints(joints)) = robot_value(&add_body)
        {
            let mut joints = joints.borrow_mut();
            joints.joints_rad = joints.joints_rad.map(f64::to_radians);
        }
        Ok(add_body)
    }

    /// Calls a method of a joint position.
    pub(crate) fn call_joints(
        &mut self,
        this: &Rc<RefCell<JointsValue>>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        if name == "set" {
            return self.set_joint(this, arguments);
        }
        if let Some(unknown) = &this.borrow().unknown {
            return Ok(Value::Unknown(Rc::clone(unknown)));
        }
        if let Some(unknown) = first_unknown(arguments) {
            return Ok(Value::Unknown(unknown));
        }
        let q = this.borrow().joints_rad;
        match (name, arguments) {
            ("get", [joint]) => {
                let index = self.joint_index(joint)?;
                Ok(Value::Double(q.get(index).copied().unwrap_or_default()))
            }
            ("getAxisCount" | "getJointCount" | "length", []) => Ok(Value::Int(7)),
            ("toArray" | "get" | "getArray", []) => {
                Ok(Value::array("double", q.map(Value::Double).to_vec()))
            }
            ("copy" | "clone", []) => Ok(robot(RobotValue::joints(q))),
            ("isNearlyEqual", [other, tolerance]) => {
                let near = joints(std::slice::from_ref(other)).zip(tolerance.number());
                Ok(match near {
                    Some((other, tolerance)) => Value::Boolean(
                        q.iter().zip(other).all(|(q, other)| (q - other).abs() <= tolerance),
                    ),
                    None => self.not_known("JointPosition.isNearlyEqual"),
                })
            }
            ("equals", [other]) => {
                let other = joints(std::slice::from_ref(other));
                Ok(Value::Boolean(other.is_some_and(|other| other == q)))
            }
            _ => Ok(self.not_known(&format!("JointPosition.{name}"))),
        }
    }

    fn set_joint(
        &mut self,
        this: &Rc<RefCell<JointsValue>>,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let this_value = robot(RobotValue::Joints(Rc::clone(this)));
        if let Some(unknown) = first_unknown(arguments) {
            this.borrow_mut().unknown.get_or_insert(unknown);
            return Ok(this_value);
        }
        match arguments {
            [joint, value] => {
                let index = self.joint_index(joint)?;
                let Some(value) = value.number() else {
                    return Ok(self.not_known("JointPosition.set"));
                };
                if let Some(joint) = this.borrow_mut().joints_rad.get_mut(index) {
                    *joint = value;
                }
                Ok(this_value)
            }
            all => {
                let Some(joints_rad) = joints(all) else {
                    return Ok(self.not_known("JointPosition.set"));
                };
                *this.borrow_mut() = JointsValue { joints_rad, unknown: None };
                Ok(this_value)
            }
        }
    }

    /// Returns the index of a joint, by its number from 0 or by its constant.
    fn joint_index(&mut self, joint: &Value) -> Result<usize, EvaluationStop> {
        let index = match robot_value(joint) {
            Some(RobotValue::Constant(constant)) => Some(i64::from(constant.ordinal)),
            _ => joint.integer(),
        };
        let count = i64::try_from(Joints::default().len()).unwrap_or_default();
        match index {
            Some(index) if (0..count).contains(&index) => {
                Ok(usize::try_from(index).unwrap_or_default())
            }
            Some(index) => self.throw(
                "IndexOutOfBoundsException",
                format!("the robot has no joint of index {index}"),
            ),
            None => self.throw("IllegalArgumentException", "a joint is a number, or a `JointEnum`"),
        }
    }
}
