//! Keys that appear twice in an object.

use std::{collections::HashMap, ops::Range};

use crate::{place::JsonPlace, token::JsonTokens};

/// Places of the first two equal keys of an object: of the object that begins at `byte`, or else of
/// the object around `byte`. `None` if all keys differ.
///
/// ```
/// let text = "{ \"a\": 1,\n  \"b\": 2, \"a\": 3 }";
/// let places = iiwa_json::repeated_key(text, 0).unwrap();
/// assert_eq!(places.map(|place| (place.line, place.column)), [(1, 3), (2, 11)]);
/// ```
#[must_use]
pub fn repeated_key(text: &str, byte: usize) -> Option<[JsonPlace; 2]> {
    let start = object_around(text, byte)?;
    let mut known: HashMap<String, Range<usize>> = HashMap::new();
    let mut depth = 0_usize;
    let mut is_before_key = false;
    for token in (JsonTokens { text, at: start }) {
        let word = &text[token.clone()];
        if std::mem::take(&mut is_before_key)
            && let Ok(name) = serde_json::from_str::<String>(word)
            && let Some(first) = known.insert(name, token.clone())
        {
            return Some([first, token].map(|token| JsonPlace::of_span(text, token)));
        }
        match word {
            "{" | "[" => depth += 1,
            "}" | "]" => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            break;
        }
        is_before_key = depth == 1 && matches!(word, "{" | ",");
    }
    None
}

/// Start of the object that begins at `byte`, or else of the object around `byte`. Two passes over
/// the text avoid a stack, which would be long for a text of brackets.
fn object_around(text: &str, byte: usize) -> Option<usize> {
    let tokens = || JsonTokens { text, at: 0 }.take_while(|token| token.start < byte);
    if text.get(byte..)?.starts_with('{') {
        return Some(byte);
    }
    let step = |depth: usize, word: &str| match word {
        "{" | "[" => depth + 1,
        "}" | "]" => depth.saturating_sub(1),
        _ => depth,
    };
    let depth = tokens().fold(0, |depth, token| step(depth, &text[token]));
    let mut around = None;
    tokens().fold(0, |before, token| {
        let word = &text[token.clone()];
        let after = step(before, word);
        if after == depth && after > before {
            around = Some(token.start);
        }
        after
    });
    around.filter(|start| text[*start..].starts_with('{'))
}
