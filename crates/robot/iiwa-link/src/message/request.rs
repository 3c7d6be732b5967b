//! Client requests.

use std::str;

use iiwa_json::JsonObject;
use iiwa_program::MotionList;
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{DeserializeOwned, IgnoredAny},
};
use serde_json::value::RawValue;

use crate::{
    message::{
        io::IoValue,
        refusal::Refusal,
        run_label::RunLabel,
        text::{bad_json, shortened, to_json},
    },
    timed_joints::TimedJoints,
};

/// A client request.
///
/// ```
/// use iiwa_link::message::Request;
///
/// let (id, request) = Request::from_json(br#"{"type": "get_io", "name": "in1", "id": 7}"#);
/// assert_eq!(request, Ok(Request::GetIo { name: "in1".to_owned() }));
/// assert_eq!(id.unwrap().get(), "7");
/// assert_eq!(Request::Stop.to_json(), r#"{"type":"stop"}"#);
///
/// let (_, error) = Request::from_json(br#"{"type": "fly"}"#);
/// assert!(error.unwrap_err().message.starts_with("unknown type `fly`"));
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Request {
    /// Run motions from the current position. The reply is sent when they have ended.
    RunMotions {
        /// The motions, with the tools, bases and frames that they use, as in a program.
        motions: MotionList,
        /// The client's label of the run.
        label: RunLabel,
    },
    /// Run a trajectory over FRI. The reply is sent when it has ended.
    RunTrajectory {
        /// The trajectory.
        trajectory: TimedJoints,
        /// The client's label of the run.
        label: RunLabel,
    },
    /// Read the robot's sensors.
    ReadSensors,
    /// Read all inputs and outputs.
    ListIo,
    /// Read an input or output.
    GetIo {
        /// Name of the signal.
        name: String,
    },
    /// Set an output.
    SetIo {
        /// Name of the output.
        name: String,
        /// New value.
        value: IoValue,
    },
    /// Read the state of drive and robot.
    State,
    /// Read the measurements of the last run again, such as after a lost connection.
    LastRun,
    /// Stop the running motion or trajectory on its path.
    Stop,
}

/// The `id` of a request: any JSON value, returned in the reply.
pub type Id = Box<RawValue>;

impl Request {
    /// The `type` values of all requests.
    pub const TYPES: [&'static str; 9] = [
        "run_motions",
        "run_trajectory",
        "read_sensors",
        "list_io",
        "get_io",
        "set_io",
        "state",
        "last_run",
        "stop",
    ];

    /// Creates a request to run motions, without a label.
    #[must_use]
    pub fn motions(motions: impl Into<MotionList>) -> Self {
        Self::RunMotions { motions: motions.into(), label: RunLabel::default() }
    }

    /// Creates a request to run a trajectory, without a label.
    #[must_use]
    pub fn trajectory(trajectory: TimedJoints) -> Self {
        Self::RunTrajectory { trajectory, label: RunLabel::default() }
    }

    /// Returns the request with this label, if it is a run request.
    #[must_use]
    pub fn labelled(mut self, with: RunLabel) -> Self {
        if let Self::RunMotions { label, .. } | Self::RunTrajectory { label, .. } = &mut self {
            *label = with;
        }
        self
    }

    /// Parses a request and its id: [`head`](Self::head), then [`parse`](RequestHead::parse).
    ///
    /// # Errors
    ///
    /// [`Code::BadRequest`](crate::message::Code::BadRequest) with the fault and its position. The
    /// id is returned if it can be parsed.
    pub fn from_json(bytes: &[u8]) -> (Option<Id>, Result<Self, Refusal>) {
        let (id, head) = Self::head(bytes);
        (id, head.and_then(RequestHead::parse))
    }

    /// Parses the id and the `type` of a request; the rest is only checked to be JSON.
    ///
    /// # Errors
    ///
    /// Same as [`from_json`](Self::from_json), for faults that precede the type-specific content.
    pub fn head(bytes: &[u8]) -> (Option<Id>, Result<RequestHead<'_>, Refusal>) {
        let Ok(text) = str::from_utf8(bytes) else {
            return (None, Err(Refusal::bad("the request is not text in UTF-8")));
        };
        // A busy drive refuses requests by their head, without parsing a long trajectory.
        match serde_json::from_str::<JsonObject<HeadKeys>>(text) {
            Ok(JsonObject(HeadKeys { r#type, id })) => (id, Ok(RequestHead { r#type, text })),
            // Also a refusal needs the id, by which the client assigns replies to requests.
            Err(error) => (id_of(text), Err(bad_json(text, &error))),
        }
    }

    fn of_type(name: Option<&str>, text: &str) -> Result<Self, Refusal> {
        match name {
            Some("run_motions") => {
                // The motions are parsed first, because their errors contain the index of the
                // motion.
                let motions =
                    MotionList::from_json(text).map_err(|error| Refusal::bad(error.to_string()))?;
                let label = parse::<MotionsRequest>(text)?.label.check()?;
                Ok(Self::RunMotions { motions, label })
            }
            Some("run_trajectory") => {
                let TrajectoryRequest { trajectory, label, .. } = parse(text)?;
                Ok(Self::RunTrajectory { trajectory: trajectory.0, label: label.check()? })
            }
            Some("get_io") => Ok(Self::GetIo { name: parse::<NameRequest>(text)?.name }),
            Some("set_io") => {
                let ValueRequest { name, value, .. } = parse(text)?;
                Ok(Self::SetIo { name, value })
            }
            Some("read_sensors") => parse::<BareRequest>(text).map(|_| Self::ReadSensors),
            Some("list_io") => parse::<BareRequest>(text).map(|_| Self::ListIo),
            Some("state") => parse::<BareRequest>(text).map(|_| Self::State),
            Some("last_run") => parse::<BareRequest>(text).map(|_| Self::LastRun),
            Some("stop") => parse::<BareRequest>(text).map(|_| Self::Stop),
            Some(other) => Err(Refusal::bad(format!(
                "unknown type `{}`; known types are {}",
                shortened(other),
                Self::TYPES.join(", ")
            ))),
            None => Err(Refusal::bad(format!(
                "the request has no `type`; known types are {}",
                Self::TYPES.join(", ")
            ))),
        }
    }

    /// Returns the request as JSON, with its name as `type`.
    #[must_use]
    pub fn to_json(&self) -> String {
        #[derive(Serialize)]
        #[serde(tag = "type", rename_all = "snake_case")]
        enum RequestJson<'a> {
            RunMotions {
                #[serde(flatten)]
                motions: &'a MotionList,
                #[serde(skip_serializing_if = "RunLabel::is_empty")]
                label: &'a RunLabel,
            },
            RunTrajectory {
                trajectory: &'a TimedJoints,
                #[serde(skip_serializing_if = "RunLabel::is_empty")]
                label: &'a RunLabel,
            },
            ReadSensors,
            ListIo,
            GetIo {
                name: &'a str,
            },
            SetIo {
                name: &'a str,
                value: IoValue,
            },
            State,
            LastRun,
            Stop,
        }
        let out = match self {
            Self::RunMotions { motions, label } => RequestJson::RunMotions { motions, label },
            Self::RunTrajectory { trajectory, label } => {
                RequestJson::RunTrajectory { trajectory, label }
            }
            Self::ReadSensors => RequestJson::ReadSensors,
            Self::ListIo => RequestJson::ListIo,
            Self::GetIo { name } => RequestJson::GetIo { name },
            Self::SetIo { name, value } => RequestJson::SetIo { name, value: *value },
            Self::State => RequestJson::State,
            Self::LastRun => RequestJson::LastRun,
            Self::Stop => RequestJson::Stop,
        };
        to_json(&out)
    }
}

fn parse<T: DeserializeOwned>(text: &str) -> Result<T, Refusal> {
    match serde_json::from_str::<JsonObject<T>>(text) {
        Ok(JsonObject(request)) => Ok(request),
        Err(error) => Err(bad_json(text, &error)),
    }
}

/// A request whose `type` is known and whose content has not been parsed yet.
///
/// ```
/// use iiwa_link::message::Request;
///
/// let (_, head) = Request::head(br#"{"type": "stop"}"#);
/// let head = head.unwrap();
/// assert_eq!(head.name(), Some("stop"));
/// assert_eq!(head.parse(), Ok(Request::Stop));
/// ```
#[derive(Clone, Debug)]
pub struct RequestHead<'a> {
    r#type: Option<String>,
    text: &'a str,
}

impl RequestHead<'_> {
    /// Returns the `type`; `None` if the request has none.
    #[must_use]
    pub fn name(&self) -> Option<&str> {
        self.r#type.as_deref()
    }

    /// Parses the content.
    ///
    /// # Errors
    ///
    /// Same as [`Request::from_json`].
    pub fn parse(self) -> Result<Request, Refusal> {
        Request::of_type(self.r#type.as_deref(), self.text)
    }
}

#[derive(Deserialize)]
struct HeadKeys {
    #[serde(default)]
    r#type: Option<String>,
    #[serde(default, deserialize_with = "given")]
    id: Option<Id>,
}

/// Deserializes an id, so that `null` counts as an id.
fn given<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Id>, D::Error> {
    Id::deserialize(deserializer).map(Some)
}

/// Returns the id of a request that is otherwise malformed.
fn id_of(text: &str) -> Option<Id> {
    #[derive(Deserialize)]
    struct OnlyId {
        #[serde(default, deserialize_with = "given")]
        id: Option<Id>,
    }
    serde_json::from_str::<JsonObject<OnlyId>>(text).ok().and_then(|JsonObject(only)| only.id)
}

/// Declares the JSON object of a request: its specific keys, `type` and `id`.
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

request!(BareRequest {});
request!(NameRequest { name: String });
request!(ValueRequest { name: String, value: IoValue });

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
// Not declared by the macro, whose keys are all required.
struct TrajectoryRequest {
    #[serde(rename = "type")]
    _type: String,
    #[serde(default, rename = "id")]
    _id: Option<Id>,
    trajectory: JsonObject<TimedJoints>,
    #[serde(default)]
    label: RunLabel,
}

/// Allowed keys of the request; [`MotionList`] parses most of their values.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MotionsRequest {
    #[serde(rename = "type")]
    _type: String,
    #[serde(default, rename = "id")]
    _id: Option<Id>,
    #[serde(rename = "motions")]
    _motions: IgnoredAny,
    #[serde(default, rename = "tools")]
    _tools: IgnoredAny,
    #[serde(default, rename = "bases")]
    _bases: IgnoredAny,
    #[serde(default, rename = "frames")]
    _frames: IgnoredAny,
    #[serde(default, rename = "tool")]
    _tool: IgnoredAny,
    #[serde(default, rename = "base")]
    _base: IgnoredAny,
    #[serde(default, rename = "mode")]
    _mode: IgnoredAny,
    #[serde(default, rename = "mount")]
    _mount: IgnoredAny,
    #[serde(default)]
    label: RunLabel,
}
