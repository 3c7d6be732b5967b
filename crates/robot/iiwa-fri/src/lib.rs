//! The Fast Robot Interface (FRI) of the KUKA LBR iiwa: messages, their encoding, and the sessions
//! of both sides.
//!
//! The crate is sans I/O: bytes in, bytes and events out, without sockets, threads and clocks. The
//! controller sends one monitoring message per cycle. The client answers every n-th message with a
//! command message, where n is the receive multiplier in the monitoring message.
//!
//! Joint values are `[f64; 7]`, A1 to A7, in rad and Nm.
//!
//! ```
//! use std::time::Duration;
//!
//! use iiwa_fri::{Controller, ControllerConfig, FriClient, Reading, SessionState};
//!
//! let mut controller = Controller::new(ControllerConfig::default());
//! let mut client = FriClient::default();
//! let (mut message, mut answer) = (Vec::new(), Vec::new());
//! for cycle in 0..60 {
//!     let reading = Reading { time: Duration::from_millis(5 * cycle), ..Reading::default() };
//!     if controller.tick(&reading, &mut message) {
//!         client.receive(&message)?;
//!     }
//!     if client.answer(None, &mut answer) {
//!         controller.receive(&answer)?;
//!     }
//! }
//! assert_eq!(controller.state(), SessionState::MonitoringReady);
//! assert_eq!(client.counters().answered, 60);
//! # Ok::<(), iiwa_fri::WireError>(())
//! ```

pub mod braking;
mod client;
mod controller;
mod counter;
mod error;
mod message;
mod v1;
mod wire;

pub use client::{Counters, FriClient, Received};
pub use controller::{AnswerCounters, Controller, ControllerConfig, Reading};
pub use counter::ahead;
pub use error::WireError;
pub use message::{
    Command, CommandMode, ControlMode, Drive, MAX_DATAGRAM_BYTES, Monitoring, OperationMode,
    Overlay, Quality, Safety, SessionState,
};
pub use wire::Format;
