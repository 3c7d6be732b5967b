//! Station as the host of an evaluation.

use std::{cell::RefCell, rc::Rc};

use iiwa_java::{EvaluationStop, Host, HostCounts, HostValue, JavaObject, Machine, Value};

use crate::application::{robot_value::RobotValue, robotics::Robotics, station::Station};

/// Station that applications run in.
pub(crate) struct StationHost(RefCell<Station>);

/// Methods and classes that move the robot, wait, or change the payload, in any class.
const ACTING: [&str; 16] = [
    "move",
    "moveAsync",
    "attachTo",
    "detach",
    "milliSleep",
    "nanoSleep",
    "sleep",
    "await",
    "awaitFileAvailable",
    "setDestination",
    "setHomePosition",
    // Classes of platform motions, at their construction.
    "VirtualLine",
    "VirtualLineMotion",
    "RelativeMotion",
    "MobilePlatformRelativeMotion",
    "MobilePlatformVelocityMotion",
];

/// Acting methods that only take time.
const PAUSING: [&str; 5] = ["milliSleep", "nanoSleep", "sleep", "await", "awaitFileAvailable"];

/// Acting methods whose receiver must be known.
const ON_RECEIVERS: [&str; 4] = ["move", "moveAsync", "attachTo", "detach"];

impl StationHost {
    pub(crate) fn new(station: Station) -> Self {
        Self(RefCell::new(station))
    }

    /// Returns the current station.
    pub(crate) fn into_station(self) -> Station {
        self.0.into_inner()
    }

    fn with<T>(
        &self,
        machine: &mut Machine,
        call: impl FnOnce(&mut Robotics<'_>) -> Result<T, EvaluationStop>,
    ) -> Result<T, EvaluationStop> {
        match self.0.try_borrow_mut() {
            Ok(mut station) => call(&mut Robotics { machine, station: &mut station }),
            // Not reached: the API does not call project methods, which could call the API again.
            Err(_) => machine.reject("a method of KUKA's is called within another"),
        }
    }
}

/// Returns a value that this host has created.
fn robot_value_of(value: &Rc<dyn HostValue>) -> Option<&RobotValue> {
    let value: &dyn std::any::Any = &**value;
    value.downcast_ref()
}

impl Host for StationHost {
    fn acting(&self) -> &'static [&'static str] {
        &ACTING
    }

    fn acting_on_receivers(&self) -> &'static [&'static str] {
        &ON_RECEIVERS
    }

    fn acts(&self) -> &'static str {
        "the arm moves or waits"
    }

    fn pausing(&self) -> &'static [&'static str] {
        &PAUSING
    }

    fn progress(&self) -> HostCounts {
        let station = self.0.borrow();
        HostCounts {
            actions: station.schedule.sent(),
            asked: station.asked.len(),
            continued: station.continued,
            readings: [station.position_readings.get(), station.readings],
            state: station.state(),
        }
    }

    fn suppose(&self, asked: usize, answer: Option<bool>) -> bool {
        self.0.borrow_mut().suppose(asked, answer)
    }

    fn settle(&self) {
        self.0.borrow_mut().settle();
    }

    fn passed_loop(
        &self,
        machine: &mut Machine,
        asked: usize,
        hindrance: Option<&'static str>,
    ) -> Result<(), EvaluationStop> {
        self.with(machine, |robotics| robotics.wait_in_loop(asked, hindrance))
    }

    fn answers_since(&self, asked: usize) -> Option<String> {
        self.0.borrow().answers_since(asked)
    }

    fn endless(&self, machine: &Machine, asked: usize) {
        self.0.borrow_mut().ended_in_loop(&machine.place, asked);
    }

    fn call(
        &self,
        machine: &mut Machine,
        receiver: &Rc<dyn HostValue>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        match robot_value_of(receiver) {
            Some(receiver) => {
                self.with(machine, |robotics| robotics.call_robot(receiver, name, arguments))
            }
            None => Ok(machine.unknown(format!("the result of `{name}`"))),
        }
    }

    fn field(
        &self,
        machine: &mut Machine,
        receiver: &Rc<dyn HostValue>,
        name: &str,
    ) -> Result<Value, EvaluationStop> {
        match robot_value_of(receiver) {
            Some(receiver) => self.with(machine, |robotics| robotics.robot_field(receiver, name)),
            None => Ok(machine.unknown(format!("the field `{name}`"))),
        }
    }

    fn call_static(
        &self,
        machine: &mut Machine,
        class: &str,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        self.with(machine, |robotics| robotics.robot_static(class, name, arguments))
    }

    fn construct(
        &self,
        machine: &mut Machine,
        class: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        self.with(machine, |robotics| robotics.robot_new(class, arguments))
    }

    fn constant(
        &self,
        machine: &mut Machine,
        class: &str,
        name: &str,
    ) -> Result<Option<Value>, EvaluationStop> {
        self.with(machine, |robotics| robotics.robot_constant(class, name))
    }

    fn injected(
        &self,
        machine: &mut Machine,
        class: &str,
        named: Option<&str>,
        field: &str,
    ) -> Result<Option<Value>, EvaluationStop> {
        self.with(machine, |robotics| robotics.robot_injected(class, named, field))
    }

    fn inherited(
        &self,
        machine: &mut Machine,
        object: &Rc<JavaObject>,
        base: &str,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        self.with(machine, |robotics| robotics.robot_inherited(object, base, name, arguments))
    }

    fn constructed(
        &self,
        machine: &mut Machine,
        object: &Rc<JavaObject>,
        base: &str,
        arguments: &[Value],
    ) -> Result<(), EvaluationStop> {
        self.with(machine, |robotics| robotics.robot_constructed(object, base, arguments))
    }

    fn text(&self, value: &Rc<dyn HostValue>) -> String {
        match (robot_value_of(value), self.0.try_borrow()) {
            (Some(value), Ok(station)) => station.robot_text(value),
            _ => value.class().to_owned(),
        }
    }
}
