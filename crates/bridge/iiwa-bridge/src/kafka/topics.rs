//! Topic names.

/// Returns the topic of a message kind.
pub(super) fn topic(prefix: &str, name: &str) -> String {
    format!("{prefix}.{name}")
}
