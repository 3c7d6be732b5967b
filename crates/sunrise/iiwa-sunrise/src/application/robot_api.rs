//! Dispatch of KUKA's API methods, and the robot's own methods.

use std::rc::Rc;

use iiwa_java::{EvaluationStop, HostValue, Value};
use iiwa_kin::Joints;
use iiwa_program::Frame;

use crate::application::{
    arguments::{first_unknown, joints, robot_value},
    frame_value::{FrameValue, RedundancyValue, inverse, then},
    robot_value::{RobotValue, robot},
    robotics::Robotics,
    spot::Spot,
};

/// Sensor measurements, by words in method names.
const MEASURED: [(&str, &str); 4] = [
    ("ForceTorque", "a measured force"),
    ("Torque", "a measured torque"),
    ("Force", "a measured force"),
    ("Temperature", "a measured temperature"),
];

/// Prefixes of methods that change nothing.
const READING: [&str; 8] = ["get", "is", "has", "to", "equals", "distance", "copy", "compare"];

impl Robotics<'_> {
    /// Calls a method of an API value. An unmodelled method may have changed the value.
    pub(crate) fn call_robot(
        &mut self,
        receiver: &RobotValue,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        match (name, arguments) {
            ("toString", []) => return Ok(Value::text(self.station.robot_text(receiver))),
            ("hashCode", []) => return Ok(self.unknown("a hash code")),
            ("getClass", []) => return Ok(Value::ForeignClass(Rc::from(receiver.class()))),
            ("equals", [Value::Unknown(unknown)]) => return Ok(Value::Unknown(unknown.clone())),
            ("equals", [other])
                if !matches!(receiver, RobotValue::Joints(_) | RobotValue::Spot(_)) =>
            {
                let other = robot_value(other);
                return Ok(Value::Boolean(other.is_some_and(|other| receiver.is_same(&other))));
            }
            _ => {}
        }
        let result = self.call_known(receiver, name, arguments)?;
        if let Value::Unknown(unknown) = &result
            && !READING.iter().any(|begin| name.starts_with(begin))
        {
            receiver.spoil(unknown);
            let is_new = unknown.is_unmodelled_call;
            match receiver {
                RobotValue::Redundancy(_) => {
                    return self.reject(format!("`{name}` of a redundancy is not evaluated"));
                }
                RobotValue::Robot | RobotValue::Spot(_) if is_new => {
                    let kind = receiver.kind();
                    self.note(format!(
                        "`{name}` of {kind} is not evaluated: its effect is left out"
                    ));
                }
                _ => {}
            }
        }
        Ok(result)
    }

    fn call_known(
        &mut self,
        receiver: &RobotValue,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        match receiver {
            RobotValue::Robot => self.call_lbr(name, arguments),
            RobotValue::Joints(joints) => self.call_joints(joints, name, arguments),
            RobotValue::Frame(frame) => self.call_frame(frame, name, arguments),
            RobotValue::Spot(spot) => self.call_spot(*spot, name, arguments),
            RobotValue::Transformation(frame) => {
                Ok(self.call_transformation(frame, name, arguments))
            }
            RobotValue::Vector(vector) => Ok(self.call_vector(vector, name, arguments)),
            RobotValue::Redundancy(redundancy) => self.call_redundancy(redundancy, name, arguments),
            RobotValue::Motion(motion) => self.call_motion(motion, name, arguments),
            RobotValue::Container(sent) => self.call_container(**sent, name),
            RobotValue::JointLimits => Ok(self.call_limits(name)),
            RobotValue::Load(load) => self.call_load(load, name, arguments),
            RobotValue::ProcessData(id) => self.call_process_data(id, name, arguments),
            RobotValue::IoGroup(group) => self.call_io_group(group, name, arguments),
            RobotValue::Constant(constant) => self.call_constant(constant, name, arguments),
            RobotValue::Opaque(opaque) => self.call_opaque(opaque, name, arguments),
        }
    }

    /// Calls a method of the robot.
    fn call_lbr(&mut self, name: &str, arguments: &[Value]) -> Result<Value, EvaluationStop> {
        if matches!(name, "move" | "moveAsync") {
            return self.move_by(Spot::Flange, name == "moveAsync", arguments);
        }
        if let Some((_, quantity)) = MEASURED.iter().find(|(word, _)| name.contains(word)) {
            return Ok(self.unknown(*quantity));
        }
        if let Some(unknown) = first_unknown(arguments) {
            return Ok(Value::Unknown(unknown));
        }
        match (name, arguments) {
            ("getFlange" | "getDefaultMotionFrame", []) => {
                Ok(robot(RobotValue::Spot(Spot::Flange)))
            }
            ("getRootFrame" | "getBaseFrame", []) => Ok(robot(RobotValue::Spot(Spot::World))),
            ("getCurrentJointPosition" | "getCommandedJointPosition", []) => {
                self.know_where("its joints");
                Ok(robot(RobotValue::joints(self.station.at_rad)))
            }
            (
                "getCurrentCartesianPosition" | "getCommandedCartesianPosition",
                [frame, rest @ ..],
            ) => {
                self.know_where("its position");
                self.cartesian_position(frame, rest.first())
            }
            ("getForwardKinematic", [position, ..]) => {
                match joints(std::slice::from_ref(position)) {
                    Some(joints_rad) => Ok(self.frame_at(&joints_rad, &Frame::default())),
                    None => Ok(self.not_known("LBR.getForwardKinematic")),
                }
            }
            ("getInverseKinematicFromFrameAndRedundancy", [frame, ..]) => {
                self.inverse_kinematics(frame)
            }
            ("setHomePosition", [position]) => {
                let joints_rad = match joints(std::slice::from_ref(position)) {
                    Some(joints_rad) => Some(joints_rad),
                    None => joints(&[self.inverse_kinematics(position)?]),
                };
                match joints_rad {
                    Some(joints_rad) => self.station.home_rad = joints_rad,
                    None => return self.reject("the home position is not known"),
                }
                Ok(Value::Null)
            }
            ("getHomePosition", []) => Ok(robot(RobotValue::joints(self.station.home_rad))),
            ("getJointLimits", []) => Ok(robot(RobotValue::JointLimits)),
            ("getJointCount", []) => Ok(Value::Int(7)),
            ("isReadyToMove" | "isMastered" | "isGMSReferenced" | "isPositionReferenced", _) => {
                Ok(Value::Boolean(true))
            }
            ("hasActiveMotionCommand", []) => {
                if self.station.schedule.is_under_way() || self.station.schedule.is_holding() {
                    self.note(
                        "a program that asks whether the arm moves is planned as if it \
                        awaited its end",
                    );
                    self.station.schedule.await_all();
                }
                Ok(Value::Boolean(false))
            }
            ("getController", []) => Ok(robot(RobotValue::opaque("Controller"))),
            ("detachAll", []) => {
                for body in 0..self.station.bodies.len() {
                    self.call_spot(Spot::Root(body), "detach", &[])?;
                }
                Ok(Value::Null)
            }
            (
                "setESMState" | "setSafetyWorkpiece" | "addControllerListener" | "addJointLimits",
                _,
            ) => Ok(Value::Null),
            ("setApplicationOverride", [share]) => self.set_override(share),
            _ => Ok(self.not_known(&format!("LBR.{name}"))),
        }
    }

    /// Notes that the position is queried while the robot may be moving: the result is the end
    /// position.
    fn know_where(&mut self, query: &str) {
        let readings = &self.station.position_readings;
        readings.set(readings.get() + 1);
        if self.station.schedule.is_under_way() {
            self.note(format!(
                "the arm is asked for {query} while it moves: it gets those of the motion's end"
            ));
        }
    }

    /// Returns the pose of an object's frame, in the world or in another frame.
    fn cartesian_position(
        &mut self,
        frame: &Value,
        reference: Option<&Value>,
    ) -> Result<Value, EvaluationStop> {
        let spot = match robot_value(frame) {
            Some(RobotValue::Spot(spot)) => self.station.default_frame(spot),
            _ => return Ok(self.not_known("LBR.getCurrentCartesianPosition")),
        };
        if let Some(unknown) = self.station.unknown_of(spot) {
            return Ok(Value::Unknown(unknown));
        }
        self.check_template(spot)?;
        let Some(tcp) = self.station.in_flange(spot) else {
            let subject = self.spot_name(spot);
            return self.reject(format!(
                "the position of {subject} is requested, but it is not attached to the flange"
            ));
        };
        let at_rad = self.station.at_rad;
        let position = self.frame_at(&at_rad, &tcp);
        let Some(reference) = reference else { return Ok(position) };
        match (robot_value(&position), robot_value(reference)) {
            (Some(RobotValue::Frame(current)), Some(RobotValue::Spot(reference))) => {
                let Some(base) = self.station.in_world(reference) else {
                    return Ok(self.not_known("LBR.getCurrentCartesianPosition"));
                };
                let current = current.borrow().clone();
                let frame = then(&inverse(&base), &current.frame);
                let within = FrameValue {
                    redundancy: current.redundancy,
                    ..FrameValue::within(reference, frame)
                };
                Ok(robot(RobotValue::frame(within)))
            }
            _ => Ok(self.not_known("LBR.getCurrentCartesianPosition")),
        }
    }

    /// Returns the TCP frame at joint positions, with the redundancy.
    fn frame_at(&self, joints_rad: &Joints, tcp: &Frame) -> Value {
        let model = &self.station.robot;
        let pose = model.flange_pose(joints_rad).then(&tcp.pose());
        let values = model.redundancy(joints_rad);
        let redundancy = RedundancyValue {
            e1_rad: Some(values.e1_rad),
            status: Some(values.status),
            turn: Some(values.turn.bits()),
        };
        let frame = FrameValue::within(Spot::World, Frame::from(&pose));
        robot(RobotValue::frame(FrameValue { redundancy, ..frame }))
    }

    /// Returns the joint positions for the flange at a frame with E1 and status.
    fn inverse_kinematics(&mut self, frame: &Value) -> Result<Value, EvaluationStop> {
        let Some(frame) = self.frame_of(frame) else {
            return Ok(self.not_known("LBR.getInverseKinematicFromFrameAndRedundancy"));
        };
        let RedundancyValue { e1_rad: Some(e1_rad), status: Some(status), .. } = frame.redundancy
        else {
            return self.throw("IllegalArgumentException", "the frame has no redundancy data");
        };
        let Some(place) = self.station.frame_in_world(&frame) else {
            return self
                .reject("a frame is given relative to an object that is not attached to anything");
        };
        match self.station.robot.inverse(&place.pose(), e1_rad, status) {
            Ok(joints_rad) => Ok(robot(RobotValue::joints(joints_rad))),
            Err(reason) => self.throw("CommandInvalidException", reason.to_string()),
        }
    }

    /// Calls a method of the joint limits.
    fn call_limits(&mut self, name: &str) -> Value {
        let limits = self.station.robot.limits();
        let joint_values = match name {
            "getMaxJointPosition" => limits.upper_rad,
            "getMinJointPosition" => limits.lower_rad,
            "getMaxJointVelocity" => limits.velocity_rad_s,
            _ => return self.not_known(&format!("JointLimits.{name}")),
        };
        robot(RobotValue::joints(joint_values))
    }

    /// Sets the override of an application.
    pub(crate) fn set_override(&mut self, share: &Value) -> Result<Value, EvaluationStop> {
        match share {
            Value::Unknown(unknown) => self.reject_unknown("the speed of the application", unknown),
            share => {
                let share = share.number().unwrap_or(1.0);
                self.station.speed_override = (share < 1.0).then(|| (share, self.place.clone()));
                Ok(Value::Null)
            }
        }
    }

    /// Returns the result of an unmodelled method, such as `Frame.getX`.
    pub(crate) fn not_known(&self, method: &str) -> Value {
        self.unmodelled_result(method, "")
    }
}
