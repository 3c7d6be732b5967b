//! Messages of the protocol `foxglove.sdk.v1`, limited to the needs of read-only viewers.

use serde::{Deserialize, Serialize};

/// Protocol name in the handshake.
pub(super) const PROTOCOL: &str = "foxglove.sdk.v1";

/// First byte of a message on a topic.
const MESSAGE_DATA: u8 = 1;

/// A topic that viewers may subscribe to.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Channel {
    pub(super) id: u64,
    pub(super) topic: String,
    pub(super) encoding: &'static str,
    pub(super) schema_name: String,
    pub(super) schema: String,
    pub(super) schema_encoding: &'static str,
}

/// Text message of the server.
#[derive(Debug, Serialize)]
#[serde(tag = "op", rename_all = "camelCase")]
pub(super) enum ServerMessage<'a> {
    /// The first message; `capabilities` lists the permitted operations of viewers.
    ServerInfo {
        name: &'a str,
        capabilities: [&'a str; 0],
    },
    Advertise {
        channels: &'a [Channel],
    },
    Status {
        level: StatusLevel,
        message: &'a str,
    },
}

impl ServerMessage<'_> {
    pub(super) fn text(&self) -> String {
        // Serialising strings and numbers does not fail.
        serde_json::to_string(self).unwrap_or_default()
    }
}

/// Severity of a status message.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(into = "u8")]
pub(super) enum StatusLevel {
    Warning,
    Error,
}

impl From<StatusLevel> for u8 {
    fn from(level: StatusLevel) -> Self {
        match level {
            StatusLevel::Warning => 1,
            StatusLevel::Error => 2,
        }
    }
}

/// Viewer request.
#[derive(Debug, Deserialize)]
#[serde(tag = "op", rename_all = "camelCase")]
pub(super) enum ViewerMessage {
    Subscribe {
        subscriptions: Vec<Subscription>,
    },
    #[serde(rename_all = "camelCase")]
    Unsubscribe {
        subscription_ids: Vec<u32>,
    },
    /// A request that requires more rights.
    #[serde(other)]
    Other,
}

/// Subscription id by which a viewer identifies the messages of a channel.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Subscription {
    pub(super) id: u32,
    pub(super) channel_id: u64,
}

/// Encodes a message on a topic, for this subscription.
pub(super) fn message_data(subscription: u32, time_ns: u64, data: &[u8]) -> Vec<u8> {
    let mut message = Vec::with_capacity(13 + data.len());
    message.push(MESSAGE_DATA);
    message.extend_from_slice(&subscription.to_le_bytes());
    message.extend_from_slice(&time_ns.to_le_bytes());
    message.extend_from_slice(data);
    message
}
