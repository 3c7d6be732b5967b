//! How the drive and the robot are.

use std::{
    sync::Mutex,
    thread,
    time::{Duration, Instant, SystemTime},
};

use iiwa_link::{
    Client, ClientError,
    message::{Code, DriveState, IoValue, Sensors, Status},
};
use serde::Serialize;

use crate::output;

use super::{Setup, Viewers, Words, word};

/// How often the state is asked for.
const STATE_EVERY: Duration = Duration::from_millis(250);

/// How often sensors, inputs and outputs are: the robot program has to be asked for each.
const IO_EVERY: Duration = Duration::from_secs(1);

/// The word for pages.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Health {
    status: Option<Status>,
    /// Why there is no status.
    error: Option<String>,
    sensors: Option<Sensors>,
    io: Vec<NamedIo>,
    /// Whether sensors, inputs and outputs are of before a motion: while there is one, the robot program
    /// answers nobody.
    is_old: bool,
}

/// An input or output.
#[derive(Debug, Serialize)]
struct NamedIo {
    name: String,
    value: Option<IoValue>,
    /// Why there is no value.
    error: Option<String>,
}

/// Asks the drive again and again until the twin ends.
pub(crate) fn watch_health(setup: &Setup, words: &Words, viewers: Option<&Mutex<Viewers>>) {
    let mut client = None;
    let mut health = Health::default();
    let mut io_at = None::<Instant>;
    while !output::interrupted() {
        let since = Instant::now();
        if client.is_none() {
            client = setup.client().inspect_err(|failure| health.error = Some(failure.what())).ok();
        }
        if let Some(client) = &mut client {
            match client.state() {
                Ok(status) => (health.status, health.error) = (Some(status), None),
                Err(error) => health.forget(&error),
            }
            let idle =
                health.status.as_ref().is_some_and(|status| status.state == DriveState::Idle);
            if idle && io_at.is_none_or(|at| at.elapsed() >= IO_EVERY) {
                io_at = Some(since);
                health.ask_robot_program(client, &setup.io);
            }
            health.is_old = !idle && health.sensors.is_some();
        }
        words.send_replace(word("health", &health));
        if let Some(Ok(viewers)) = viewers.map(Mutex::lock) {
            health.tell(&viewers);
        }
        while since.elapsed() < STATE_EVERY && !output::interrupted() {
            thread::sleep(Duration::from_millis(10));
        }
    }
}

impl Health {
    /// Asks for sensors, inputs and outputs. If a motion begins meanwhile, what was known stays.
    fn ask_robot_program(&mut self, client: &mut Client, names: &[String]) {
        let busy = |error: &ClientError| error.code() == Code::NotIdle;
        match client.read_sensors() {
            Ok(sensors) => self.sensors = Some(sensors),
            Err(error) if busy(&error) => return,
            Err(ClientError::Refused { .. }) => self.sensors = None,
            Err(error) => return self.forget(&error),
        }
        let mut all = Vec::with_capacity(names.len());
        for name in names {
            let (value, error) = match client.get_io(name) {
                Ok(value) => (Some(value), None),
                Err(error) if busy(&error) => return,
                Err(ClientError::Refused { refusal, .. }) => (None, Some(refusal.to_string())),
                // The next one would wait in vain, too.
                Err(error) => return self.forget(&error),
            };
            all.push(NamedIo { name: name.clone(), value, error });
        }
        self.io = all;
    }

    /// The drive does not answer.
    fn forget(&mut self, error: &ClientError) {
        *self = Self { error: Some(crate::connection::explained(error)), ..Self::default() };
    }

    fn tell(&self, viewers: &Viewers) {
        let at = SystemTime::now();
        if let Some(status) = &self.status {
            viewers.drive_state(at, status);
        }
        if let Some(sensors) = &self.sensors {
            viewers.sensors(at, sensors);
        }
        let known: Vec<_> = self.io.iter().filter_map(|io| Some((&*io.name, io.value?))).collect();
        if !known.is_empty() {
            viewers.inputs_outputs(at, &known);
        }
    }
}
