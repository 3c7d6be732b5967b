//! Text for messages: untrusted text that cannot control a terminal, and a count of further errors.

/// The beginning of an untrusted text for a message: shortened, with control characters escaped so
/// that it cannot control a terminal.
#[must_use]
pub fn excerpt(text: &str) -> String {
    match text.char_indices().nth(MAX_SHOWN) {
        Some((end, _)) => printable(&text[..end]) + "...",
        None => printable(text),
    }
}

/// Longest excerpt, in characters.
const MAX_SHOWN: usize = 60;

/// Escapes control characters, which a terminal would execute.
#[must_use]
pub fn printable(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() {
            shown.extend(c.escape_default());
        } else {
            shown.push(c);
        }
    }
    shown
}

/// Suffix of a message that names the first of several errors: the number of the others.
///
/// ```
/// assert_eq!(iiwa_json::further_errors(0), "");
/// assert_eq!(iiwa_json::further_errors(1), "; and one more error");
/// assert_eq!(iiwa_json::further_errors(2), "; and 2 more errors");
/// ```
#[must_use]
pub fn further_errors(count: usize) -> String {
    match count {
        0 => String::new(),
        1 => "; and one more error".to_owned(),
        count => format!("; and {count} more errors"),
    }
}
