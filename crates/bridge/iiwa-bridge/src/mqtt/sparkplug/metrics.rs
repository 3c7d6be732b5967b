//! Conversion of messages to metrics.

use std::collections::BTreeMap;

use iiwa_link::message::{IoValue, OperationMode, Presence};

use crate::message::{Content, JointSample, Message, RobotConditions, RunMessage, RunPhase};

/// Values by name.
pub(super) type Metrics = BTreeMap<String, Value>;

/// Value of a metric.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Double(f64),
    Boolean(bool),
    UInt64(u64),
    Int64(u64),
    Text(String),
    /// Null of type text.
    NoText,
    /// Null of type double.
    NoDouble,
}

impl Value {
    fn text(text: Option<impl Into<String>>) -> Self {
        text.map_or(Self::NoText, |text| Self::Text(text.into()))
    }

    fn double(number: Option<f64>) -> Self {
        number.map_or(Self::NoDouble, Self::Double)
    }
}

/// Returns the metrics of a message.
pub(super) fn of(message: &Message) -> Metrics {
    let mut metrics = Metrics::new();
    let mut set = |name: String, value| drop(metrics.insert(name, value));
    match &message.content {
        Content::Joints(JointSample { t_s, joints_rad, measured_nm, external_nm }) => {
            set("Time".to_owned(), Value::Double(*t_s));
            let torques = [("Torque", measured_nm), ("External Torque", external_nm)];
            for joint in 0..7 {
                let name = |quantity| format!("Joints/A{}/{quantity}", joint + 1);
                set(name("Position"), Value::Double(joints_rad[joint]));
                for (quantity, values) in torques {
                    if let Some(values) = values {
                        set(name(quantity), Value::Double(values[joint]));
                    }
                }
            }
        }
        Content::State { state, .. } => {
            set("State".to_owned(), Value::Text(state.name().to_owned()));
        }
        Content::Run(run) => of_run(run, set),
        Content::Io { io } => {
            for signal in io {
                let value = match signal.value {
                    IoValue::Boolean(value) => Value::Boolean(value),
                    IoValue::Digital(value) => Value::UInt64(value),
                    IoValue::Analog(value) => Value::Double(value),
                };
                set(format!("IO/{}", signal.name), value);
            }
        }
        Content::Sensors(sensors) => {
            if let Some(celsius) = sensors.joint_temperature_c {
                for (joint, celsius) in celsius.into_iter().enumerate() {
                    set(format!("Joints/A{}/Temperature", joint + 1), Value::Double(celsius));
                }
            }
        }
        Content::Conditions(conditions) => of_conditions(conditions, set),
        Content::Bridge(_) => {}
    }
    metrics
}

fn of_run(run: &RunMessage, mut set: impl FnMut(String, Value)) {
    let result = run.result.as_ref();
    let planned = run.label.plan.as_ref().map(|plan| plan.cycle_time_s);
    let values = [
        ("Active", Value::Boolean(run.event == RunPhase::Begin)),
        ("Number", Value::UInt64(run.run)),
        ("Program", Value::text(run.label.program.as_ref())),
        ("Planned Cycle Time", Value::double(planned)),
        ("Cycle Time", Value::double(result.and_then(|result| result.cycle_time_s))),
        ("Error", Value::text(result.and_then(|result| Some(&result.error.as_ref()?.message)))),
    ];
    for (name, value) in values {
        set(format!("Run/{name}"), value);
    }
}

fn of_conditions(conditions: &RobotConditions, mut set: impl FnMut(String, Value)) {
    let RobotConditions { drive, fri, robot_program, simulated, conditions, .. } = conditions;
    let is_there = |presence: &Presence| Value::Boolean(*presence == Presence::Connected);
    set("Drive/Connected".to_owned(), is_there(drive));
    set("Robot Program/Connected".to_owned(), is_there(robot_program));
    set("Robot Program/Simulated".to_owned(), Value::Boolean(*simulated));
    if let Some(fri) = fri {
        set("FRI/Session".to_owned(), Value::Text(fri.session.clone()));
        set("FRI/Quality".to_owned(), Value::Text(fri.quality.clone()));
        set("FRI/Lost".to_owned(), Value::UInt64(fri.lost));
        set("FRI/Late".to_owned(), Value::UInt64(fri.late));
    }
    if let Some(conditions) = conditions {
        let mode = conditions.operation_mode.as_ref().map(OperationMode::name);
        set("Conditions/Operation Mode".to_owned(), Value::text(mode));
        set("Conditions/Override".to_owned(), Value::double(conditions.override_rel));
        if let Some(stop) = conditions.safety_stop {
            set("Conditions/Safety Stop".to_owned(), Value::Boolean(stop));
        }
        set("Conditions/Tool".to_owned(), Value::text(conditions.tool.as_ref()));
    }
}
