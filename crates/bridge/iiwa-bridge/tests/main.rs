//! Integration tests of the bridge: messages, spool, and a robot that accepts commands.

mod messages;
#[cfg(feature = "mqtt")]
mod mqtt;
mod robot;
mod sample_messages;
mod spool;
