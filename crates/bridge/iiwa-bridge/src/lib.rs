//! Bridge between robots and message brokers: publishes robot data and forwards requests. It is a
//! client of any number of drives, with one message schema.
//!
//! ```text
//! drives --stream, requests--> Feed --Message--> Sink (Kafka, MQTT, Sparkplug)
//!                                                  |
//!        <----- CommandGate <------ requests -----+   only if commands are allowed
//! ```
//!
//! A [`Feed`](feed::Feed) observes a robot and numbers its data as [`Message`]s. A [`Sink`] accepts
//! each message without blocking: broker sinks write it to a [`Spool`](spool::Spool), a bounded
//! queue on disk, and send it once the broker is reachable. Messages arrive at least once and in
//! order; consumers detect duplicates by `session` and `seq`.
//!
//! Requests pass a [`CommandGate`](commands::CommandGate), which refuses malformed, expired or
//! repeated requests, and then the same drive checks as requests of any client.
//!
//! The bridge opens connections to drives and brokers. It does not listen on any port.

pub mod bridge;
pub mod commands;
mod credentials;
pub mod encoding;
mod error;
pub mod feed;
pub mod history;
#[cfg(feature = "kafka")]
pub mod kafka;
pub mod message;
#[cfg(feature = "mqtt")]
pub mod mqtt;
pub mod replay;
pub mod robot;
pub mod sink;
pub mod spool;
#[cfg(feature = "tls")]
mod spooling;
#[cfg(feature = "tls")]
pub mod tls;
mod trouble;

pub use bridge::{Bridge, BridgeOptions, default_spool};
#[cfg(feature = "tls")]
pub use credentials::BrokerAccess;
pub use credentials::Credentials;
pub use error::BridgeError;
pub use message::{Content, Kind, Message, Timestamp};
pub use robot::BridgedRobot;
pub use sink::Sink;

/// Creates the runtime of a thread that communicates with a broker.
#[cfg(feature = "tls")]
fn runtime() -> Result<tokio::runtime::Runtime, BridgeError> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    runtime.map_err(|source| BridgeError::Runtime { source })
}
