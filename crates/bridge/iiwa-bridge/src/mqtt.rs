//! MQTT 3.1.1 and 5: a topic a robot and kind of message, such as `iiwasim/cell-1/state`.
//!
//! Events are spooled, and sent in order with `QoS` 1 and retained. Joints are sent with `QoS` 0, not more often than asked for, and
//! never late. Each robot has a connection of its own, with a last will: `iiwasim/cell-1/bridge` says whether the bridge is
//! online.

mod connection;
mod payload;
mod session;
mod sparkplug;

use std::{
    path::PathBuf,
    sync::{Arc, Mutex, PoisonError},
};

use iiwa_link::threads::ThreadGroup;
use tokio::sync::mpsc::{Sender, channel};

pub use connection::{MqttConnection, MqttVersion};
use payload::Pace;
use session::{Session, SpooledEvent};
pub use sparkplug::{Sparkplug, SparkplugOptions};

use crate::{
    BridgeError, BridgedRobot,
    commands::CommandGate,
    encoding::JointFormat,
    message::{Kind, Message},
    sink::Sink,
    spool::Level,
    spooling::SpoolTarget,
};

/// How messages reach the broker.
#[derive(Clone, Debug)]
pub struct MqttOptions {
    /// The broker.
    pub connection: MqttConnection,
    /// What topics begin with, before `/cell-1/joints` and so on.
    pub prefix: String,
    /// Most `joints` messages per second and robot; `None` for all.
    pub rate_hz: Option<f64>,
    /// The format of joints.
    pub joints: JointFormat,
    /// Folder of the spools.
    pub spool: PathBuf,
    /// The most that the spool of a robot may hold, in bytes.
    pub spool_bytes: u64,
}

/// Samples that wait to be sent; later ones replace none of them, but are left out.
const SAMPLES: usize = 64;

/// Sends the messages of robots to an MQTT broker, and receives commands.
#[derive(Debug)]
pub struct Mqtt {
    robots: Vec<RobotTarget>,
    joints: JointFormat,
    _threads: ThreadGroup,
}

/// Where the messages of a robot go.
#[derive(Debug)]
struct RobotTarget {
    name: String,
    events: Arc<SpoolTarget>,
    /// What the bridge said last of itself.
    status: Arc<Mutex<Vec<u8>>>,
    samples: Sender<Vec<u8>>,
    pace: Pace,
}

impl Mqtt {
    /// Starts to send, once the broker is found; `gate` takes the commands that come by the topics of requests.
    ///
    /// # Errors
    ///
    /// A file cannot be used, the settings contradict each other, or the broker refuses the user. A broker that cannot be
    /// reached is waited for.
    pub fn start(
        options: &MqttOptions,
        robots: &[BridgedRobot],
        session: u64,
        gate: &Arc<CommandGate>,
    ) -> Result<Self, BridgeError> {
        let connector = Arc::new(options.connection.connector()?);
        let runtime = crate::runtime()?;
        runtime.block_on(connector.probe())?;
        drop(runtime);
        let mut threads = ThreadGroup::default();
        let mut targets = Vec::new();
        for robot in robots {
            let folder = options.spool.join(robot.name());
            let (events, reader) = SpoolTarget::open(&folder, options.spool_bytes)?;
            let status = Arc::default();
            let (samples, samples_out) = channel(SAMPLES);
            let to_broker = Session {
                connector: Arc::clone(&connector),
                robot: robot.name().to_owned(),
                topic: format!("{}/{}", options.prefix, robot.name()),
                started: session,
                spool: Arc::clone(&events),
                status: Arc::clone(&status),
                reader,
                samples: samples_out,
                gate: Arc::clone(gate),
            };
            let runtime = crate::runtime()?;
            threads.spawn("bridge mqtt", move |shutdown| {
                runtime.block_on(to_broker.run(shutdown));
            })?;
            let name = robot.name().to_owned();
            let pace = Pace::new(options.rate_hz);
            targets.push(RobotTarget { name, events, status, samples, pace });
        }
        Ok(Self { robots: targets, joints: options.joints, _threads: threads })
    }

    /// How full its spools are together.
    #[must_use]
    pub fn level(&self) -> Level {
        let levels = self.robots.iter().map(|robot| robot.events.level());
        levels.fold(Level::default(), |sum, level| Level {
            bytes: sum.bytes + level.bytes,
            dropped: sum.dropped + level.dropped,
        })
    }
}

impl Sink for Mqtt {
    fn take(&self, message: &Message) {
        let Some(robot) = self.robots.iter().find(|robot| robot.name == message.robot) else {
            return;
        };
        if message.kind() == Kind::Bridge {
            *robot.status.lock().unwrap_or_else(PoisonError::into_inner) =
                message.to_json().into_bytes();
        }
        if message.kind() != Kind::Joints {
            robot.events.append_now(&SpooledEvent::of(message).to_bytes());
        } else if robot.pace.is_due() {
            // While the broker is away, the queue is full, and samples are dropped.
            let _ = robot.samples.try_send(self.joints.encode(message));
        }
    }
}
