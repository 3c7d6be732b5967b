//! The link from outside: messages, keys, and trajectories of clients.

mod motions;
mod security_keys;
mod timed_joints;
