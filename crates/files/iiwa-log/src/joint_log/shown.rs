//! Excerpts of a file in messages.

use iiwa_json::excerpt;

/// Longest column name that a message repeats, in bytes.
pub(super) const MAX_NAME: usize = 160;

/// Returns the beginning of a part of a file, without terminal control characters.
pub(super) fn shown(bytes: &[u8]) -> String {
    // More bytes than an excerpt has, for any characters.
    let start = &bytes[..bytes.len().min(1024)];
    excerpt(&String::from_utf8_lossy(start))
}
