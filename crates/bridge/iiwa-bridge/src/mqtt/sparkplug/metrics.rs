//! Conversion of messages to metrics.

use std::collections::BTreeMap;

use iiwa_link::message::{IoValue, OperationMode, Presence};

use crate::message::{Content, CycleSample, Message, RobotConditions, RunMessage, RunPhase};

/// Values by name.
pub(super) type Metrics = BTreeMap<String, SparkplugValue>;

/// Value of a metric.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum SparkplugValue {
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

impl SparkplugValue {
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
        Content::Joints(CycleSample { t_s, joints_rad, measured_nm, external_nm }) => {
            set("Time".to_owned(), SparkplugValue::Double(*t_s));
            let torques = [("Torque", measured_nm), ("External Torque", external_nm)];
            for joint in 0..7 {
                let name = |quantity| format!("Joints/A{}/{quantity}", joint + 1);
                set(name("Position"), SparkplugValue::Double(joints_rad[joint]));
                for (quantity, values) in torques {
                    if let Some(values) = values {
                        set(name(quantity), SparkplugValue::Double(values[joint]));
                    }
                }
            }
        }
        Content::State { state, .. } => {
            set("State".to_owned(), SparkplugValue::Text(state.name().to_owned()));
        }
        Content::Run(run) => of_run(run, set),
        Content::Io { io } => {
            for signal in io {
                let value = match signal.value {
                    IoValue::Boolean(value) => SparkplugValue::Boolean(value),
                    IoValue::Digital(value) => SparkplugValue::UInt64(value),
                    IoValue::Analog(value) => SparkplugValue::Double(value),
                };
                set(format!("IO/{}", signal.name), value);
            }
        }
        Content::Sensors(sensors) => {
            if let Some(celsius) = sensors.joint_temperature_c {
                for (joint, celsius) in celsius.into_iter().enumerate() {
                    set(
                        format!("Joints/A{}/Temperature", joint + 1),
                        SparkplugValue::Double(celsius),
                    );
                }
            }
        }
        Content::Conditions(conditions) => of_conditions(conditions, set),
        Content::Bridge(_) => {}
    }
    metrics
}

fn of_run(run: &RunMessage, mut set: impl FnMut(String, SparkplugValue)) {
    let result = run.result.as_ref();
    let planned = run.label.plan.as_ref().map(|plan| plan.cycle_time_s);
    let values = [
        ("Active", SparkplugValue::Boolean(run.event == RunPhase::Begin)),
        ("Number", SparkplugValue::UInt64(run.run)),
        ("Program", SparkplugValue::text(run.label.program.as_ref())),
        ("Planned Cycle Time", SparkplugValue::double(planned)),
        ("Cycle Time", SparkplugValue::double(result.and_then(|result| result.cycle_time_s))),
        (
            "Error",
            SparkplugValue::text(result.and_then(|result| Some(&result.error.as_ref()?.message))),
        ),
    ];
    for (name, value) in values {
        set(format!("Run/{name}"), value);
    }
}

fn of_conditions(conditions: &RobotConditions, mut set: impl FnMut(String, SparkplugValue)) {
    let RobotConditions { drive, fri, robot_program, simulated, conditions, .. } = conditions;
    let is_there = |presence: &Presence| SparkplugValue::Boolean(*presence == Presence::Connected);
    set("Drive/Connected".to_owned(), is_there(drive));
    set("Robot Program/Connected".to_owned(), is_there(robot_program));
    set("Robot Program/Simulated".to_owned(), SparkplugValue::Boolean(*simulated));
    if let Some(fri) = fri {
        set("FRI/Session".to_owned(), SparkplugValue::Text(fri.session.clone()));
        set("FRI/Quality".to_owned(), SparkplugValue::Text(fri.quality.clone()));
        set("FRI/Lost".to_owned(), SparkplugValue::UInt64(fri.lost));
        set("FRI/Late".to_owned(), SparkplugValue::UInt64(fri.late));
    }
    if let Some(conditions) = conditions {
        let mode = conditions.operation_mode.as_ref().map(OperationMode::name);
        set("Conditions/Operation Mode".to_owned(), SparkplugValue::text(mode));
        set("Conditions/Override".to_owned(), SparkplugValue::double(conditions.override_rel));
        if let Some(stop) = conditions.safety_stop {
            set("Conditions/Safety Stop".to_owned(), SparkplugValue::Boolean(stop));
        }
        set("Conditions/Tool".to_owned(), SparkplugValue::text(conditions.tool.as_ref()));
    }
}
