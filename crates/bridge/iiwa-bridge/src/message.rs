//! The messages of the bridge, version 1.
//!
//! All brokers get the same JSON; [`schema`] is its JSON Schema. Lengths and angles are in SI units and rad, `t_s` is the
//! controller's clock in s, `at` is when the bridge received the data.

use std::{
    collections::BTreeMap,
    time::{Duration, SystemTime, UNIX_EPOCH},
};

use iiwa_kin::Joints;
use iiwa_link::{
    message::{
        Conditions, DriveState, FriStatus, Hello, Presence, RunEnd, RunEvent, RunLabel, Sensors,
        Signal,
    },
    robot_program::RunId,
};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use crate::spool::Level;

/// The version of the schema.
pub const VERSION: u32 = 1;

/// A message.
///
/// ```
/// use iiwa_bridge::Message;
///
/// let text = r#"{"version": 1, "robot": "cell-1", "session": 1764108000123, "seq": 7, "at": "2026-11-25T22:00:00.000123Z",
///     "kind": "state", "t_s": 12.5, "state": "running_motion"}"#;
/// let message = Message::from_json(text.as_bytes()).unwrap();
/// assert_eq!(Message::from_json(message.to_json().as_bytes()).unwrap(), message);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Message {
    /// The version of the schema.
    pub version: u32,
    /// Name of the robot.
    pub robot: String,
    /// When the bridge started that sent it, in ms since 1970: different for each start, and later ones are larger.
    pub session: u64,
    /// The number of the message among those of its robot, kind and session, from 0 without gaps.
    pub seq: u64,
    /// When the bridge received the data.
    pub at: Timestamp,
    /// The content.
    #[serde(flatten)]
    pub content: Content,
}

impl Message {
    /// The message as JSON.
    #[must_use]
    pub fn to_json(&self) -> String {
        iiwa_link::message::to_json(self)
    }

    /// Parses a message.
    ///
    /// # Errors
    ///
    /// The text is not a message of this version.
    pub fn from_json(bytes: &[u8]) -> Result<Self, serde_json::Error> {
        let message: Self = serde_json::from_slice(bytes)?;
        if message.version == VERSION {
            Ok(message)
        } else {
            let version = message.version;
            Err(de::Error::custom(format!(
                "the message has version {version} of the schema; this program reads version {VERSION}"
            )))
        }
    }

    /// Its kind.
    #[must_use]
    pub fn kind(&self) -> Kind {
        self.content.kind()
    }
}

/// The JSON Schema of messages.
#[must_use]
pub fn schema() -> serde_json::Value {
    // A test validates messages with it, so it parses.
    serde_json::from_str(include_str!("message.schema.json")).unwrap_or_default()
}

/// The kinds of messages. Brokers have a topic for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// Measured positions and torques.
    Joints,
    /// What the drive does.
    State,
    /// Beginnings and ends of runs.
    Run,
    /// Inputs and outputs.
    Io,
    /// Temperatures and external torques.
    Sensors,
    /// Connections, operation mode, safety.
    Conditions,
    /// What the bridge says of itself.
    Bridge,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 7] = [
        Self::Joints,
        Self::State,
        Self::Run,
        Self::Io,
        Self::Sensors,
        Self::Conditions,
        Self::Bridge,
    ];

    /// Its name in JSON and in topics.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Joints => "joints",
            Self::State => "state",
            Self::Run => "run",
            Self::Io => "io",
            Self::Sensors => "sensors",
            Self::Conditions => "conditions",
            Self::Bridge => "bridge",
        }
    }

    /// Its place in [`ALL`](Self::ALL).
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }
}

/// The content of a message.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Content {
    /// Measured positions and torques, every cycle of FRI.
    Joints(JointSample),
    /// The new state of the drive.
    State {
        /// Time stamp, in s.
        t_s: f64,
        /// The state.
        state: DriveState,
    },
    /// The beginning or the end of a run.
    Run(RunMessage),
    /// Inputs and outputs, when one has changed, and every ten seconds.
    Io {
        /// All of them.
        io: Vec<Signal>,
    },
    /// Readings of sensors, once a second while the robot is idle.
    Sensors(Sensors),
    /// Conditions, when they change, and every ten seconds.
    Conditions(Box<RobotConditions>),
    /// What the bridge says of itself, every ten seconds.
    Bridge(BridgeStatus),
}

impl Content {
    /// Its kind.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::Joints(_) => Kind::Joints,
            Self::State { .. } => Kind::State,
            Self::Run(_) => Kind::Run,
            Self::Io { .. } => Kind::Io,
            Self::Sensors(_) => Kind::Sensors,
            Self::Conditions(_) => Kind::Conditions,
            Self::Bridge(_) => Kind::Bridge,
        }
    }
}

/// What the controller has measured in a cycle of FRI.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointSample {
    /// Time stamp, in s.
    pub t_s: f64,
    /// Positions, in rad.
    pub joints_rad: Joints,
    /// Torques, in Nm, if they are measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured_nm: Option<Joints>,
    /// External torques, in Nm, if torques are measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub external_nm: Option<Joints>,
}

/// The beginning or the end of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunMessage {
    /// Time stamp, in s.
    pub t_s: f64,
    /// The number of the run, the same at its beginning and its end.
    pub run: RunId,
    /// Whether it begins or ends.
    pub event: RunPhase,
    /// What runs: `motions` or `trajectory`.
    pub what: RunKind,
    /// Program and plan, as the client states them that has started the run.
    #[serde(flatten)]
    pub label: RunLabel,
    /// At the end: measured times, and why it failed, if it did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub result: Option<RunEnd>,
}

impl From<RunEvent> for RunMessage {
    fn from(RunEvent { t_s, run, kind, label, end, .. }: RunEvent) -> Self {
        let event = if end.is_some() { RunPhase::End } else { RunPhase::Begin };
        let what = match kind {
            DriveState::RunningTrajectory => RunKind::Trajectory,
            _ => RunKind::Motions,
        };
        Self { t_s, run, event, what, label, result: end }
    }
}

/// The beginning or the end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunPhase {
    /// It begins.
    Begin,
    /// It has ended.
    End,
}

/// What a run consists of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunKind {
    /// Motions, which the controller plans.
    Motions,
    /// A trajectory.
    Trajectory,
}

/// Connections and conditions of a robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RobotConditions {
    /// Whether the drive answers; the rest is unknown otherwise.
    pub drive: Presence,
    /// What the drive does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state: Option<DriveState>,
    /// The FRI connection.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fri: Option<FriStatus>,
    /// Whether the robot program is connected.
    #[serde(default)]
    pub robot_program: Presence,
    /// Whether the robot is a simulated one.
    #[serde(default)]
    pub simulated: bool,
    /// The versions of the robot program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hello: Option<Hello>,
    /// Operation mode, override, safety stop, tool.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub conditions: Option<Conditions>,
}

/// Counts of commands since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CommandCounts {
    /// Passed on to a drive.
    pub accepted: u64,
    /// Refused by the bridge.
    pub refused: u64,
}

/// What a bridge says of itself.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BridgeStatus {
    /// False in the last message of a bridge, and in its last will.
    pub online: bool,
    /// Commands so far.
    #[serde(default)]
    pub commands: CommandCounts,
    /// How full the spool for each broker is.
    #[serde(default)]
    pub spools: BTreeMap<String, Level>,
}

impl BridgeStatus {
    /// What a broker publishes when the connection breaks off.
    #[must_use]
    pub fn last_will(robot: &str, session: u64) -> Message {
        Message {
            version: VERSION,
            robot: robot.to_owned(),
            session,
            seq: 0,
            at: Timestamp::now(),
            content: Content::Bridge(Self::default()),
        }
    }
}

/// A time, in microseconds since 1970; RFC 3339 in JSON.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Timestamp(u64);

impl Timestamp {
    /// The current time.
    #[must_use]
    pub fn now() -> Self {
        Self::from(SystemTime::now())
    }

    /// From microseconds since 1970, before the year 10000.
    #[must_use]
    pub fn from_micros(micros: u64) -> Self {
        Self(micros.min(Self::LAST))
    }

    /// In microseconds since 1970.
    #[must_use]
    pub fn micros(self) -> u64 {
        self.0
    }

    /// The end of the year 9999, the last one that RFC 3339 knows.
    const LAST: u64 = 253_402_300_799_999_999;
}

impl From<SystemTime> for Timestamp {
    fn from(time: SystemTime) -> Self {
        let since = time.duration_since(UNIX_EPOCH).unwrap_or_default();
        Self::from_micros(u64::try_from(since.as_micros()).unwrap_or(Self::LAST))
    }
}

impl From<Timestamp> for SystemTime {
    fn from(time: Timestamp) -> Self {
        UNIX_EPOCH + Duration::from_micros(time.0)
    }
}

impl Serialize for Timestamp {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&humantime::format_rfc3339_micros(SystemTime::from(*self)))
    }
}

impl<'de> Deserialize<'de> for Timestamp {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        humantime::parse_rfc3339(&text).map(Self::from).map_err(|_| {
            de::Error::invalid_value(
                de::Unexpected::Str(&text),
                &"a time in UTC, as 2026-11-25T22:00:00Z",
            )
        })
    }
}
