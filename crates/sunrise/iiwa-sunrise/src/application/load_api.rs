//! Load data of tools and workpieces.

use std::{cell::RefCell, rc::Rc};

use iiwa_java::{EvaluationStop, Value};
use iiwa_kin::Load;

use crate::application::{
    arguments::{first_unknown, numbers, robot_value},
    robot_value::{LoadRef, RobotValue, robot},
    robotics::Robotics,
};

/// Returns the load of `new LoadData(mass, centre, inertia)`: mass in kg, centre of mass in mm. The
/// inertia is left out.
fn load_of(arguments: &[Value]) -> Option<Load> {
    match arguments {
        [] => Some(Load::default()),
        [mass, rest @ ..] => {
            let mass_kg = mass.number()?;
            let center_mm = rest
                .first()
                .map_or(Some([0.0; 3]), |center| center_of(std::slice::from_ref(center)))?;
            Some(Load { mass_kg, center_mm, ..Load::default() })
        }
    }
}

/// Returns a centre of mass in mm from three numbers, a vector, a transformation or a frame.
fn center_of(arguments: &[Value]) -> Option<[f64; 3]> {
    if let [only] = arguments
        && let Some(value) = robot_value(only)
    {
        return match value {
            RobotValue::Vector(xyz) => Some(*xyz),
            RobotValue::Transformation(frame) => Some(frame.xyz_mm),
            RobotValue::Frame(frame) => Some(frame.borrow().frame.xyz_mm),
            _ => None,
        };
    }
    numbers(arguments)?.first_chunk().copied()
}

impl Robotics<'_> {
    /// Evaluates `new LoadData(...)`.
    pub(crate) fn new_load(&mut self, arguments: &[Value]) -> Value {
        let load = match first_unknown(arguments) {
            Some(_) => None,
            None => load_of(arguments),
        };
        if arguments.len() > 2 {
            self.note("the inertia of these load data is left out of the plan");
        }
        let load = load.unwrap_or_else(|| {
            self.note(
                "the load data that are made here are not known: no load is planned for them",
            );
            Load::default()
        });
        robot(RobotValue::Load(LoadRef::Own(Rc::new(RefCell::new(load)))))
    }

    /// Returns the load of a reference.
    pub(crate) fn load_in(&self, load: &LoadRef) -> Load {
        match load {
            LoadRef::Own(load) => *load.borrow(),
            LoadRef::Body(index) => {
                let body = self.station.bodies.get(*index);
                body.and_then(|body| body.load).unwrap_or_default()
            }
        }
    }

    /// Calls a method of load data; setters on a tool's load data change the payload.
    pub(crate) fn call_load(
        &mut self,
        this: &LoadRef,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let mut load = self.load_in(this);
        let this_value = robot(RobotValue::Load(this.clone()));
        if name.starts_with("get") {
            return Ok(match (name, arguments) {
                ("getMass", []) => Value::Double(load.mass_kg),
                _ => self.not_known(&format!("LoadData.{name}")),
            });
        }
        let given = if first_unknown(arguments).is_some() { None } else { Some(arguments) };
        let is_set = match (name, given) {
            ("setMass", Some([mass])) => {
                mass.number().filter(|kg| *kg >= 0.0).map(|mass_kg| load.mass_kg = mass_kg)
            }
            ("setCenterOfMass", Some(given)) => center_of(given).map(|mm| load.center_mm = mm),
            _ => None,
        };
        if is_set.is_none() {
            self.note(format!("`{name}` of load data is left out of the plan"));
            return Ok(this_value);
        }
        match this {
            LoadRef::Own(cell) => *cell.borrow_mut() = load,
            LoadRef::Body(index) => {
                if let Some(body) = self.station.bodies.get_mut(*index) {
                    body.load = Some(load);
                }
                self.load_changed()?;
            }
        }
        Ok(this_value)
    }
}
