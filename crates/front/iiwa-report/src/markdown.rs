//! Text of programs in Markdown and in HTML.

use std::fmt::Write as _;

/// Escapes the characters that Markdown, its tables, forges and HTML would interpret.
pub(crate) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            // Forges read formulas, mentions and issue numbers even in words.
            '$' | '@' | '#' => _ = write!(escaped, "&#{};", u32::from(character)),
            // A colon before a word begins an emoji, or belongs to a link.
            ':' if characters.peek().is_some_and(|next| *next == '/' || next.is_alphabetic()) => {
                escaped.push_str("&#58;");
            }
            '\\' | '`' | '*' | '_' | '|' | '[' | ']' | '~' => escaped.extend(['\\', character]),
            _ => escaped.push(character),
        }
    }
    escaped
}

/// Escapes the characters that HTML would interpret: an HTML element in Markdown keeps a backslash.
pub(crate) fn html_escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_shown_as_they_are() {
        assert_eq!(
            escaped("`a`|*b*_c_<d>&[e]~f~\\"),
            "\\`a\\`\\|\\*b\\*\\_c\\_&lt;d>&amp;\\[e\\]\\~f\\~\\\\"
        );
        assert_eq!(escaped("$x$ @a #1 :b:"), "&#36;x&#36; &#64;a &#35;1 &#58;b:");
        assert_eq!(html_escaped("a_b <c> & d"), "a_b &lt;c> &amp; d");
    }
}
