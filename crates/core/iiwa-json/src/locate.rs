//! Places of values, by keys and indices.

use std::collections::BTreeMap;

use serde_json::value::RawValue;

use crate::{
    place::{JsonPlace, offset_in},
    token::JsonTokens,
};

/// One step down into a JSON text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JsonStep<'a> {
    /// Into the value of an object's key.
    Key(&'a str),
    /// Into the element of an array, from 0.
    Index(usize),
}

/// Place of the value at `path`, or of the last existing value along the path.
///
/// Parses the text again from the start: for error messages, not for hot paths.
#[must_use]
pub fn locate(text: &str, path: &[JsonStep<'_>]) -> JsonPlace {
    let mut part = text.trim();
    for step in path {
        let next = match step {
            JsonStep::Key(key) => serde_json::from_str::<BTreeMap<String, &RawValue>>(part)
                .ok()
                .and_then(|object| object.get(*key).map(|value| value.get())),
            JsonStep::Index(index) => serde_json::from_str::<Vec<&RawValue>>(part)
                .ok()
                .and_then(|array| array.get(*index).map(|value| value.get())),
        };
        match next {
            Some(value) => part = value,
            None => break,
        }
    }
    let start = offset_in(text, part).unwrap_or(0);
    JsonPlace::of_span(text, start..start + part.len())
}

/// Index, from 0, of the element that contains `byte` in the list under the key `list` of the
/// outermost object. The text may be invalid JSON.
#[must_use]
pub fn element_at(text: &str, list: &str, byte: usize) -> Option<usize> {
    let (mut depth, mut index, mut in_list) = (0_usize, 0, false);
    let mut before = ["", ""];
    for token in (JsonTokens { text, at: 0 }).take_while(|token| token.start <= byte) {
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
