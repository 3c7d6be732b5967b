//! Reading JSON that people write: places in the text, and errors that say what to change.

use std::{collections::BTreeMap, fmt, marker::PhantomData, ops::Range};

use serde::{
    Deserialize, Deserializer,
    de::{MapAccess, Visitor, value::MapAccessDeserializer},
};
use serde_json::{error::Category, value::RawValue};

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
    ///
    /// The word that is wrong, from its first letter on; of an object or a list the bracket that
    /// opens it; where the text ends too early, its end.
    #[must_use]
    pub fn of_error(text: &str, part: &str, error: &serde_json::Error) -> Self {
        let line_start: usize =
            part.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
        // serde_json counts the bytes of the line that it has read.
        let read = (line_start + error.column()).min(part.len());
        let span = match error.classify() {
            Category::Eof | Category::Io => {
                let end = part.trim_end().len();
                end..end
            }
            Category::Syntax => {
                // A word like `tru` is found wrong at what follows it.
                let behind = if error.to_string().starts_with("expected ident") { 2 } else { 1 };
                let at = read.saturating_sub(behind);
                match token_at(part, at) {
                    // Within a string it is one character that is wrong.
                    Some(token) if !part[token.clone()].starts_with('"') => token,
                    _ => at..read,
                }
            }
            Category::Data => wrong_value(part, read),
        };
        let base = offset_in(text, part).unwrap_or(0);
        Self::of_span(text, base + span.start..base + span.end)
    }
}

/// What `error` says, in words for whoever wrote the JSON, and without the place.
#[must_use]
pub fn problem(error: &serde_json::Error) -> String {
    let message = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    let message = message.strip_suffix(&place).unwrap_or(&message);
    if error.is_eof() {
        return "the text ends too early".to_owned();
    }
    for (start, said) in [
        ("invalid type: ", ""),
        ("invalid value: ", ""),
        ("invalid length ", ""),
        ("unknown field ", "unknown key "),
        ("unknown variant ", "unknown value "),
    ] {
        let Some((found, expected)) =
            message.strip_prefix(start).and_then(|rest| rest.rsplit_once(", expected "))
        else {
            continue;
        };
        if said.is_empty() {
            let expected = match expected {
                "f64" => "a number",
                "u64" => "a whole number, 0 or more",
                "a sequence" => "a list",
                other => other,
            };
            return format!("expected {expected}, found {}", shown(found));
        }
        return format!("{said}{}, expected {expected}", shown(found));
    }
    let key = |start: &str| message.strip_prefix(start);
    if let Some(key) = key("missing field ") {
        return format!("the key {key} is missing");
    }
    if let Some(key) = key("duplicate field ") {
        return format!("the key {key} is there twice");
    }
    match message {
        "expected value" | "expected ident" => "this is not JSON: a value is expected",
        "number out of range" => "the number is too large",
        "trailing characters" => "there is more text after the end",
        "recursion limit exceeded" => "lists or objects are nested too deeply",
        "key must be a string" => "a key is expected, in double quotes",
        other => other,
    }
    .to_owned()
}

/// A value as serde names it, in plainer words and not too long.
fn shown(found: &str) -> String {
    let plain = match found {
        "sequence" => "a list",
        "map" => "an object",
        other => other.strip_prefix("integer ").unwrap_or(other),
    };
    let plain = plain.strip_prefix("floating point ").unwrap_or(plain);
    let plain = plain.strip_prefix("boolean ").unwrap_or(plain);
    excerpt(plain)
}

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

/// A structure that is written as a JSON object. Left to itself, serde takes a list for one too,
/// with the values in the order of the structure's fields.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Object<T>(pub T);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Object<T> {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        struct OfMap<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for OfMap<T> {
            type Value = T;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
                T::deserialize(MapAccessDeserializer::new(map))
            }
        }
        reader.deserialize_map(OfMap(PhantomData)).map(Self)
    }
}

/// Why a text of a format with versions was not read.
#[derive(Debug)]
pub enum Unread {
    /// It is of another version.
    Version {
        /// The version found.
        found: u64,
        /// Where.
        place: Place,
    },
    /// It is not JSON, or not the JSON that is asked for.
    Json(serde_json::Error),
}

/// Reads an object that has to be of a `version`, which is the value of its key `version`; `of` gets it from
/// what was read. Another version may have other keys: that is then the thing to say.
///
/// # Errors
///
/// [`Unread`].
pub fn read_version<'a, T: Deserialize<'a>>(
    text: &'a str,
    version: u64,
    of: impl FnOnce(&T) -> u64,
) -> Result<T, Unread> {
    #[derive(Deserialize)]
    struct VersionOnly {
        version: Option<u64>,
    }
    let other = |found: Option<u64>| {
        let found = found.filter(|found| *found != version)?;
        Some(Unread::Version { found, place: locate(text, &[Step::Key("version")]) })
    };
    match serde_json::from_str::<Object<T>>(text) {
        Ok(Object(read)) => other(Some(of(&read))).map_or(Ok(read), Err),
        Err(error) => {
            let only = serde_json::from_str::<Object<VersionOnly>>(text).ok();
            Err(only.and_then(|only| other(only.0.version)).unwrap_or(Unread::Json(error)))
        }
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

/// Which element, from 0, of the list under the key `list` of the outermost object `byte` is in,
/// also when the text is no JSON.
#[must_use]
pub fn element_at(text: &str, list: &str, byte: usize) -> Option<usize> {
    let (mut depth, mut index, mut in_list) = (0_usize, 0, false);
    let mut before = ["", ""];
    for token in (Tokens { text, at: 0 }).take_while(|token| token.start <= byte) {
        let word = &text[token];
        match word {
            "[" | "{" => {
                let [key, colon] = before;
                if depth == 1 {
                    let key = key.trim_matches('"');
                    (in_list, index) = (word == "[" && colon == ":" && key == list, 0);
                }
                depth += 1;
            }
            "]" | "}" => {
                depth = depth.saturating_sub(1);
                in_list &= depth > 1;
            }
            "," if depth == 2 => index += 1,
            _ => {}
        }
        before = [before[1], word];
    }
    in_list.then_some(index)
}

/// The value that is wrong, given how much of `part` had been read when that was noticed.
fn wrong_value(part: &str, read: usize) -> Range<usize> {
    let last = part.as_bytes()[..read].last();
    // Lists and objects are refused before their first bracket is read.
    if last.is_none_or(|byte| byte.is_ascii_whitespace() || b":,[".contains(byte)) {
        return token_at(part, read).unwrap_or(read..read);
    }
    match token_at(part, read - 1) {
        Some(token) if matches!(&part[token.clone()], "]" | "}") => opening(part, token),
        Some(token) => token,
        None => read - 1..read,
    }
}

/// The bracket that `closing` closes.
fn opening(part: &str, closing: Range<usize>) -> Range<usize> {
    // Brackets and how deep each one is. It goes through the text twice rather than keep a stack,
    // which a text of brackets would make long.
    let brackets = || {
        let mut depth = 0_usize;
        Tokens { text: part, at: 0 }.take_while(|token| token.start <= closing.start).filter_map(
            move |token| match &part[token.clone()] {
                "[" | "{" => {
                    depth += 1;
                    Some((token, depth, true))
                }
                "]" | "}" => {
                    depth = depth.saturating_sub(1);
                    Some((token, depth + 1, false))
                }
                _ => None,
            },
        )
    };
    let depth = brackets().last().map(|(_, depth, _)| depth);
    brackets()
        .filter(|(_, other, opens)| *opens && Some(*other) == depth)
        .last()
        .map_or(closing.clone(), |(token, ..)| token)
}

/// The token that `byte` is in, or else the next one.
fn token_at(text: &str, byte: usize) -> Option<Range<usize>> {
    Tokens { text, at: 0 }.find(|token| token.end > byte)
}

/// The tokens of a text, be it JSON or not: strings, single punctuation marks, other words.
struct Tokens<'a> {
    text: &'a str,
    at: usize,
}

impl Iterator for Tokens<'_> {
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

    fn error<'a, T: Deserialize<'a>>(text: &'a str) -> (usize, usize, &'a str, String) {
        let error = serde_json::from_str::<T>(text).err().unwrap();
        let place = Place::of_error(text, text, &error);
        (place.line, place.column, &text[place.span], problem(&error))
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Point {
        #[allow(dead_code)]
        x: Vec<f64>,
    }

    #[test]
    fn shows_keys_without_what_would_steer_a_terminal() {
        let (.., what) = error::<Point>("{\"\\u001b[2J\\n\": 1}");
        assert_eq!(what, "unknown key `\\u{1b}[2J\\n`, expected `x`");
        let long = format!("{{\"{}\": 1}}", "ü".repeat(100));
        let (.., what) = error::<Point>(&long);
        assert_eq!(what, format!("unknown key `{}..., expected `x`", "ü".repeat(59)));
    }

    /// The first letter of what is wrong, whatever `serde_json` had read when it noticed.
    #[test]
    fn places_the_first_letter_of_what_is_wrong() {
        type Points = Vec<Object<Point>>;
        for (text, line, column, span, what) in [
            ("{}", 1, 1, "{", "expected a list, found an object"),
            ("[\n  [1]]", 2, 3, "[", "expected an object, found a list"),
            ("[[1]]", 1, 2, "[", "expected an object, found a list"),
            ("[ 17, 1]", 1, 3, "17", "expected an object, found `17`"),
            ("[{\"y\": 1}]", 1, 3, "\"y\"", "unknown key `y`, expected `x`"),
            ("[{\"x\": 1.5}]", 1, 8, "1.5", "expected a list, found `1.5`"),
            ("[{\"x\":{}}]", 1, 7, "{", "expected a list, found an object"),
            ("[{\"x\": [1, [2]]}]", 1, 12, "[", "expected a number, found a list"),
            ("[{\"x\": [1, true]}]", 1, 12, "true", "expected a number, found `true`"),
            ("[{\"x\": [1, null]}]", 1, 12, "null", "expected a number, found null"),
            (
                "[{\"x\": [\"\\\"]\"]}]",
                1,
                9,
                "\"\\\"]\"",
                "expected a number, found string \"\\\"]\"",
            ),
            ("[{\"x\": [1e400]}]", 1, 9, "1e400", "the number is too large"),
            ("[{\"x\": [NaN]}]", 1, 9, "NaN", "this is not JSON: a value is expected"),
            ("[{\"x\": [tru]}]", 1, 9, "tru", "this is not JSON: a value is expected"),
            ("[{\"x\": [1}]", 1, 10, "}", "expected `,` or `]`"),
            ("[{\"x\": [1],}]", 1, 12, "}", "trailing comma"),
            ("[{x: 1}]", 1, 3, "x", "a key is expected, in double quotes"),
            ("[{\"x\": [1], \"ü\\q\": 1}]", 1, 16, "q", "invalid escape"),
            (
                "[{\"x\": []},\n {\"x\": [], \"x\": []}]",
                2,
                12,
                "\"x\"",
                "the key `x` is there twice",
            ),
            ("[{\"x\": []},\n  { }]", 2, 3, "{", "the key `x` is missing"),
            ("[] 7", 1, 4, "7", "there is more text after the end"),
            ("[{\"x\": [1, 2\n\n", 1, 13, "", "the text ends too early"),
            ("", 1, 1, "", "the text ends too early"),
        ] {
            let found = error::<Points>(text);
            assert_eq!(found, (line, column, span, what.to_owned()), "{text}");
        }
    }

    #[test]
    fn a_message_repeats_no_novel() {
        let text = format!("[{{\"{}\": 1}}]", "ü".repeat(10_000));
        let (_, column, span, what) = error::<Vec<Object<Point>>>(&text);
        assert_eq!((column, span.chars().count()), (3, 10_002));
        assert!(what.chars().count() < 100, "{what}");
    }

    #[test]
    fn tells_the_element_of_a_list() {
        let text = "{ \"a\": [[1, 2], 3], \"m\": [{ \"x\": [1, 2] }, [\"],\", 7], 8";
        let at = |word: &str| element_at(text, "m", text.find(word).unwrap());
        assert_eq!(at("1, 2], 3"), None);
        assert_eq!(at("1, 2] }"), Some(0));
        assert_eq!((at("7"), at("8")), (Some(1), Some(2)));
        assert_eq!(element_at("{ \"m\": [1], \"n\": 2 }", "m", 19), None);
        assert_eq!(element_at("{ \"m\": { \"m\": [1, 2] } }", "m", 18), None);
    }

    #[test]
    fn places_an_error_of_a_part() {
        let part = &TEXT[TEXT.find("[1").unwrap()..TEXT.find(" }\n").unwrap()];
        let error = serde_json::from_str::<Vec<f64>>(part).unwrap_err();
        let place = Place::of_error(TEXT, part, &error);
        assert_eq!((place.line, place.column, &TEXT[place.span]), (3, 25, "\"ü\""), "{error}");
    }

    #[test]
    fn survives_a_text_that_ends_early() {
        let text = "{\n";
        let error = serde_json::from_str::<BTreeMap<String, f64>>(text).unwrap_err();
        assert_eq!(Place::of_error(text, text, &error).span, 1..1);
    }
}
