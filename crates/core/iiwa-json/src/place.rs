//! Places in a text.

use std::{fmt, ops::Range};

use serde_json::error::Category;

use crate::token::{JsonTokens, token_at};

/// A place in a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JsonPlace {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Byte range in the text, counted from behind its byte order mark if the text begins with one:
    /// a range of [`without_mark`](crate::without_mark).
    pub span: Range<usize>,
}

impl fmt::Display for JsonPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}", self.line, self.column)
    }
}

impl JsonPlace {
    /// Removes the suffix `, at` with this place from a message.
    #[must_use]
    pub fn cut_from(&self, message: &str) -> String {
        message.strip_suffix(&format!(", at {self}")).unwrap_or(message).to_owned()
    }

    /// Place of the bytes `span` of `text`; a span beyond the end is moved to the end.
    #[must_use]
    pub fn of_span(text: &str, span: Range<usize>) -> Self {
        let floor = |byte: usize| {
            let byte = byte.min(text.len());
            (0..=byte).rev().find(|&b| text.is_char_boundary(b)).unwrap_or(0)
        };
        let (start, end) = (floor(span.start), floor(span.end));
        let before = &text[..start];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        Self {
            line: before.bytes().filter(|&b| b == b'\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
            span: start..end.max(start),
        }
    }

    /// Place of `error`, which occurred while reading `part`, a slice of `text`.
    ///
    /// The place is the wrong word from its first letter on, the opening bracket of an object or a
    /// list, or the end of a text that ends too early.
    #[must_use]
    pub fn of_error(text: &str, part: &str, error: &serde_json::Error) -> Self {
        let line_start: usize =
            part.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
        // serde_json reports the number of bytes read in the line.
        let read = (line_start + error.column()).min(part.len());
        let span = match error.classify() {
            Category::Eof | Category::Io => {
                let end = part.trim_end().len();
                end..end
            }
            Category::Syntax => {
                // A word such as `tru` is only found to be wrong at the character after it.
                let behind = if error.to_string().starts_with("expected ident") { 2 } else { 1 };
                let offset = read.saturating_sub(behind);
                match token_at(part, offset) {
                    // Within a string, a single character is wrong.
                    Some(token) if !part[token.clone()].starts_with('"') => token,
                    _ => offset..read,
                }
            }
            Category::Data => wrong_value(part, read),
        };
        let base = offset_in(text, part).unwrap_or(0);
        Self::of_span(text, base + span.start..base + span.end)
    }
}

/// Byte range of the wrong value, from the number of bytes of `part` read when the error was
/// detected.
fn wrong_value(part: &str, read: usize) -> Range<usize> {
    let last = part.as_bytes()[..read].last();
    // Lists and objects are rejected before their first bracket is read.
    if last.is_none_or(|byte| byte.is_ascii_whitespace() || b":,[".contains(byte)) {
        return token_at(part, read).unwrap_or(read..read);
    }
    match token_at(part, read - 1) {
        Some(token) if matches!(&part[token.clone()], "]" | "}") => opening(part, token),
        Some(token) => token,
        None => read - 1..read,
    }
}

/// Byte range of the bracket that `closing` closes.
fn opening(part: &str, closing: Range<usize>) -> Range<usize> {
    // Brackets with their depths. Two passes over the text avoid a stack, which would be long for a
    // text of brackets.
    let brackets = || {
        let mut depth = 0_usize;
        JsonTokens { text: part, at: 0 }
            .take_while(|token| token.start <= closing.start)
            .filter_map(move |token| match &part[token.clone()] {
                "[" | "{" => {
                    depth += 1;
                    Some((token, depth, true))
                }
                "]" | "}" => {
                    depth = depth.saturating_sub(1);
                    Some((token, depth + 1, false))
                }
                _ => None,
            })
    };
    let depth = brackets().last().map(|(_, depth, _)| depth);
    brackets()
        .filter(|(_, other, opens)| *opens && Some(*other) == depth)
        .last()
        .map_or(closing.clone(), |(token, ..)| token)
}

/// Offset of `part` in `text`, if `part` is a slice of it.
pub(crate) fn offset_in(text: &str, part: &str) -> Option<usize> {
    let offset = part.as_ptr().addr().checked_sub(text.as_ptr().addr())?;
    (offset + part.len() <= text.len()).then_some(offset)
}
