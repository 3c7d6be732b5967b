//! The dispatcher of a drive, sans I/O: requests, acknowledgements, state changes and FRI events go in;
//! replies, instructions and FRI commands come out.
//!
//! Nothing here takes long, so that a stop is served at once: long requests are parsed and checked by
//! another thread ([`checks`](super::checks)), and long replies are written by another one
//! ([`run_replies`](super::run_replies)).
//!
//! A run passes these stages. A stop, or the loss of its client, withdraws it before the last stage; a stop
//! in the last stage brings the arm to rest:
//!
//! | stage | ends when |
//! |---|---|
//! | checking | the request is parsed and checked against the robot |
//! | planning | the robot program has planned its motions |
//! | beginning | the robot program has acknowledged that it begins |
//! | begun | the robot program reports its end |

mod progress;
mod requests;
mod state;
mod stop;
#[cfg(test)]
mod tests;

pub(super) use state::{Dispatcher, IncomingRequest, Output};
