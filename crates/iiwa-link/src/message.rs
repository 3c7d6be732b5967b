//! The messages between clients and iiwaDrive, in JSON.

use std::{fmt, str};

use iiwa_kin::{
    Joints,
    json::{Object, Place, problem},
};
use iiwa_path::Motion;
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{DeserializeOwned, Visitor},
};
use serde_json::value::RawValue;

use crate::timed_joints::TimedJoints;

/// Longest message that is taken, in bytes: a trajectory of some 400 000 points. A peer that sends a
/// longer one is disconnected.
pub const MAX_MESSAGE_BYTES: usize = 64 * 1024 * 1024;

/// What a client asks for.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Request {
    /// Run motions from where the robot is; answered when they are done.
    RunMotions {
        /// As in a program.
        motions: Vec<Motion>,
    },
    /// Run a trajectory, set-point by set-point; answered when it is done.
    RunTrajectory {
        /// Where the joints are to be, and when.
        trajectory: TimedJoints,
    },
    /// Read the robot's sensors.
    ReadSensors,
    /// Read an input or output.
    GetIo {
        /// Its name.
        name: String,
    },
    /// Set an output.
    SetIo {
        /// Its name.
        name: String,
        /// What it is to be.
        value: IoValue,
    },
    /// What the robot does now.
    State,
    /// What the last run measured, for a client whose own request broke off.
    LastRun,
    /// Stop the running motion or trajectory, on its path.
    Stop,
}

/// The `id` of a request, any JSON value, which comes back in its reply.
pub type Id = Box<RawValue>;

impl Request {
    /// The names of all requests.
    pub const TYPES: [&'static str; 8] = [
        "run_motions",
        "run_trajectory",
        "read_sensors",
        "get_io",
        "set_io",
        "state",
        "last_run",
        "stop",
    ];

    /// Reads a request, with its id.
    ///
    /// # Errors
    ///
    /// [`Code::BadRequest`] that says what is wrong and where, with the id as far as it can be read.
    pub fn from_json(bytes: &[u8]) -> (Option<Id>, Result<Self, Refusal>) {
        let Ok(text) = str::from_utf8(bytes) else {
            return (None, Err(Refusal::bad("the request is not text in UTF-8")));
        };
        let head = match serde_json::from_str::<Object<Head>>(text) {
            Ok(Object(head)) => head,
            Err(error) => return (id_of(text), Err(bad_json(text, &error))),
        };
        (head.id, Self::of_type(head.r#type.as_deref(), text))
    }

    fn of_type(name: Option<&str>, text: &str) -> Result<Self, Refusal> {
        match name {
            Some("run_motions") => {
                // The motions first: their errors say which of them is wrong.
                let motions = Motion::list_from_json(text)
                    .map_err(|error| Refusal::bad(error.to_string()))?;
                only::<WithMotions>(text)?;
                Ok(Self::RunMotions { motions })
            }
            Some("run_trajectory") => {
                let trajectory = only::<WithTrajectory>(text)?.trajectory.0;
                Ok(Self::RunTrajectory { trajectory })
            }
            Some("get_io") => Ok(Self::GetIo { name: only::<WithName>(text)?.name }),
            Some("set_io") => {
                let WithValue { name, value, .. } = only(text)?;
                Ok(Self::SetIo { name, value })
            }
            Some("read_sensors") => only::<Bare>(text).map(|_| Self::ReadSensors),
            Some("state") => only::<Bare>(text).map(|_| Self::State),
            Some("last_run") => only::<Bare>(text).map(|_| Self::LastRun),
            Some("stop") => only::<Bare>(text).map(|_| Self::Stop),
            Some(other) => Err(Refusal::bad(format!(
                "unknown type `{}`; known are {}",
                shortened(other),
                Self::TYPES.join(", ")
            ))),
            None => Err(Refusal::bad(format!(
                "the request has no `type`; known are {}",
                Self::TYPES.join(", ")
            ))),
        }
    }

    /// The request as JSON, with its name as `type`.
    #[must_use]
    pub fn to_json(&self) -> String {
        #[derive(Serialize)]
        #[serde(tag = "type", rename_all = "snake_case")]
        enum Out<'a> {
            RunMotions { motions: &'a [Motion] },
            RunTrajectory { trajectory: &'a TimedJoints },
            ReadSensors,
            GetIo { name: &'a str },
            SetIo { name: &'a str, value: IoValue },
            State,
            LastRun,
            Stop,
        }
        let out = match self {
            Self::RunMotions { motions } => Out::RunMotions { motions },
            Self::RunTrajectory { trajectory } => Out::RunTrajectory { trajectory },
            Self::ReadSensors => Out::ReadSensors,
            Self::GetIo { name } => Out::GetIo { name },
            Self::SetIo { name, value } => Out::SetIo { name, value: *value },
            Self::State => Out::State,
            Self::LastRun => Out::LastRun,
            Self::Stop => Out::Stop,
        };
        to_json(&out)
    }
}

/// A value as JSON. Only a map with keys that are no strings could fail.
pub(crate) fn to_json(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

/// Why a text is not the JSON that is asked for, and where.
pub(crate) fn bad_json(text: &str, error: &serde_json::Error) -> Refusal {
    Refusal::bad(format!("{}, at {}", problem(error), Place::of_error(text, text, error)))
}

/// The beginning of somebody's text, for messages; what is not ASCII is escaped.
pub(crate) fn shortened(text: &str) -> String {
    const MOST: usize = 60;
    let mut shown = String::new();
    for letter in text.chars() {
        if shown.len() >= MOST {
            shown.push_str("...");
            break;
        }
        shown.extend(letter.escape_default());
    }
    shown
}

/// A number in messages, with so many decimals; one of many digits with a power of ten.
pub(crate) struct Figures(pub(crate) f64, pub(crate) usize);

impl fmt::Display for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value, decimals) = self;
        if value.abs() < 1e9 { write!(f, "{value:.decimals$}") } else { write!(f, "{value:.3e}") }
    }
}

fn only<T: DeserializeOwned>(text: &str) -> Result<T, Refusal> {
    match serde_json::from_str::<Object<T>>(text) {
        Ok(Object(request)) => Ok(request),
        Err(error) => Err(bad_json(text, &error)),
    }
}

#[derive(Deserialize)]
struct Head {
    #[serde(default)]
    r#type: Option<String>,
    #[serde(default, deserialize_with = "given")]
    id: Option<Id>,
}

/// An id of `null` is one, too.
fn given<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Id>, D::Error> {
    Id::deserialize(deserializer).map(Some)
}

/// The id of a request in which something else is wrong.
fn id_of(text: &str) -> Option<Id> {
    #[derive(Deserialize)]
    struct OnlyId {
        #[serde(default, deserialize_with = "given")]
        id: Option<Id>,
    }
    serde_json::from_str::<Object<OnlyId>>(text).ok().and_then(|Object(only)| only.id)
}

/// What each request may have beside its own keys.
macro_rules! request {
    ($name:ident { $($field:ident: $type:ty),* }) => {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct $name {
            #[serde(rename = "type")]
            _type: String,
            #[serde(default, rename = "id")]
            _id: Option<Id>,
            $($field: $type,)*
        }
    };
}

request!(Bare {});
request!(WithName { name: String });
request!(WithValue { name: String, value: IoValue });
request!(WithTrajectory { trajectory: Object<TimedJoints> });

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WithMotions {
    #[serde(rename = "type")]
    _type: String,
    #[serde(default, rename = "id")]
    _id: Option<Id>,
    #[serde(rename = "motions")]
    _motions: Box<RawValue>,
}

/// The value of an input or output.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum IoValue {
    /// On or off.
    Boolean(bool),
    /// A whole number.
    Digital(u64),
    /// A number.
    Analog(f64),
}

impl<'de> Deserialize<'de> for IoValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OfValue;
        impl Visitor<'_> for OfValue {
            type Value = IoValue;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("true, false or a number")
            }
            fn visit_bool<E>(self, value: bool) -> Result<IoValue, E> {
                Ok(IoValue::Boolean(value))
            }
            fn visit_u64<E>(self, value: u64) -> Result<IoValue, E> {
                Ok(IoValue::Digital(value))
            }
            fn visit_i64<E>(self, value: i64) -> Result<IoValue, E> {
                Ok(IoValue::Analog(value as f64))
            }
            fn visit_f64<E>(self, value: f64) -> Result<IoValue, E> {
                Ok(IoValue::Analog(value))
            }
        }
        deserializer.deserialize_any(OfValue)
    }
}

impl fmt::Display for IoValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Boolean(value) => value.fmt(f),
            Self::Digital(value) => value.fmt(f),
            // Not with hundreds of digits.
            Self::Analog(value) if value.abs() >= 1e16 || value.abs() < 1e-5 && *value != 0.0 => {
                write!(f, "{value:e}")
            }
            Self::Analog(value) => value.fmt(f),
        }
    }
}

/// The kinds of errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Code {
    /// The request is not understood, or asks for what there is not.
    BadRequest,
    /// Another motion or trajectory is running.
    NotIdle,
    /// A limit of the robot would be exceeded.
    Limit,
    /// A trajectory does not start where the robot is.
    StartMismatch,
    /// The robot cannot, or has stopped.
    Robot,
    /// No answer in time.
    Timeout,
    /// The other side does not know the key.
    Unauthorized,
}

impl Code {
    /// Its name in messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::BadRequest => "bad_request",
            Self::NotIdle => "not_idle",
            Self::Limit => "limit",
            Self::StartMismatch => "start_mismatch",
            Self::Robot => "robot",
            Self::Timeout => "timeout",
            Self::Unauthorized => "unauthorized",
        }
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Why a request was not, or not wholly, carried out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
#[error("{message} ({code})")]
pub struct Refusal {
    /// The kind of error.
    pub code: Code,
    /// What is wrong, for people.
    pub message: String,
}

impl Refusal {
    pub(crate) fn new(code: Code, message: impl Into<String>) -> Self {
        Self { code, message: message.into() }
    }

    pub(crate) fn bad(message: impl Into<String>) -> Self {
        Self::new(Code::BadRequest, message)
    }

    pub(crate) fn robot(message: impl Into<String>) -> Self {
        Self::new(Code::Robot, message)
    }
}

/// What iiwaDrive and the robot are doing (Larsen 2019, section 3.1.1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DriveState {
    /// Nothing.
    #[default]
    Idle,
    /// Motions, planned by the controller.
    RunningMotion,
    /// A trajectory, commanded over FRI.
    RunningTrajectory,
}

impl DriveState {
    /// Its name in messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::RunningMotion => "running_motion",
            Self::RunningTrajectory => "running_trajectory",
        }
    }
}

impl fmt::Display for DriveState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Measured joint positions over time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Samples {
    /// Stamps, in s, as in the stream: time of the controller since iiwaDrive has first heard of it.
    pub t_s: Vec<f64>,
    /// Positions at these times, in rad.
    pub joints_rad: Vec<Joints>,
}

/// What a run measured.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// From the start to the end, in s; where the robot did not tell, there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycle_time_s: Option<f64>,
    /// When it started, in s, as stamps are; where the robot did not tell, there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_s: Option<f64>,
    /// What FRI brought from just before the start to the end.
    #[serde(default)]
    pub samples: Samples,
    /// Samples that were not kept, because the run was too long.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub samples_left_out: u64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde's way of calling")]
fn is_zero(count: &u64) -> bool {
    *count == 0
}

/// The robot's sensors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sensors {
    /// Temperatures of the joints, in degrees Celsius.
    pub joint_temperature_c: Joints,
    /// Torques from outside, in Nm.
    pub external_torque_nm: Joints,
}

/// How the connection to the controller is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FriStatus {
    /// State of the session, as `monitoring_ready`; `silent` when nothing comes in.
    pub session: String,
    /// The controller's verdict on the connection: `poor`, `fair`, `good` or `excellent`.
    pub quality: String,
    /// Messages of the controller that did not arrive.
    pub lost: u64,
    /// Messages that came after a younger one.
    pub late: u64,
}

/// What the robot does now.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Status {
    /// What it is doing.
    pub state: DriveState,
    /// Measured joint positions, in rad; none before the controller has been heard of.
    pub joints_rad: Option<Joints>,
    /// When they were measured, in s.
    pub t_s: Option<f64>,
    /// The connection of FRI.
    pub fri: FriStatus,
    /// Whether the robot program is there.
    #[serde(default)]
    pub robot_program: Presence,
}

/// Whether somebody is heard of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Presence {
    /// For some time there was no word.
    #[default]
    Silent,
    /// There was, a moment ago.
    Connected,
}

/// What a reply brings.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum Body {
    /// Of runs, also of those that were broken off, and of `last_run`.
    Run(Run),
    /// Of `state`.
    Status(Status),
    /// Of `read_sensors`.
    Sensors {
        /// What they say.
        sensors: Sensors,
    },
    /// Of `get_io` and `set_io`.
    Value {
        /// What it is now.
        value: IoValue,
    },
}

/// The answer to a request.
#[derive(Clone, Debug, Default)]
pub struct Reply {
    /// The request's id.
    pub id: Option<Id>,
    /// Why it was not, or not wholly, carried out.
    pub error: Option<Refusal>,
    /// What was asked for.
    pub body: Option<Body>,
}

impl Reply {
    /// The reply as JSON.
    #[must_use]
    pub fn to_json(&self) -> String {
        #[derive(Serialize)]
        struct Out<'a> {
            ok: bool,
            #[serde(skip_serializing_if = "Option::is_none")]
            id: Option<&'a Id>,
            #[serde(skip_serializing_if = "Option::is_none")]
            error: Option<&'a Refusal>,
            #[serde(flatten)]
            body: Option<&'a Body>,
        }
        let Self { id, error, body } = self;
        to_json(&Out {
            ok: error.is_none(),
            id: id.as_ref(),
            error: error.as_ref(),
            body: body.as_ref(),
        })
    }
}
