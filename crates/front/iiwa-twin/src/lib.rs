//! Twin: a page that shows a KUKA LBR iiwa live beside its plan, and runs programs on it.
//!
//! One thread follows the drive's stream of joint positions, one polls the state of the drive and
//! the robot. The dispatcher carries out the requests of pages, and holds saved positions, the plan
//! and the run. Each of them publishes its state as JSON; only the latest message of a kind is
//! kept, so that a slow page skips messages and no queue grows.
//!
//! The server bounds the number of connections, admits requests with the token, and exchanges
//! messages and requests with pages. Stops use a separate connection to the drive. Viewers receive
//! the same data on request ([`iiwa_foxglove`]).
//!
//! A program creates a [`Setup`], a [`Twin`] from it, and passes a socket to the twin. The program
//! defines the error texts on pages ([`Wording`]). The module [`runs`] runs and records a task
//! through a drive, also for other clients of a drive.

mod connections;
pub mod diagnostics;
mod dispatcher;
mod error;
mod follow;
mod guard;
mod health;
mod jog;
mod message;
mod page_socket;
mod planned;
mod positions;
mod request;
mod run;
pub mod run_parts;
pub mod runs;
mod sampled;
mod server;
mod setup;
mod shared;
mod stop;
mod twin;
mod wording;

pub use error::TwinError;
pub use setup::{Setup, TwinOptions};
pub use twin::Twin;
pub use wording::Wording;
