//! State of the drive and the robot: status, sensors, inputs and outputs.

use std::{
    collections::BTreeMap,
    sync::Mutex,
    thread,
    time::{Duration, Instant, SystemTime},
};

use iiwa_files::interrupt;
use iiwa_foxglove::Viewers;
use iiwa_link::{
    Client, ClientError,
    message::{Code, Conditions, Direction, DriveState, DriveStatus, IoValue, Sensors, Signal},
};
use serde::Serialize;

use crate::{
    Setup,
    message::{PageChannel, page_message},
};

/// Period of status requests.
const STATUS_PERIOD: Duration = Duration::from_millis(250);

/// Period of sensors, inputs and outputs: each is a request to the robot program.
const IO_PERIOD: Duration = Duration::from_secs(1);

/// State in page format.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Health {
    status: Option<DriveStatus>,
    /// Reason for a missing status.
    error: Option<String>,
    /// Reason why cycle times are not representative, if any.
    caution: Option<String>,
    sensors: Option<Sensors>,
    io: Vec<NamedIo>,
    /// `true` if sensors, inputs and outputs were read before the current motion: during a motion,
    /// the robot program answers no requests.
    is_old: bool,
    /// Directions of inputs and outputs by name, once the robot program has been queried.
    #[serde(skip)]
    directions: Option<BTreeMap<String, Direction>>,
}

/// Input or output.
#[derive(Debug, Serialize)]
struct NamedIo {
    name: String,
    /// Direction, if the robot program reports it.
    direction: Option<Direction>,
    value: Option<IoValue>,
    /// Reason for a missing value.
    error: Option<String>,
}

/// Polls the drive until an interrupt.
pub(crate) fn watch_health(setup: &Setup, pages: &PageChannel, viewers: Option<&Mutex<Viewers>>) {
    let mut client = None;
    let mut health = Health::default();
    let mut io_at = None::<Instant>;
    while !interrupt::has_come() {
        let since = Instant::now();
        if client.is_none() {
            client =
                setup.client().inspect_err(|error| health.error = Some(setup.words(error))).ok();
        }
        if let Some(client) = &mut client {
            match client.state() {
                Ok(status) => (health.status, health.error) = (Some(status), None),
                Err(error) => health.clear(&error, setup),
            }
            let idle =
                health.status.as_ref().is_some_and(|status| status.state == DriveState::Idle);
            if idle && io_at.is_none_or(|last| last.elapsed() >= IO_PERIOD) {
                io_at = Some(since);
                health.read_sensors_and_io(client, setup);
            }
            let conditions = health.status.as_ref().and_then(|status| status.conditions.as_ref());
            health.caution = conditions.and_then(Conditions::caution);
            health.is_old = !idle && health.sensors.is_some();
        }
        pages.send_replace(page_message("health", &health));
        if let Some(Ok(viewers)) = viewers.map(Mutex::lock) {
            health.publish(&viewers);
        }
        while since.elapsed() < STATUS_PERIOD && !interrupt::has_come() {
            thread::sleep(Duration::from_millis(10));
        }
    }
}

impl Health {
    /// Reads sensors, inputs and outputs. If a motion starts meanwhile, the last values are kept.
    fn read_sensors_and_io(&mut self, client: &mut Client, setup: &Setup) {
        let busy = |error: &ClientError| error.code() == Code::NotIdle;
        match client.read_sensors() {
            Ok(sensors) => self.sensors = Some(sensors),
            Err(error) if busy(&error) => return,
            Err(ClientError::Refused { .. }) => self.sensors = None,
            Err(error) => return self.clear(&error, setup),
        }
        if self.directions.is_none() {
            self.directions = match client.list_io() {
                Ok(signals) => {
                    let direction = |Signal { name, direction, .. }| (name, direction);
                    Some(signals.into_iter().map(direction).collect())
                }
                Err(error) if busy(&error) => return,
                // A robot program may not know all of its signals.
                Err(ClientError::Refused { .. }) => Some(BTreeMap::new()),
                Err(error) => return self.clear(&error, setup),
            };
        }
        let direction = |name: &String| {
            self.directions.as_ref().and_then(|directions| directions.get(name)).copied()
        };
        let mut all = Vec::with_capacity(setup.io.len());
        for name in &setup.io {
            let (value, error) = match client.get_io(name) {
                Ok(value) => (Some(value), None),
                Err(error) if busy(&error) => return,
                Err(ClientError::Refused { refusal, .. }) => (None, Some(refusal.to_string())),
                // The next request would also time out.
                Err(error) => return self.clear(&error, setup),
            };
            all.push(NamedIo { name: name.clone(), direction: direction(name), value, error });
        }
        self.io = all;
    }

    /// Clears the state when the drive does not answer.
    fn clear(&mut self, error: &ClientError, setup: &Setup) {
        *self = Self { error: Some((setup.wording.request)(error)), ..Self::default() };
    }

    fn publish(&self, viewers: &Viewers) {
        let time = SystemTime::now();
        if let Some(status) = &self.status {
            viewers.drive_state(time, status);
        }
        if let Some(sensors) = &self.sensors {
            viewers.sensors(time, sensors);
        }
        let known: Vec<_> = self.io.iter().filter_map(|io| Some((&*io.name, io.value?))).collect();
        if !known.is_empty() {
            viewers.inputs_outputs(time, &known);
        }
    }
}
