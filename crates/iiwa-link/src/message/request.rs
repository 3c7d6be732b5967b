//! What clients ask for.

use std::str;

use iiwa_json::Object;
use iiwa_path::Motion;
use serde::{Deserialize, Deserializer, Serialize, de::DeserializeOwned};
use serde_json::value::RawValue;

use super::{IoValue, Refusal, bad_json, shortened, to_json};
use crate::timed_joints::TimedJoints;

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
    /// [`Code::BadRequest`](super::Code::BadRequest) that says what is wrong and where, with the id as far as it can be read.
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

    /// What a request is called, and its id, without reading the rest.
    pub fn head(bytes: &[u8]) -> (Option<Id>, Option<String>) {
        match str::from_utf8(bytes).map(serde_json::from_str::<Object<Head>>) {
            Ok(Ok(Object(head))) => (head.id, head.r#type),
            _ => (None, None),
        }
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
