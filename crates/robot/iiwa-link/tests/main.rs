//! Integration tests of the link: messages, keys, and client trajectories.

mod motions;
mod security_keys;
mod timed_joints;
