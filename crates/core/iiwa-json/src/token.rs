//! Tokens of a text, valid JSON or not.

use std::ops::Range;

/// Token that contains `byte`, otherwise the next token.
pub(crate) fn token_at(text: &str, byte: usize) -> Option<Range<usize>> {
    JsonTokens { text, at: 0 }.find(|token| token.end > byte)
}

/// Tokens of a text, valid JSON or not: strings, single punctuation marks, other words.
pub(crate) struct JsonTokens<'a> {
    pub(crate) text: &'a str,
    pub(crate) at: usize,
}

impl Iterator for JsonTokens<'_> {
    type Item = Range<usize>;

    fn next(&mut self) -> Option<Self::Item> {
        let bytes = self.text.as_bytes();
        let start = self.at + bytes[self.at..].iter().position(|b| !b.is_ascii_whitespace())?;
        let rest = &bytes[start..];
        let length = match rest[0] {
            b'"' => {
                let mut escaped = false;
                let end = rest[1..].iter().position(|&b| {
                    let ends = b == b'"' && !escaped;
                    escaped = b == b'\\' && !escaped;
                    ends
                });
                end.map_or(rest.len(), |end| end + 2)
            }
            b if PUNCTUATION.contains(&b) => 1,
            _ => rest
                .iter()
                .position(|b| b.is_ascii_whitespace() || *b == b'"' || PUNCTUATION.contains(b))
                .unwrap_or(rest.len()),
        };
        self.at = start + length;
        Some(start..self.at)
    }
}

const PUNCTUATION: &[u8] = b"[]{}:,";
