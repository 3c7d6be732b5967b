//! A bridge between robots and sinks.

use std::{
    collections::{BTreeMap, HashSet},
    path::PathBuf,
    sync::{Arc, atomic::AtomicBool},
    time::{Duration, SystemTime, UNIX_EPOCH},
};

use iiwa_link::threads::ThreadGroup;

#[cfg(feature = "kafka")]
use crate::kafka::{Kafka, KafkaOptions};
#[cfg(feature = "mqtt")]
use crate::mqtt::{Mqtt, MqttOptions, Sparkplug, SparkplugOptions};
use crate::{
    BridgeError, BridgedRobot, Sink,
    commands::CommandGate,
    feed::Feed,
    message::{BridgeStatus, CommandCounts},
    spool::Level,
    trouble::pause,
};

/// Interval of the bridge's status messages.
const STATUS_EVERY: Duration = Duration::from_secs(10);

/// Configuration of a bridge.
#[derive(Clone, Debug, Default)]
pub struct BridgeOptions {
    /// The robots.
    pub robots: Vec<BridgedRobot>,
    /// `true` if commands are accepted.
    pub allow_commands: bool,
    /// Kafka, if used.
    #[cfg(feature = "kafka")]
    pub kafka: Option<KafkaOptions>,
    /// MQTT, if used.
    #[cfg(feature = "mqtt")]
    pub mqtt: Option<MqttOptions>,
    /// Sparkplug, if used.
    #[cfg(feature = "mqtt")]
    pub sparkplug: Option<SparkplugOptions>,
}

/// A running bridge. Dropping it sends queued messages for up to two seconds; the rest remains in
/// the spools for the next start.
pub struct Bridge {
    // Drop order: the feeds end before the sinks.
    _status: ThreadGroup,
    feeds: Arc<Vec<Feed>>,
    gate: Arc<CommandGate>,
    sinks: Arc<Sinks>,
}

impl std::fmt::Debug for Bridge {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Bridge").field("feeds", &self.feeds).finish_non_exhaustive()
    }
}

/// The sinks that report their spool levels, and all sinks.
#[derive(Default)]
struct Sinks {
    #[cfg(feature = "kafka")]
    kafka: Option<Arc<Kafka>>,
    #[cfg(feature = "mqtt")]
    mqtt: Option<Arc<Mqtt>>,
    all: Vec<Arc<dyn Sink>>,
}

impl Bridge {
    /// Starts a bridge, with `further` sinks in addition to the configured ones.
    ///
    /// # Errors
    ///
    /// Two robots have the same name, a file cannot be used, settings contradict each other, or a
    /// broker refuses the connection. Unreachable drives and brokers are retried.
    pub fn start(
        options: &BridgeOptions,
        further: Vec<Arc<dyn Sink>>,
    ) -> Result<Self, BridgeError> {
        let mut names = HashSet::new();
        for robot in &options.robots {
            if !names.insert(robot.name()) {
                return Err(BridgeError::SameName { name: robot.name().to_owned() });
            }
        }
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let session = u64::try_from(since.as_millis()).unwrap_or_default();
        let gate = Arc::new(CommandGate::new(&options.robots, options.allow_commands)?);
        let sinks = Arc::new(Sinks::start(options, session, &gate, further)?);
        let all: Arc<[Arc<dyn Sink>]> = sinks.all.clone().into();
        let feeds =
            options.robots.iter().map(|robot| Feed::start(robot, session, Arc::clone(&all)));
        let feeds = Arc::new(feeds.collect::<Result<Vec<_>, _>>()?);
        let mut status = ThreadGroup::default();
        let (to, from, counted) = (Arc::clone(&feeds), Arc::clone(&sinks), Arc::clone(&gate));
        status.spawn("bridge status", move |shutdown| {
            publish_status(&to, &from, &counted, shutdown);
        })?;
        Ok(Self { _status: status, feeds, gate, sinks })
    }

    /// Returns the command counts so far.
    #[must_use]
    pub fn commands(&self) -> CommandCounts {
        self.gate.counts()
    }

    /// Returns the spool level for each broker.
    #[must_use]
    pub fn spools(&self) -> BTreeMap<String, Level> {
        self.sinks.spools()
    }
}

/// Returns the default spool folder, in the user's state directory.
#[must_use]
pub fn default_spool() -> PathBuf {
    let data = std::env::var_os("XDG_STATE_HOME").map(PathBuf::from);
    let home = || std::env::home_dir().map(|home| home.join(".local/state"));
    data.or_else(home).unwrap_or_default().join("iiwasim/spool")
}

#[cfg_attr(
    not(all(feature = "kafka", feature = "mqtt")),
    allow(unused_mut, unused_variables, reason = "a broker that is left out uses nothing")
)]
impl Sinks {
    fn start(
        options: &BridgeOptions,
        session: u64,
        gate: &Arc<CommandGate>,
        further: Vec<Arc<dyn Sink>>,
    ) -> Result<Self, BridgeError> {
        let mut sinks = Self { all: further, ..Self::default() };
        #[cfg(feature = "kafka")]
        if let Some(kafka) = &options.kafka {
            let kafka = Arc::new(Kafka::start(kafka, Arc::clone(gate))?);
            sinks.all.push(kafka.clone());
            sinks.kafka = Some(kafka);
        }
        #[cfg(feature = "mqtt")]
        if let Some(mqtt) = &options.mqtt {
            let mqtt = Arc::new(Mqtt::start(mqtt, &options.robots, session, gate)?);
            sinks.all.push(mqtt.clone());
            sinks.mqtt = Some(mqtt);
        }
        #[cfg(feature = "mqtt")]
        if let Some(sparkplug) = &options.sparkplug {
            sinks.all.push(Arc::new(Sparkplug::start(sparkplug, &options.robots)?));
        }
        Ok(sinks)
    }

    fn spools(&self) -> BTreeMap<String, Level> {
        let mut spools = BTreeMap::new();
        #[cfg(feature = "kafka")]
        if let Some(kafka) = &self.kafka {
            spools.insert("kafka".to_owned(), kafka.level());
        }
        #[cfg(feature = "mqtt")]
        if let Some(mqtt) = &self.mqtt {
            spools.insert("mqtt".to_owned(), mqtt.level());
        }
        spools
    }
}

fn publish_status(feeds: &[Feed], sinks: &Sinks, gate: &CommandGate, shutdown: &AtomicBool) {
    let publish = |online| {
        for feed in feeds {
            feed.send(BridgeStatus { online, commands: gate.counts(), spools: sinks.spools() });
        }
    };
    while !shutdown.load(std::sync::atomic::Ordering::Relaxed) {
        publish(true);
        pause(STATUS_EVERY, shutdown);
    }
    publish(false);
}
