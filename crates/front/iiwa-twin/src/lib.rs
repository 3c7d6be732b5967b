//! The twin: a page that shows a KUKA LBR iiwa live beside its plan, and runs programs on it.
//!
//! One thread follows the drive's stream of joint positions, one polls the state of the drive and the robot.
//! The dispatcher carries out the requests of pages, and holds saved positions, the plan and the run. Each of
//! them publishes its state as JSON; only the latest message of a kind is kept, so that a slow page skips
//! messages and no queue grows.
//!
//! The server bounds the number of connections, admits those that have the token, and exchanges messages and
//! requests with pages. A stop has a connection to the drive of its own. The same data is published to
//! viewers on request ([`iiwa_foxglove`]).
//!
//! A program makes a [`Setup`] and a [`Twin`] of it, and gives that a socket. What pages show of errors is in the
//! program's own words ([`Wording`]). How a task is run through a drive and recorded is in [`runs`], which serves
//! other clients of a drive as well.

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
