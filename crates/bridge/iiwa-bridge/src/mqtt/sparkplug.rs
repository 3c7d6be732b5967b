//! Sparkplug B 3.0: the bridge is an edge node, and each robot is a device.
//!
//! Birth messages contain all metrics with their types, data messages contain the changed metrics.
//! `Node Control/Rebirth` is the only accepted command.

mod metrics;
mod payload;

use std::{
    collections::BTreeMap,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use iiwa_link::threads::ThreadGroup;
use metrics::{Metrics, SparkplugValue};
use payload::{decode_rebirth, encode};
use tokio::{
    sync::mpsc::{Receiver, Sender, channel},
    time::{interval, sleep},
};

use super::{
    connection::{
        BrokerConnection, Delivery, MqttConnection, MqttConnector, MqttFailure, MqttInput, Will,
    },
    payload::Pace,
};
use crate::{
    BridgeError, BridgedRobot,
    message::{Kind, Message},
    sink::Sink,
    trouble::Trouble,
};

/// Sparkplug settings.
#[derive(Clone, Debug)]
pub struct SparkplugOptions {
    /// The broker.
    pub connection: MqttConnection,
    /// Group of the edge node.
    pub group: String,
    /// Name of the edge node.
    pub node: String,
    /// Maximum rate of joint updates per robot, in Hz; `None` for all updates.
    pub rate_hz: Option<f64>,
}

/// The metric that reports the connection of a robot: without a connection, its device is dead.
const DRIVE_CONNECTED: &str = "Drive/Connected";

/// Maximum number of changes that wait to be sent.
const BACKLOG: usize = 1024;

/// Interval of the shutdown check.
const TURN: Duration = Duration::from_millis(100);

/// Pause after a failure.
const PAUSE: Duration = Duration::from_secs(1);

/// Publishes robots as devices of an edge node.
#[derive(Debug)]
pub struct Sparkplug {
    changes: Sender<(String, Metrics)>,
    paces: BTreeMap<String, Pace>,
    _threads: ThreadGroup,
}

impl Sparkplug {
    /// Starts sending, once the broker is found.
    ///
    /// # Errors
    ///
    /// A name cannot be part of a topic, a file cannot be used, or the broker refuses the user.
    pub fn start(options: &SparkplugOptions, robots: &[BridgedRobot]) -> Result<Self, BridgeError> {
        for name in [&options.group, &options.node] {
            if name.is_empty() || name.contains(['/', '+', '#']) {
                let message =
                    format!("`{name}` is not a name for Sparkplug: it is empty, or has /, + or #");
                return Err(BridgeError::Settings { message });
            }
        }
        let connector = options.connection.connector()?;
        let runtime = crate::runtime()?;
        runtime.block_on(connector.probe())?;
        let (changes, changes_out) = channel(BACKLOG);
        let devices = robots.iter().map(|robot| (robot.name().to_owned(), Metrics::new()));
        let node = EdgeNode {
            connector: Arc::new(connector),
            group: options.group.clone(),
            name: options.node.clone(),
            devices: devices.collect(),
            births: 0,
            seq: 0,
        };
        let mut threads = ThreadGroup::default();
        threads.spawn("bridge sparkplug", move |shutdown| {
            runtime.block_on(node.run(changes_out, shutdown));
        })?;
        let pace = |robot: &BridgedRobot| (robot.name().to_owned(), Pace::new(options.rate_hz));
        Ok(Self { changes, paces: robots.iter().map(pace).collect(), _threads: threads })
    }
}

impl Sink for Sparkplug {
    fn take(&self, message: &Message) {
        let is_due = |pace: &Pace| message.kind() != Kind::Joints || pace.is_due();
        if self.paces.get(&message.robot).is_some_and(is_due) {
            // Changes that do not fit while the broker is unavailable are contained in the next
            // birth message, or outdated.
            let _ = self.changes.try_send((message.robot.clone(), metrics::of(message)));
        }
    }
}

/// The edge node.
struct EdgeNode {
    connector: Arc<MqttConnector>,
    group: String,
    name: String,
    /// Latest values of each robot.
    devices: BTreeMap<String, Metrics>,
    /// Number of births, modulo 256 (`bdSeq`).
    births: u8,
    /// Number of the next message since the birth, modulo 256.
    seq: u8,
}

impl EdgeNode {
    async fn run(mut self, mut changes: Receiver<(String, Metrics)>, shutdown: &AtomicBool) {
        let mut trouble = Trouble::default();
        while !shutdown.load(Ordering::Relaxed) {
            let death =
                encode(None, &[("bdSeq".to_owned(), SparkplugValue::Int64(self.births.into()))]);
            let will = Will { topic: self.topic("NDEATH", None), payload: death, retain: false };
            let mut connection = self.connector.open(&self.name, Some(will));
            let sent = async {
                connection.connected().await?;
                trouble.clear();
                self.send(&mut connection, &mut changes, shutdown).await
            };
            match sent.await {
                Ok(()) => connection.end().await,
                Err(MqttFailure { message, .. }) => {
                    trouble
                        .warn(format_args!("Sparkplug at {}: {message}", self.connector.address()));
                    sleep(PAUSE).await;
                }
            }
            self.births = self.births.wrapping_add(1);
        }
    }

    async fn send(
        &mut self,
        connection: &mut BrokerConnection,
        changes: &mut Receiver<(String, Metrics)>,
        shutdown: &AtomicBool,
    ) -> Result<(), MqttFailure> {
        let commands = self.topic("NCMD", None);
        connection.subscribe(&commands).await?;
        self.be_born(connection).await?;
        let mut turn = interval(TURN);
        loop {
            tokio::select! {
                incoming = connection.next() => {
                    if let MqttInput::Message(received) = incoming?
                        && received.topic == commands
                        && decode_rebirth(&received.payload)
                    {
                        self.be_born(connection).await?;
                    }
                }
                Some((robot, metrics)) = changes.recv() => {
                    self.change(connection, &robot, metrics).await?;
                }
                _ = turn.tick() => {
                    if shutdown.load(Ordering::Relaxed) {
                        // The same message as after a lost connection.
                        let births = SparkplugValue::Int64(self.births.into());
                        let death = encode(None, &[("bdSeq".to_owned(), births)]);
                        let topic = self.topic("NDEATH", None);
                        return connection.publish(&topic, death, Delivery::AtMostOnce, None).await;
                    }
                }
            }
        }
    }

    /// Sends the birth messages of the node and all devices.
    async fn be_born(&mut self, connection: &BrokerConnection) -> Result<(), MqttFailure> {
        self.seq = 0;
        let metrics = [
            ("bdSeq".to_owned(), SparkplugValue::Int64(self.births.into())),
            ("Node Control/Rebirth".to_owned(), SparkplugValue::Boolean(false)),
        ];
        let birth = encode(Some(self.next_seq()), &metrics);
        let topic = self.topic("NBIRTH", None);
        connection.publish(&topic, birth, Delivery::AtMostOnce, None).await?;
        let is_alive = |device: &&String| {
            self.devices[*device].get(DRIVE_CONNECTED) == Some(&SparkplugValue::Boolean(true))
        };
        for robot in self.devices.keys().filter(is_alive).cloned().collect::<Vec<_>>() {
            self.device_birth(connection, &robot).await?;
        }
        Ok(())
    }

    async fn device_birth(
        &mut self,
        connection: &BrokerConnection,
        robot: &str,
    ) -> Result<(), MqttFailure> {
        let seq = self.next_seq();
        let metrics: Vec<_> = self
            .devices
            .get(robot)
            .into_iter()
            .flatten()
            .map(|(k, v)| (k.clone(), v.clone()))
            .collect();
        let topic = self.topic("DBIRTH", Some(robot));
        let birth = encode(Some(seq), &metrics);
        connection.publish(&topic, birth, Delivery::AtMostOnce, None).await
    }

    /// Sends the changed metrics, or a birth message if there are new metrics.
    async fn change(
        &mut self,
        connection: &BrokerConnection,
        robot: &str,
        metrics: Metrics,
    ) -> Result<(), MqttFailure> {
        let Some(device) = self.devices.get_mut(robot) else { return Ok(()) };
        if metrics.get(DRIVE_CONNECTED) == Some(&SparkplugValue::Boolean(false)) {
            let was_alive =
                device.insert(DRIVE_CONNECTED.to_owned(), SparkplugValue::Boolean(false));
            if was_alive != Some(SparkplugValue::Boolean(false)) {
                let seq = self.next_seq();
                let topic = self.topic("DDEATH", Some(robot));
                let death = encode(Some(seq), &[]);
                connection.publish(&topic, death, Delivery::AtMostOnce, None).await?;
            }
            return Ok(());
        }
        let was_dead = device.get(DRIVE_CONNECTED) == Some(&SparkplugValue::Boolean(false));
        if was_dead && !metrics.contains_key(DRIVE_CONNECTED) {
            // Stale data from before the drive was disconnected.
            return Ok(());
        }
        let is_new = was_dead || metrics.keys().any(|name| !device.contains_key(name));
        let changed: Vec<_> =
            metrics.into_iter().filter(|(name, value)| device.get(name) != Some(value)).collect();
        if changed.is_empty() {
            return Ok(());
        }
        device.extend(changed.iter().cloned());
        if is_new {
            return self.device_birth(connection, robot).await;
        }
        let seq = self.next_seq();
        let topic = self.topic("DDATA", Some(robot));
        let data = encode(Some(seq), &changed);
        connection.publish(&topic, data, Delivery::AtMostOnce, None).await
    }

    fn next_seq(&mut self) -> u8 {
        let seq = self.seq;
        self.seq = seq.wrapping_add(1);
        seq
    }

    fn topic(&self, kind: &str, device: Option<&str>) -> String {
        let Self { group, name, .. } = self;
        let device = device.map(|device| format!("/{device}")).unwrap_or_default();
        format!("spBv1.0/{group}/{kind}/{name}{device}")
    }
}
