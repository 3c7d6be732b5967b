//! Methods that applications, I/O groups, and tools of a project inherit from KUKA's classes.

use std::rc::Rc;

use iiwa_java::{EvaluationStop, JavaObject, Value};

use crate::application::{
    arguments::robot_value,
    robot_value::{RobotValue, robot},
    robotics::Robotics,
    spot::Spot,
};

/// Application methods that do nothing unless a project overrides them.
const EMPTY: [&str; 9] = [
    "initialize",
    "run",
    "dispose",
    "close",
    "cleanUp",
    "onCancel",
    "initializeCyclic",
    "runCyclic",
    "finalize",
];

impl Robotics<'_> {
    /// Calls a method of a project object that only `base` implements, the first superclass outside
    /// the project; `None` if the method is not modelled.
    pub(crate) fn robot_inherited(
        &mut self,
        object: &Rc<JavaObject>,
        base: &str,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        let inherited = object.inherited.borrow().as_ref().and_then(robot_value);
        if let Some(inherited) = inherited {
            return self.call_robot(&inherited, name, arguments).map(Some);
        }
        if base == "Thread" {
            let thread = Value::Object(Rc::clone(object));
            return self.call_thread(Some(&thread), name, arguments).map(Some);
        }
        if !is_task(base) {
            return Ok(None);
        }
        let service = match name {
            "getApplicationData" => "IApplicationData",
            "getApplicationUI" => "IApplicationUI",
            "getLogger" => "ITaskLogger",
            "getApplicationControl" => "IApplicationControl",
            "getContext" => "IContext",
            "getController" => "Controller",
            "getObserverManager" => "IObserverManager",
            "getDevice" | "getRobot" => return self.device(arguments).map(Some),
            "getTaskFunction" => return Ok(Some(self.unknown("what another task gives"))),
            "getFrame" | "getProcessData" | "createFromTemplate" => {
                let Some(data) = Self::service("IApplicationData").as_ref().and_then(robot_value)
                else {
                    return Ok(None);
                };
                return self.call_robot(&data, name, arguments).map(Some);
            }
            name if EMPTY.contains(&name) => return Ok(Some(Value::Null)),
            _ => return Ok(None),
        };
        Ok(Self::service(service))
    }

    /// Returns the robot, unless the arguments name the class of another device.
    fn device(&mut self, arguments: &[Value]) -> Result<Value, EvaluationStop> {
        let controller = RobotValue::opaque("Controller");
        self.call_robot(&controller, "getDevice", arguments)
    }

    /// Models the constructor of a superclass outside the project.
    pub(crate) fn robot_constructed(
        &mut self,
        object: &Rc<JavaObject>,
        base: &str,
        arguments: &[Value],
    ) -> Result<(), EvaluationStop> {
        let inherited = match base {
            // Call `super(controller, name)`.
            "AbstractIOGroup" => match arguments.get(1) {
                Some(Value::Text(name)) => Some(RobotValue::IoGroup(Rc::clone(name))),
                Some(Value::Unknown(unknown)) => {
                    return self.reject_unknown("the name of these inputs and outputs", unknown);
                }
                _ => return self.reject("these inputs and outputs have no name"),
            },
            "Tool" | "Workpiece" | "PhysicalObject" | "SpatialObject" => {
                robot_value(&self.new_body(base == "Workpiece", arguments))
            }
            _ => None,
        };
        if inherited.is_some() {
            *object.inherited.borrow_mut() = inherited.map(robot);
        }
        Ok(())
    }

    /// Returns the value that is injected into a field whose class is outside the project; `None`
    /// if the class is not modelled.
    pub(crate) fn robot_injected(
        &mut self,
        class: &str,
        named: Option<&str>,
        field: &str,
    ) -> Result<Option<Value>, EvaluationStop> {
        if let Some(service) = Self::service(class) {
            return Ok(Some(service));
        }
        match class {
            "Tool" | "Workpiece" | "PhysicalObject" | "SpatialObject" => {
                let name = named.unwrap_or(field);
                Ok(Some(self.injected_body(name, class == "Workpiece")))
            }
            "ObjectFrame" | "AbstractFrame" => match named {
                Some(path) => self.tree_frame(path).map(Some),
                None => Ok(None),
            },
            "Flange" => Ok(Some(robot(RobotValue::Spot(Spot::Flange)))),
            // Process data without a value: reading them gives an unknown value with their id.
            "IProcessData" | "ProcessData" => {
                let id = Rc::from(named.unwrap_or(field));
                Ok(Some(robot(RobotValue::ProcessData(id))))
            }
            class => match class.strip_suffix("IOGroup") {
                Some(group) if !group.is_empty() => {
                    Ok(Some(robot(RobotValue::IoGroup(Rc::from(group)))))
                }
                _ => Ok(self.injected_by_name(class, named.unwrap_or(field))),
            },
        }
    }

    /// Returns a tool with a class of its own, such as in KUKA's gripper toolbox: by its name in
    /// the data file, or by its class.
    fn injected_by_name(&mut self, class: &str, name: &str) -> Option<Value> {
        let known = self.template(name).map(|body| (body.name, body.is_workpiece));
        let of_class = || self.template_of_class(class).map(|name| (name.to_owned(), false));
        let missing = || class.ends_with("Gripper").then(|| (name.to_owned(), false));
        let (name, is_workpiece) = known.or_else(of_class).or_else(missing)?;
        Some(self.injected_body(&name, is_workpiece))
    }
}

/// Returns true if a class is a task that Sunrise runs.
fn is_task(base: &str) -> bool {
    base.starts_with("RoboticsAPI")
        && ["Application", "Task", "BackgroundTask"].iter().any(|end| base.ends_with(end))
}
