//! Passes what robots do to brokers, and requests back: one client of any number of drives, one schema of messages.
//!
//! ```text
//! drives --stream, requests--> Feed --Message--> Sink (Kafka, MQTT, Sparkplug)
//!                                                  |
//!        <----- CommandGate <------ requests -----+   only if commands are allowed
//! ```
//!
//! A [`Feed`](feed::Feed) follows a robot and numbers what it sees as [`Message`]s. A [`Sink`] takes each of them without
//! waiting: those of brokers write it to a [`Spool`](spool::Spool), a bounded queue on disk, from which it is sent once the
//! broker can be reached. Messages arrive at least once and in order; consumers tell repetitions by `session` and `seq`.
//!
//! Requests pass a [`CommandGate`](commands::CommandGate), which refuses what is malformed, too old or repeated, and then the
//! drive's own checks, as those of any client.
//!
//! Nothing listens: the bridge opens connections to drives and brokers, and no ports.

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

/// The runtime of a thread that speaks with a broker.
#[cfg(feature = "tls")]
fn runtime() -> Result<tokio::runtime::Runtime, BridgeError> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    runtime.map_err(|source| BridgeError::Runtime { source })
}
