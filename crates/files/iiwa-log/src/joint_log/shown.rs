//! Pieces of a file in messages.

use iiwa_json::excerpt;

/// Longest name of a column that a message may repeat, in bytes.
pub(super) const MAX_NAME: usize = 160;

/// The beginning of a piece of a file, without characters that a terminal would obey.
pub(super) fn shown(bytes: &[u8]) -> String {
    // More than an excerpt has, whatever the characters are.
    let start = &bytes[..bytes.len().min(1024)];
    excerpt(&String::from_utf8_lossy(start))
}
