//! Text of others in messages.

/// The beginning of somebody's text as a message repeats it: not too long, and without what would do
/// something to a terminal.
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

/// Longest piece of somebody's text that a message repeats, in characters.
const MAX_SHOWN: usize = 60;
