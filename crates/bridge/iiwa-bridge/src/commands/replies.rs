//! Command replies.

use iiwa_link::message::{Refusal, Reply};
use serde::Serialize;
use serde_json::{Map, Value};

use crate::message::{Timestamp, VERSION};

/// Callback that sends a reply.
pub type Answer = Box<dyn FnOnce(CommandReply) + Send>;

/// Reply to a command, as sent to brokers.
#[derive(Clone, Debug, Serialize)]
pub struct CommandReply {
    version: u32,
    kind: &'static str,
    /// The robot, if named by the command.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// Id of the command, if given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub id: Option<String>,
    at: Timestamp,
    /// The drive's reply, without the samples of a run, which the `joints` messages contain.
    reply: Map<String, Value>,
}

impl CommandReply {
    /// Creates a refusal by the bridge.
    pub(super) fn refused(robot: Option<String>, id: Option<String>, refusal: &Refusal) -> Self {
        let reply = Reply { error: Some(refusal), ..Reply::default() }.to_json();
        Self::new(robot, id, reply.as_bytes())
    }

    /// Creates the reply from a reply of the drive.
    pub(super) fn new(robot: Option<String>, id: Option<String>, reply: &[u8]) -> Self {
        let mut reply: Map<String, Value> = serde_json::from_slice(reply).unwrap_or_default();
        reply.remove("samples");
        Self { version: VERSION, kind: "reply", robot, id, at: Timestamp::now(), reply }
    }

    /// Returns true if the command was carried out.
    #[must_use]
    pub fn is_ok(&self) -> bool {
        self.reply.get("ok") == Some(&Value::Bool(true))
    }

    /// Returns the reply as JSON.
    #[must_use]
    pub fn to_json(&self) -> String {
        iiwa_link::message::to_json(self)
    }
}
