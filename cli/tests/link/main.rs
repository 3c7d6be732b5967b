//! `iiwasim drive`, `cabinet` and the commands that speak to them, as processes.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

mod commands;
mod faults;
mod keys;
mod rig;
