//! Bridge messages, version 1.
//!
//! All brokers receive the same JSON; [`schema`] is its JSON Schema. Lengths and angles are in SI
//! units and rad, `t_s` is the controller time in s, `at` is the time at which the bridge received
//! the data.

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

/// Schema version.
pub const VERSION: u32 = 1;

/// A message.
///
/// ```
/// use iiwa_bridge::Message;
///
/// let text = r#"{"version": 1, "robot": "cell-1", "session": 1764108000123, "seq": 7,
///     "at": "2026-11-25T22:00:00.000123Z",
///     "kind": "state", "t_s": 12.5, "state": "running_motion"}"#;
/// let message = Message::from_json(text.as_bytes()).unwrap();
/// assert_eq!(Message::from_json(message.to_json().as_bytes()).unwrap(), message);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Message {
    /// Schema version.
    pub version: u32,
    /// Robot name.
    pub robot: String,
    /// Start time of the bridge session, in ms since 1970: unique and increasing.
    pub session: u64,
    /// Number of the message within its robot, kind and session, from 0 without gaps.
    pub seq: u64,
    /// Time at which the bridge received the data.
    pub at: Timestamp,
    /// Content.
    #[serde(flatten)]
    pub content: Content,
}

impl Message {
    /// Returns the message as JSON.
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
                "the message has version {version} of the schema; this program reads version \
                 {VERSION}"
            )))
        }
    }

    /// Returns the kind.
    #[must_use]
    pub fn kind(&self) -> Kind {
        self.content.kind()
    }
}

/// Returns the JSON Schema of messages.
#[must_use]
pub fn schema() -> serde_json::Value {
    // The schema is valid JSON: a test validates messages with it.
    serde_json::from_str(include_str!("message.schema.json")).unwrap_or_default()
}

/// Message kinds. Brokers have one topic per kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// Measured positions and torques.
    Joints,
    /// State of the drive.
    State,
    /// Run start and end events.
    Run,
    /// Inputs and outputs.
    Io,
    /// Temperatures and external torques.
    Sensors,
    /// Connections, operation mode, safety.
    Conditions,
    /// Status of the bridge.
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

    /// Returns the name in JSON and in topics.
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

    /// Returns the index in [`ALL`](Self::ALL).
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
    /// Measured positions and torques, every FRI cycle.
    Joints(CycleSample),
    /// The new state of the drive.
    State {
        /// Time stamp, in s.
        t_s: f64,
        /// The state.
        state: DriveState,
    },
    /// Start or end of a run.
    Run(RunMessage),
    /// Inputs and outputs, on every change, and every ten seconds.
    Io {
        /// All inputs and outputs.
        io: Vec<Signal>,
    },
    /// Sensor readings, once per second while the robot is idle.
    Sensors(Sensors),
    /// Conditions, on every change, and every ten seconds.
    Conditions(Box<RobotConditions>),
    /// Status of the bridge, every ten seconds.
    Bridge(BridgeStatus),
}

impl Content {
    /// Returns the kind.
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

/// Measurements of the controller in an FRI cycle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CycleSample {
    /// Time stamp, in s.
    pub t_s: f64,
    /// Positions, in rad.
    pub joints_rad: Joints,
    /// Torques, in Nm, if measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured_nm: Option<Joints>,
    /// External torques, in Nm, if torques are measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub external_nm: Option<Joints>,
}

/// Start or end of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunMessage {
    /// Time stamp, in s.
    pub t_s: f64,
    /// Number of the run, equal at its start and its end.
    pub run: RunId,
    /// Phase: start or end.
    pub event: RunPhase,
    /// Kind of the run: `motions` or `trajectory`.
    pub what: RunKind,
    /// Program and plan, as stated by the client that started the run.
    #[serde(flatten)]
    pub label: RunLabel,
    /// Measured times, and the error of a failed run; at the end only.
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

/// Phase of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunPhase {
    /// The run begins.
    Begin,
    /// The run has ended.
    End,
}

/// Kind of a run.
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
    /// Connection state of the drive; if silent, the other values are unknown.
    pub drive: Presence,
    /// State of the drive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state: Option<DriveState>,
    /// The FRI connection.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fri: Option<FriStatus>,
    /// Connection state of the robot program.
    #[serde(default)]
    pub robot_program: Presence,
    /// `true` if the robot is simulated.
    #[serde(default)]
    pub simulated: bool,
    /// Versions of the robot program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hello: Option<Hello>,
    /// Operation mode, override, safety stop, tool.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub conditions: Option<Conditions>,
}

/// Command counts since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CommandCounts {
    /// Commands forwarded to a drive.
    pub accepted: u64,
    /// Commands refused by the bridge.
    pub refused: u64,
}

/// Status of a bridge.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BridgeStatus {
    /// `false` in the last message of a bridge, and in its last will.
    pub online: bool,
    /// Command counts so far.
    #[serde(default)]
    pub commands: CommandCounts,
    /// Spool level for each broker.
    #[serde(default)]
    pub spools: BTreeMap<String, Level>,
}

impl BridgeStatus {
    /// Returns the message that a broker publishes when the connection is lost.
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
    /// Returns the current time.
    #[must_use]
    pub fn now() -> Self {
        Self::from(SystemTime::now())
    }

    /// Creates a time from microseconds since 1970, clamped to the year 9999.
    #[must_use]
    pub fn from_micros(micros: u64) -> Self {
        Self(micros.min(Self::LAST))
    }

    /// Returns the time in microseconds since 1970.
    #[must_use]
    pub fn micros(self) -> u64 {
        self.0
    }

    /// End of the year 9999, the last year of RFC 3339.
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
