//! Byte order marks.

/// Byte order mark of UTF-8.
const UTF_8_MARK: &[u8] = b"\xef\xbb\xbf";

/// Message for a text that [`is_utf16`].
pub const UTF_16: &str = "text in UTF-16: save it as UTF-8";

/// Returns true if a text begins with a byte order mark of UTF-16.
#[must_use]
pub fn is_utf16(text: &[u8]) -> bool {
    text.starts_with(b"\xff\xfe") || text.starts_with(b"\xfe\xff")
}

/// Returns a text without the byte order mark with which some editors begin files.
#[must_use]
pub fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// Returns a text that may not be UTF-8 without its byte order mark of UTF-8.
#[must_use]
pub fn bytes_without_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(UTF_8_MARK).unwrap_or(text)
}
