//! Replies to commands.

use iiwa_link::message::{Refusal, Reply};
use serde::Serialize;
use serde_json::{Map, Value};

use crate::message::{Timestamp, VERSION};

/// How a reply leaves.
pub type Answer = Box<dyn FnOnce(CommandReply) + Send>;

/// The reply to a command, as brokers get it.
#[derive(Clone, Debug, Serialize)]
pub struct CommandReply {
    version: u32,
    kind: &'static str,
    /// The robot, if the command named one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// The id of the command, if it had one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub id: Option<String>,
    at: Timestamp,
    /// The drive's reply, without the samples of a run: they are in the messages of `joints`.
    reply: Map<String, Value>,
}

impl CommandReply {
    /// A refusal by the bridge.
    pub(super) fn refused(robot: Option<String>, id: Option<String>, refusal: &Refusal) -> Self {
        let reply = Reply { error: Some(refusal), ..Reply::default() }.to_json();
        Self::new(robot, id, reply.as_bytes())
    }

    /// A reply of the drive.
    pub(super) fn new(robot: Option<String>, id: Option<String>, reply: &[u8]) -> Self {
        let mut reply: Map<String, Value> = serde_json::from_slice(reply).unwrap_or_default();
        reply.remove("samples");
        Self { version: VERSION, kind: "reply", robot, id, at: Timestamp::now(), reply }
    }

    /// Whether the command was carried out.
    #[must_use]
    pub fn is_ok(&self) -> bool {
        self.reply.get("ok") == Some(&Value::Bool(true))
    }

    /// The reply as JSON.
    #[must_use]
    pub fn to_json(&self) -> String {
        iiwa_link::message::to_json(self)
    }
}
