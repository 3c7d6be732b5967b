//! Opaque objects, whose state does not affect the plan: application data, dialogs and log,
//! controllers, conditions, control modes.

use std::rc::Rc;

use iiwa_java::{EvaluationStop, Value};

use crate::application::{
    arguments::first_unknown,
    platform_api::{is_platform, name_platform, platform},
    robot_value::{Opaque, RobotValue, SignalValue, robot},
    robotics::Robotics,
    spot::Spot,
};

/// Prefixes of method names that return the object itself, if they return anything.
const FLUENT: [&str; 9] =
    ["set", "add", "enable", "disable", "parametrize", "with", "remove", "register", "publish"];

impl Robotics<'_> {
    /// Calls a method of an opaque object.
    pub(crate) fn call_opaque(
        &mut self,
        opaque: &Rc<Opaque>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        match &*opaque.class {
            "IApplicationData" => return self.call_application_data(name, arguments),
            "IApplicationUI" => {
                return match name {
                    "displayModalDialog" => self.answer_dialog(arguments),
                    name => Ok(self.call_user_interface(name)),
                };
            }
            "IUserKeyBar" => return Ok(self.call_user_key_bar(name)),
            "IUserKey" => return Ok(self.call_user_key(name)),
            "ITaskLogger" | "IObserver" => return Ok(Value::Null),
            "IApplicationControl" => {
                return match (name, arguments) {
                    ("setApplicationOverride" | "clipApplicationOverride", [share]) => {
                        self.set_override(share)
                    }
                    ("getApplicationOverride" | "getEffectiveOverride", []) => {
                        let share = self.station.speed_override.as_ref();
                        Ok(Value::Double(share.map_or(1.0, |(share, _)| *share)))
                    }
                    ("pause" | "halt", []) => {
                        self.take_given_time(
                            "the application pauses until the operator resumes it",
                        )?;
                        Ok(Value::Null)
                    }
                    _ if name.starts_with("get") || name.starts_with("is") => {
                        Ok(self.not_known(&format!("IApplicationControl.{name}")))
                    }
                    _ => Ok(Value::Null),
                };
            }
            "IContext" | "Controller" => return Ok(self.call_controller(name, arguments)),
            "IObserverManager" if name == "waitFor" => return self.wait_for(arguments),
            "IObserverManager" => {
                self.note("the action of an observer is not evaluated");
                return Ok(robot(RobotValue::opaque("IObserver")));
            }
            "ICondition" => {
                return Ok(match name {
                    "invert" => match &opaque.signal {
                        Some(SignalValue { id, value: Some(value) }) => {
                            let signal = SignalValue { id: Rc::clone(id), value: Some(!value) };
                            let inverse = Opaque::of_signal("ICondition", signal);
                            robot(RobotValue::Opaque(Rc::new(inverse)))
                        }
                        _ => robot(RobotValue::Opaque(opaque.clone())),
                    },
                    "and" | "or" | "xor" | "onePressed" => robot(RobotValue::opaque("ICondition")),
                    _ => self.unknown("a measured force"),
                });
            }
            "FRISession" if name == "await" => {
                self.note("the wait for an FRI session is planned with no duration");
                return Ok(Value::Null);
            }
            "MobilePlatform" => return self.call_platform(name, arguments),
            "PlatformMotion" => return Ok(self.call_platform_motion(name)),
            "Thread" => {
                return self.call_thread(opaque.task.as_ref(), name, arguments);
            }
            _ => {}
        }
        if let Some(gives) = &opaque.gives {
            return Ok(self.unknown(gives.to_string()));
        }
        if FLUENT.iter().any(|begin| name.starts_with(begin)) {
            if &*opaque.class == "LoadData" {
                self.note(
                    "load data set by the application are ignored: the plan uses those of the \
                     template",
                );
            }
            return Ok(robot(RobotValue::Opaque(opaque.clone())));
        }
        if let Some(unknown) = first_unknown(arguments) {
            return Ok(Value::Unknown(unknown));
        }
        Ok(self.not_known(&format!("{}.{name}", opaque.class)))
    }

    fn call_application_data(
        &mut self,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        match (name, arguments) {
            ("getFrame" | "tryGetFrame", [Value::Text(path)]) => {
                let path = path.to_string();
                self.tree_frame(&path)
            }
            ("getFrame" | "tryGetFrame", [Value::Unknown(unknown)]) => {
                Ok(Value::Unknown(unknown.clone()))
            }
            ("getProcessData", [id]) => self.process_data(id),
            ("createFromTemplate", [template]) => self.body_of_template(template),
            ("changeFrameTransformation" | "changeFramePosition", [frame, to]) => {
                self.change_data_frame(frame, to)
            }
            _ => Ok(self.not_known(&format!("IApplicationData.{name}"))),
        }
    }

    fn call_controller(&mut self, name: &str, arguments: &[Value]) -> Value {
        let arm = robot(RobotValue::Robot);
        let controller = robot(RobotValue::opaque("Controller"));
        match (name, arguments) {
            ("getDefaultController" | "getController", _) => controller,
            ("getEngine" | "getPersistenceEngine" | "getDefaultPersistenceEngine", _) => {
                robot(RobotValue::opaque("IApplicationData"))
            }
            ("getControllers", []) => Value::list(vec![controller]),
            ("getDevices", []) => Value::list(vec![arm]),
            ("getDeviceFromType" | "getDevice" | "getRobot", _) if name_platform(arguments) => {
                platform()
            }
            ("getDeviceFromType" | "getDevice", [.., Value::ForeignClass(class)])
                if !class.contains("LBR") && !class.contains("Robot") =>
            {
                let class = class.to_string();
                self.unknown(format!("the device `{class}`"))
            }
            ("getDeviceFromType" | "getDevice" | "getRobot", _) => arm,
            _ if FLUENT.iter().any(|begin| name.starts_with(begin)) => Value::Null,
            _ => self.not_known(&format!("Controller.{name}")),
        }
    }

    /// Returns the API object of a class, as an application gets it from its own methods or by
    /// injection.
    pub(crate) fn service(class: &str) -> Option<Value> {
        let class = match class {
            arm if is_arm(arm) => return Some(robot(RobotValue::Robot)),
            "World" => return Some(robot(RobotValue::Spot(Spot::World))),
            "IApplicationData" | "ApplicationData" | "IPersistenceEngine" => "IApplicationData",
            "IApplicationUI" | "ApplicationUI" | "ITaskUI" => "IApplicationUI",
            "ITaskLogger" | "ILogger" | "Logger" => "ITaskLogger",
            "IApplicationControl" => "IApplicationControl",
            "IContext" | "ApplicationContext" | "RoboticsAPIContext" => "IContext",
            "Controller" | "SunriseController" => "Controller",
            "IObserverManager" | "ObserverManager" => "IObserverManager",
            class if is_platform(class) => return Some(platform()),
            _ => return None,
        };
        Some(robot(RobotValue::opaque(class)))
    }
}

/// Returns true if a device class is the robot arm: `LBR` and `Robot`, and `RoboticArm` and
/// `LBRMed7` of Sunrise.OS Med and Sunrise 2. The LBR Med has the kinematics of the LBR iiwa.
pub(crate) fn is_arm(class: &str) -> bool {
    /// FRI and redundancy classes, whose names begin like robot classes.
    const OTHERS: [&str; 3] = ["LBRE1Redundancy", "LBRJointOverlay", "LBRWrenchOverlay"];
    let is_general =
        ["Robot", "AbstractRobot", "RobotDevice", "RoboticArm", "IRoboticArm"].contains(&class);
    is_general || (class.starts_with("LBR") && !OTHERS.contains(&class))
}
