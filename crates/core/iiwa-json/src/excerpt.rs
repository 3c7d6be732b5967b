//! Excerpts of untrusted text in messages.

/// The beginning of an untrusted text for a message: shortened, with control characters escaped so
/// that it cannot control a terminal.
#[must_use]
pub fn excerpt(text: &str) -> String {
    let mut shown = String::with_capacity(text.len().min(4 * MAX_SHOWN));
    for (count, letter) in text.chars().enumerate() {
        if count == MAX_SHOWN {
            shown.push_str("...");
            break;
        }
        if letter.is_control() {
            shown.extend(letter.escape_default());
        } else {
            shown.push(letter);
        }
    }
    shown
}

/// Longest excerpt, in characters.
const MAX_SHOWN: usize = 60;
