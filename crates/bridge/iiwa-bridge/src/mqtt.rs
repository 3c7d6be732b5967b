//! MQTT 3.1.1 and 5: one topic per robot and message kind, such as `iiwasim/cell-1/state`.
//!
//! Events are spooled, and sent in order with `QoS` 1 and the retain flag. Joints are sent with
//! `QoS` 0, at most at the configured rate, and never late. Each robot has a separate connection
//! with a last will: `iiwasim/cell-1/bridge` reports whether the bridge is online.

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

/// MQTT settings.
#[derive(Clone, Debug)]
pub struct MqttOptions {
    /// The broker.
    pub connection: MqttConnection,
    /// Topic prefix, before `/cell-1/joints` and so on.
    pub prefix: String,
    /// Maximum rate of `joints` messages per robot, in Hz; `None` for all messages.
    pub rate_hz: Option<f64>,
    /// Format of `joints` messages.
    pub joints: JointFormat,
    /// Folder of the spools.
    pub spool: PathBuf,
    /// Maximum size of a robot's spool, in bytes.
    pub spool_bytes: u64,
}

/// Maximum number of samples that wait to be sent; further samples are dropped.
const SAMPLES: usize = 64;

/// Sends robot messages to an MQTT broker, and receives commands.
#[derive(Debug)]
pub struct Mqtt {
    robots: Vec<RobotTarget>,
    joints: JointFormat,
    _threads: ThreadGroup,
}

/// Destination of a robot's messages.
#[derive(Debug)]
struct RobotTarget {
    name: String,
    events: Arc<SpoolTarget>,
    /// Last status message of the bridge.
    status: Arc<Mutex<Vec<u8>>>,
    samples: Sender<Vec<u8>>,
    pace: Pace,
}

impl Mqtt {
    /// Starts sending, once the broker is found; `gate` receives the commands of the request
    /// topics.
    ///
    /// # Errors
    ///
    /// A file cannot be used, the settings contradict each other, or the broker refuses the user.
    /// An unreachable broker is retried.
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

    /// Returns the total level of the spools.
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
            // While the broker is unavailable, the queue is full, and samples are dropped.
            let _ = robot.samples.try_send(self.joints.encode(message));
        }
    }
}
