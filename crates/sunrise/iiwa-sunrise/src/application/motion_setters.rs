//! Setters of motions.

use std::{cell::RefCell, rc::Rc};

use iiwa_java::{EvaluationStop, Value};
use iiwa_kin::Joints;
use iiwa_program::{AuxOrientation, LimitKind, OrientationType};

use crate::application::{
    arguments::{first_unknown, numbers, robot_value},
    motion_value::{MotionPath, MotionValue, PlanningObstacle},
    robot_value::{RobotValue, robot},
    robotics::Robotics,
};

/// Setting that a setter changes.
#[derive(Clone, Copy)]
enum Setting {
    Share(LimitKind),
    Way(LimitKind),
    Turn(LimitKind),
    BlendingCart,
    BlendingRel,
    BlendingOri,
    CircAngle,
}

fn setting(name: &str) -> Option<Setting> {
    use LimitKind::{Acceleration, Jerk, Velocity};
    Some(match name {
        "setJointVelocityRel" => Setting::Share(Velocity),
        "setJointAccelerationRel" => Setting::Share(Acceleration),
        "setJointJerkRel" => Setting::Share(Jerk),
        "setCartVelocity" => Setting::Way(Velocity),
        "setCartAcceleration" => Setting::Way(Acceleration),
        "setCartJerk" => Setting::Way(Jerk),
        "setOrientationVelocity" => Setting::Turn(Velocity),
        "setOrientationAcceleration" => Setting::Turn(Acceleration),
        "setOrientationJerk" => Setting::Turn(Jerk),
        "setBlendingCart" => Setting::BlendingCart,
        "setBlendingRel" => Setting::BlendingRel,
        "setBlendingOri" => Setting::BlendingOri,
        "setCircAngle" => Setting::CircAngle,
        _ => return None,
    })
}

/// Words in the names of setters that limit a motion or change its target.
const DECISIVE: [&str; 12] = [
    "Velocity",
    "Acceleration",
    "Jerk",
    "Blending",
    "Override",
    "Offset",
    "Destination",
    "Target",
    "Frame",
    "Position",
    "Transformation",
    "Redundancy",
];

/// Returns the component of a relative motion's offset (x, y, z in mm; a, b, c in rad) that a
/// setter changes.
fn offset_component(name: &str) -> Option<usize> {
    let component = name.strip_prefix("set")?.strip_suffix("Offset")?;
    Some(match component {
        "X" => 0,
        "Y" => 1,
        "Z" => 2,
        "Alpha" | "A" => 3,
        "Beta" | "B" => 4,
        "Gamma" | "C" => 5,
        _ => return None,
    })
}

impl Robotics<'_> {
    /// Calls a method of a motion; setters return the motion.
    pub(crate) fn call_motion(
        &mut self,
        motion: &Rc<RefCell<MotionValue>>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let this = || robot(RobotValue::Motion(Rc::clone(motion)));
        if let Some(setting) = setting(name) {
            self.set(motion, name, setting, arguments)?;
            return Ok(this());
        }
        let is_relative = matches!(motion.borrow().way, MotionPath::LinRel { .. });
        if is_relative && let Some(component) = offset_component(name) {
            self.set_offset(motion, name, component, arguments)?;
            return Ok(this());
        }
        match name {
            "setMode" => {
                if arguments.iter().any(|mode| !matches!(mode, Value::Null)) {
                    self.note(
                        "the control mode is ignored: the plan is the same in all control \
                        modes",
                    );
                }
            }
            "breakWhen" => {
                motion.borrow_mut().settings.has_break = true;
                self.note(
                    "a motion with `breakWhen` is planned to its end, as if the condition \
                    were never met",
                );
            }
            "triggerWhen" => self.note("the action of a trigger is not evaluated"),
            "setOrientationType" => self.set_orientation(motion, arguments)?,
            "setOrientationReferenceSystem" => {
                let constant = constant_name(arguments);
                motion.borrow_mut().settings.turns_with_path =
                    constant.map(|name| &*name == "Path");
            }
            "setAuxiliaryPointOrientation" | "setAuxPointOrientationMode" => {
                let mode = constant_name(arguments);
                let mode = mode.and_then(|name| match &*name {
                    "Consider" => Some(AuxOrientation::Consider),
                    "Interpolate" => Some(AuxOrientation::Interpolate),
                    "Ignore" => Some(AuxOrientation::Ignore),
                    _ => None,
                });
                motion.borrow_mut().settings.aux_orientation = mode;
            }
            "addMotionOverlay" => motion.borrow_mut().obstruct(PlanningObstacle::Refused(
                "a motion with an overlay, such as that of FRI, cannot be planned ahead: its path \
                 is determined during the motion; plan the motion without the overlay"
                    .to_owned(),
            )),
            "copy" | "clone" => {
                let copy = motion.borrow().clone();
                return Ok(robot(RobotValue::motion(copy)));
            }
            name if name.starts_with("set") && DECISIVE.iter().any(|word| name.contains(word)) => {
                let reason = format!(
                    "`{name}` changes this motion, and its effect is not known: \
                    remove the call"
                );
                motion.borrow_mut().obstruct(PlanningObstacle::Refused(reason));
            }
            name if name.starts_with("set") || name.starts_with("add") => {
                self.note(format!("`{name}` of a motion is left out of the plan"));
            }
            name => return Ok(self.unmodelled_result(name, " of a motion")),
        }
        Ok(this())
    }

    fn set(
        &mut self,
        motion: &Rc<RefCell<MotionValue>>,
        name: &str,
        setting: Setting,
        arguments: &[Value],
    ) -> Result<(), EvaluationStop> {
        if is_obstructed(motion, name, arguments) {
            return Ok(());
        }
        let given = numbers(arguments).unwrap_or_default();
        if let Setting::Share(kind) = setting {
            let shares: Option<Joints> = match given[..] {
                [share] => Some([share; 7]),
                _ => given.try_into().ok(),
            };
            let Some(shares) = shares else {
                return self.throw(
                    "IllegalArgumentException",
                    format!("`{name}` expects one number, or seven"),
                );
            };
            if let Some(wrong) = shares.iter().find(|share| !(**share > 0.0 && **share <= 1.0)) {
                return self.throw(
                    "IllegalArgumentException",
                    format!("`{name}` expects shares above 0 and up to 1, found {wrong}"),
                );
            }
            motion.borrow_mut().settings.shares[kind] = Some(shares);
            return Ok(());
        }
        let [given] = given[..] else {
            return self.throw("IllegalArgumentException", format!("`{name}` expects a number"));
        };
        let is_limit = matches!(setting, Setting::Way(_) | Setting::Turn(_));
        let is_angle = matches!(setting, Setting::CircAngle);
        if !given.is_finite() || (is_limit && given <= 0.0) || (!is_angle && given < 0.0) {
            let lower = if is_limit { "above 0" } else { "of at least 0" };
            return self.throw(
                "IllegalArgumentException",
                format!("`{name}` expects a number {lower}, found {given}"),
            );
        }
        let mut motion = motion.borrow_mut();
        let is_in_joints =
            matches!(motion.way, MotionPath::Joints(_) | MotionPath::Home | MotionPath::Ptp(_));
        let settings = &mut motion.settings;
        match setting {
            Setting::Share(_) => {}
            Setting::Way(kind) => settings.tool.way[kind] = 1e-3 * given,
            Setting::Turn(kind) => settings.tool.turn[kind] = given,
            Setting::BlendingCart => settings.blending.cart_mm = Some(given),
            Setting::BlendingRel => settings.blending.rel = Some(given),
            // The controller ignores an orientation blend of a motion in joint space.
            Setting::BlendingOri if is_in_joints => {}
            Setting::BlendingOri => settings.blending.orientation_rad = Some(given),
            Setting::CircAngle => settings.circ_angle_rad = Some(given),
        }
        Ok(())
    }

    /// Sets one component of a relative motion's offset; the others are kept.
    fn set_offset(
        &mut self,
        motion: &Rc<RefCell<MotionValue>>,
        name: &str,
        component: usize,
        arguments: &[Value],
    ) -> Result<(), EvaluationStop> {
        if is_obstructed(motion, name, arguments) {
            return Ok(());
        }
        let Some([value]) = numbers(arguments).and_then(|given| <[f64; 1]>::try_from(given).ok())
        else {
            return self.throw("IllegalArgumentException", format!("`{name}` expects a number"));
        };
        if let MotionPath::LinRel { offset, .. } = &mut motion.borrow_mut().way {
            let mut components = offset.xyz_mm.iter_mut().chain(&mut offset.abc_rad);
            if let Some(component_value) = components.nth(component) {
                *component_value = value;
            }
        }
        Ok(())
    }

    fn set_orientation(
        &mut self,
        motion: &Rc<RefCell<MotionValue>>,
        arguments: &[Value],
    ) -> Result<(), EvaluationStop> {
        if let Some(unknown) = first_unknown(arguments) {
            let subject = "the type of orientation of this motion".to_owned();
            motion.borrow_mut().obstruct(PlanningObstacle::Unknown(subject, unknown));
            return Ok(());
        }
        let law = match constant_name(arguments).as_deref() {
            Some("Constant") => OrientationType::Constant,
            Some("Variable") => OrientationType::Variable,
            Some("OriJoint") => OrientationType::Joints,
            Some("Ignore") => OrientationType::Ignore,
            _ => return self.reject("this type of orientation is not known"),
        };
        motion.borrow_mut().settings.orientation = Some(law);
        Ok(())
    }
}

fn constant_name(arguments: &[Value]) -> Option<Rc<str>> {
    match robot_value(arguments.first()?)? {
        RobotValue::Constant(constant) => Some(Rc::clone(&constant.name)),
        _ => None,
    }
}

/// Returns true if an argument of a setter is unknown: the motion then cannot be sent.
fn is_obstructed(motion: &Rc<RefCell<MotionValue>>, name: &str, arguments: &[Value]) -> bool {
    let Some(unknown) = first_unknown(arguments) else { return false };
    let subject = format!("the argument of `{name}` of this motion");
    motion.borrow_mut().obstruct(PlanningObstacle::Unknown(subject, unknown));
    true
}
