//! A twin of the robot: what it does, while it does it.

pub(crate) mod foxglove;
