//! Errors of `serde_json` as messages for the author of the text.

use crate::{excerpt::excerpt, meant::meant};

/// Message of `error` for the author of the JSON, without the place.
#[must_use]
pub fn problem(error: &serde_json::Error) -> String {
    let message = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    let message = message.strip_suffix(&place).unwrap_or(&message);
    if error.is_eof() {
        return "the text ends too early".to_owned();
    }
    for (start, replacement) in [
        ("invalid type: ", ""),
        ("invalid value: ", ""),
        ("invalid length ", ""),
        ("unknown field ", "unknown key "),
        ("unknown variant ", "unknown value "),
    ] {
        let Some((actual, expected)) =
            message.strip_prefix(start).and_then(|rest| rest.rsplit_once(", expected "))
        else {
            continue;
        };
        if replacement.is_empty() {
            let expected = match expected {
                "f64" => "a number",
                "u64" | "u8" => "a whole number, 0 or more",
                "a sequence" => "a list",
                other => other,
            };
            return format!("expected {expected}, found {}", shown(actual));
        }
        let words = expected.split('`').skip(1).step_by(2);
        return match meant(actual.trim_matches('`'), words) {
            Some(word) => format!("{replacement}{}; did you mean `{word}`?", shown(actual)),
            None => format!("{replacement}{}, expected {expected}", shown(actual)),
        };
    }
    let key = |start: &str| message.strip_prefix(start);
    if let Some(key) = key("missing field ") {
        return format!("the key {key} is missing");
    }
    if let Some(key) = key("duplicate field ") {
        return format!("the key {key} appears twice");
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

/// A value as named by serde, in plainer words and shortened.
fn shown(text: &str) -> String {
    let plain = match text {
        "sequence" => "a list",
        "map" => "an object",
        other => other.strip_prefix("integer ").unwrap_or(other),
    };
    let plain = plain.strip_prefix("floating point ").unwrap_or(plain);
    let plain = plain.strip_prefix("boolean ").unwrap_or(plain);
    excerpt(plain)
}
