//! The Fast Robot Interface (FRI) of the KUKA LBR iiwa: messages, their bytes, and the sessions of
//! both sides.
//!
//! All of it is bytes in, bytes and events out: there is no socket, no thread and no clock. The
//! controller speaks first, once a cycle; the client answers every so many messages of it, as the
//! messages themselves say.
//!
//! ```
//! use std::time::Duration;
//!
//! use iiwa_fri::{Client, Controller, ControllerConfig, Reading, SessionState};
//!
//! let mut controller = Controller::new(ControllerConfig::default());
//! let mut client = Client::default();
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

mod client;
mod controller;
mod error;
mod message;
mod v1;
mod wire;

pub use client::{Client, Counters, Received};
pub use controller::{AnswerCounters, Controller, ControllerConfig, Reading};
pub use error::WireError;
pub use message::{
    Command, CommandMode, ControlMode, Drive, Monitoring, OperationMode, Overlay, Quality, Safety,
    SessionState,
};
pub use wire::{Format, MAX_DATAGRAM_BYTES};

/// How far a 32-bit counter that wraps around is ahead of an earlier count; negative when behind.
#[must_use]
pub fn ahead(counter: u32, of: u32) -> i32 {
    counter.wrapping_sub(of).cast_signed()
}
