//! The dispatcher of a drive, sans I/O. Inputs: requests, acknowledgements, state changes and FRI
//! events. Outputs: replies, instructions and FRI commands.
//!
//! All operations are short, so that a stop is served immediately: one thread
//! ([`checks`](super::checks)) parses and checks long requests, another one
//! ([`run_replies`](super::run_replies)) writes long replies.
//!
//! A run passes these stages. A stop, or the loss of its client, withdraws the run before the last
//! stage; a stop in the last stage brings the robot to rest:
//!
//! | stage | ends when |
//! |---|---|
//! | checking | the request is parsed and checked against the robot |
//! | planning | the robot program has planned its motions |
//! | beginning | the robot program has acknowledged the start |
//! | begun | the robot program reports the end |

mod progress;
mod requests;
mod state;
mod stop;
#[cfg(test)]
mod tests;

pub(super) use state::{Dispatcher, DispatcherOutput, IncomingRequest};
