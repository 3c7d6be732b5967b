//! Reception of ROS messages.

/// Returns a received request or message, if any. Decoding errors are logged.
pub(crate) fn received<T, E: std::fmt::Display>(read: Result<Option<T>, E>) -> Option<T> {
    read.unwrap_or_else(|error| {
        tracing::warn!("a message of ROS that cannot be read was passed over: {error}");
        None
    })
}
