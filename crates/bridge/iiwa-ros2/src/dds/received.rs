//! What comes from ROS.

/// A request or a message, if one has come.
pub(crate) fn received<T, E: std::fmt::Display>(read: Result<Option<T>, E>) -> Option<T> {
    read.unwrap_or_else(|error| {
        tracing::warn!("a message of ROS that cannot be read was passed over: {error}");
        None
    })
}
