//! Diagnostics for recordings: the drive's state, temperatures, inputs and outputs.

use std::time::{Duration, Instant};

use iiwa_link::{Client, message::DriveState};
use iiwa_log::{Diagnostic, DiagnosticLevel};

/// Period of the readings: each is a request to the robot program.
const EVERY: Duration = Duration::from_secs(1);

/// Client that reads sensors, inputs and outputs once per second.
#[derive(Debug)]
pub struct SensorPoll {
    client: Client,
    read: Option<Instant>,
}

impl SensorPoll {
    /// Creates a poll through this client.
    #[must_use]
    pub fn new(client: Client) -> Self {
        Self { client, read: None }
    }

    /// Reads the values once per second. They are missing during motions, in which the robot
    /// program does not report them.
    pub fn read(&mut self, robot: &str) -> Option<Vec<Diagnostic<'static>>> {
        if self.read.is_some_and(|read| read.elapsed() < EVERY) {
            return None;
        }
        self.read = Some(Instant::now());
        let sensors = self.client.read_sensors().ok()?;
        // A robot program may not know all of its signals.
        let signals = self.client.list_io().unwrap_or_default();
        let joints = |name: &str, unit: &str, values: [f64; 7]| {
            let value = |(joint, value): (usize, f64)| {
                (format!("A{}", joint + 1).into(), value.to_string().into())
            };
            let values = values.into_iter().enumerate().map(value).collect();
            part(name.to_owned(), format!("in {unit}"), robot, values)
        };
        let io =
            signals.into_iter().map(|signal| (signal.name.into(), signal.value.to_string().into()));
        let temperatures = sensors
            .joint_temperature_c
            .map(|celsius| joints("joint temperatures", "degrees Celsius", celsius));
        let rest = [
            joints("external torques", "Nm", sensors.external_torque_nm),
            part("inputs and outputs".to_owned(), String::new(), robot, io.collect()),
        ];
        Some(temperatures.into_iter().chain(rest).collect())
    }
}

/// Returns the state of the drive.
#[must_use]
pub fn drive(state: DriveState, robot: &str) -> Diagnostic<'static> {
    part("drive".to_owned(), state.to_string(), robot, Vec::new())
}

type DiagnosticValues = Vec<(std::borrow::Cow<'static, str>, std::borrow::Cow<'static, str>)>;

fn part(
    name: String,
    message: String,
    robot: &str,
    values: DiagnosticValues,
) -> Diagnostic<'static> {
    Diagnostic {
        level: DiagnosticLevel::Ok,
        name: name.into(),
        message: message.into(),
        hardware_id: robot.to_owned().into(),
        values,
    }
}
