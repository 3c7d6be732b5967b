//! Command envelope.

use iiwa_json::JsonObject;
use iiwa_link::message::{Refusal, Request, bad_json};
use serde::Deserialize;
use serde_json::value::RawValue;

use crate::message::{Timestamp, VERSION};

/// Maximum length of an id, in bytes.
const MAX_ID_BYTES: usize = 200;

/// A command as received.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Envelope {
    #[serde(default)]
    version: Option<u32>,
    /// The addressed robot.
    #[serde(default)]
    pub(super) robot: Option<String>,
    /// Unique id of the command.
    #[serde(default)]
    pub(super) id: Option<String>,
    #[serde(default)]
    at: Option<Timestamp>,
    #[serde(default)]
    request: Option<Box<RawValue>>,
}

impl Envelope {
    /// Parses the envelope. The error contains id and robot of a malformed envelope, if readable.
    pub(super) fn read(body: &[u8]) -> Result<Self, (Self, Refusal)> {
        let Ok(text) = str::from_utf8(body) else {
            let reason = "the command is not text in UTF-8";
            return Err((Self::default(), Refusal::bad(reason)));
        };
        let mut envelope = match serde_json::from_str::<JsonObject<Self>>(text) {
            Ok(JsonObject(envelope)) => envelope,
            Err(error) => return Err((Self::named(text), bad_json(text, &error))),
        };
        if envelope.id.as_ref().is_some_and(|id| id.is_empty() || id.len() > MAX_ID_BYTES) {
            envelope.id = None;
            let reason = format!("`id` has to have 1 to {MAX_ID_BYTES} bytes");
            return Err((envelope, Refusal::bad(reason)));
        }
        if envelope.robot.as_ref().is_some_and(|robot| robot.len() > MAX_ID_BYTES) {
            envelope.robot = None;
            return Err((envelope, Refusal::bad("`robot` is longer than a name")));
        }
        let version = envelope.version;
        if version != Some(VERSION) {
            let reason = format!("`version` has to be {VERSION}");
            return Err((envelope, Refusal::bad(reason)));
        }
        Ok(envelope)
    }

    /// Returns id and robot of a malformed envelope, if readable.
    fn named(text: &str) -> Self {
        #[derive(Deserialize)]
        struct EnvelopeNames {
            robot: Option<String>,
            id: Option<String>,
        }
        let names = serde_json::from_str::<EnvelopeNames>(text).ok();
        let (robot, id) = names.map(|names| (names.robot, names.id)).unwrap_or_default();
        let short = |name: &String| name.len() <= MAX_ID_BYTES;
        Self { robot: robot.filter(short), id: id.filter(short), ..Self::default() }
    }

    /// Returns the id and the time of sending.
    pub(super) fn identity(&self) -> Result<(&str, Timestamp), Refusal> {
        let lacks = |key| Refusal::bad(format!("the command has no `{key}`"));
        let id = self.id.as_deref().ok_or_else(|| lacks("id"))?;
        Ok((id, self.at.ok_or_else(|| lacks("at"))?))
    }

    /// Returns the request to the drive.
    pub(super) fn request(&self) -> Result<Request, Refusal> {
        let lacks = || Refusal::bad("the command has no `request`");
        let text = self.request.as_ref().ok_or_else(lacks)?.get();
        let (id, request) = Request::from_json(text.as_bytes());
        if id.is_some() {
            return Err(Refusal::bad("`id` belongs to the command, not to its request"));
        }
        request.map_err(|mut refusal| {
            refusal.message = format!("in `request`: {}", refusal.message);
            refusal
        })
    }
}
