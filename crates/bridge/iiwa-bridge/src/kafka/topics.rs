//! Names of topics.

/// The topic of a kind of message.
pub(super) fn topic(prefix: &str, name: &str) -> String {
    format!("{prefix}.{name}")
}
