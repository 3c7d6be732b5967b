//! Places in a JSON text, so that an error can show where.

use std::{collections::BTreeMap, fmt, ops::Range};

use serde_json::value::RawValue;

/// A place in a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Bytes of the text.
    pub span: Range<usize>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}", self.line, self.column)
    }
}

impl Place {
    /// The place of the bytes `span` of `text`; a span past the end is moved to the end.
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

    /// Where `error` struck when `part`, a slice of `text`, was read.
    #[must_use]
    pub fn of_error(text: &str, part: &str, error: &serde_json::Error) -> Self {
        let base = offset_in(text, part).unwrap_or(0);
        let line_start: usize =
            part.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
        // serde_json counts bytes and points at, or just behind, the last byte it read.
        let at = base + line_start + error.column().saturating_sub(1);
        Self::of_span(text, at..at + 1)
    }
}

/// One step down into a JSON text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step<'a> {
    /// Into the value of an object's key.
    Key(&'a str),
    /// Into the element of an array, from 0.
    Index(usize),
}

/// The place of the value that `path` leads to, or of the last value on the way that is there.
///
/// Reads the text again from the start: it is meant for error messages, not for hot paths.
#[must_use]
pub fn locate(text: &str, path: &[Step<'_>]) -> Place {
    let mut part = text.trim();
    for step in path {
        let next = match step {
            Step::Key(key) => serde_json::from_str::<BTreeMap<String, &RawValue>>(part)
                .ok()
                .and_then(|object| object.get(*key).map(|value| value.get())),
            Step::Index(index) => serde_json::from_str::<Vec<&RawValue>>(part)
                .ok()
                .and_then(|array| array.get(*index).map(|value| value.get())),
        };
        match next {
            Some(value) => part = value,
            None => break,
        }
    }
    let start = offset_in(text, part).unwrap_or(0);
    Place::of_span(text, start..start + part.len())
}

/// Offset of `part` in `text`, when it is a slice of it.
fn offset_in(text: &str, part: &str) -> Option<usize> {
    let offset = part.as_ptr().addr().checked_sub(text.as_ptr().addr())?;
    (offset + part.len() <= text.len()).then_some(offset)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "{\n  \"motions\": [\n    { \"joints_deg\": [1, \"ü\", 30] }\n  ]\n}";

    #[test]
    fn finds_a_value() {
        use Step::{Index, Key};
        let place = locate(TEXT, &[Key("motions"), Index(0), Key("joints_deg"), Index(2)]);
        assert_eq!((place.line, place.column, &TEXT[place.span]), (3, 30, "30"));
    }

    #[test]
    fn stays_at_the_last_value_that_is_there() {
        let place = locate(TEXT, &[Step::Key("motions"), Step::Index(7), Step::Key("blend")]);
        assert_eq!((place.line, place.column), (2, 14));
    }

    #[test]
    fn places_an_error_of_a_part() {
        let part = &TEXT[TEXT.find("[1").unwrap()..TEXT.find(" }\n").unwrap()];
        let error = serde_json::from_str::<Vec<f64>>(part).unwrap_err();
        let place = Place::of_error(TEXT, part, &error);
        assert_eq!((place.line, place.column), (3, 27), "{error}");
    }

    #[test]
    fn survives_a_text_that_ends_early() {
        let text = "{\n";
        let error = serde_json::from_str::<BTreeMap<String, f64>>(text).unwrap_err();
        assert_eq!(Place::of_error(text, text, &error).span, 2..2);
    }
}
