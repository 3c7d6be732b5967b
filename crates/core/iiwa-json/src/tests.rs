//! Places and messages of errors.

mod tables;

use std::collections::BTreeMap;

use serde::Deserialize;

use super::*;

const TEXT: &str = "{\n  \"motions\": [\n    { \"joints_deg\": [1, \"ü\", 30] }\n  ]\n}";

#[test]
fn finds_a_value() {
    use JsonStep::{Index, Key};
    let place = locate(TEXT, &[Key("motions"), Index(0), Key("joints_deg"), Index(2)]);
    assert_eq!((place.line, place.column, &TEXT[place.span]), (3, 30, "30"));
}

#[test]
fn stays_at_the_last_value_that_is_there() {
    let place =
        locate(TEXT, &[JsonStep::Key("motions"), JsonStep::Index(7), JsonStep::Key("blend")]);
    assert_eq!((place.line, place.column), (2, 14));
}

#[test]
fn finds_repeated_keys() {
    let text = r#"{ "b": { "a": {}, "x": [{ "a": 1 }] }, "a": [1, { "c": 2, "a": 2 }],
                   "\u0061": { "a": 3 }, "d": 4, "a" 5 }"#;
    let found = |at: &str| {
        let places = repeated_key(text, text.find(at).unwrap());
        places.map(|places| places.map(|place| (place.line, place.column)))
    };
    // The object itself, one of its keys, a value of it.
    for at in ["{ \"b\"", "\"d\"", "4,"] {
        assert_eq!(found(at), Some([(1, 40), (2, 20)]), "{at}");
    }
    // Other objects, and a list.
    for at in ["{ \"a\": {}", "\"x\"", "{ \"c\"", "2,", "{ \"a\": 3", "1, {"] {
        assert_eq!(found(at), None, "{at}");
    }
    assert_eq!(repeated_key("", 0), None);
    assert_eq!(repeated_key(&"[".repeat(1_000_000), 999_999), None);
    assert_eq!(repeated_key(&"{".repeat(1_000_000), 0), None);
}

fn error<'a, T: Deserialize<'a>>(text: &'a str) -> (usize, usize, &'a str, String) {
    let error = serde_json::from_str::<T>(text).err().unwrap();
    let place = JsonPlace::of_error(text, text, &error);
    (place.line, place.column, &text[place.span], problem(&error))
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Point {
    #[allow(dead_code)]
    x: Vec<f64>,
}

#[test]
fn shows_keys_without_terminal_control_codes() {
    let (.., message) = error::<Point>("{\"\\u001b[2J\\n\": 1}");
    assert_eq!(message, "unknown key `\\u{1b}[2J\\n`, expected `x`");
    let long = format!("{{\"{}\": 1}}", "ü".repeat(100));
    let (.., message) = error::<Point>(&long);
    assert_eq!(message, format!("unknown key `{}..., expected `x`", "ü".repeat(59)));
}

/// The place is the first letter of the wrong part, regardless of how far `serde_json` had read.
#[test]
fn the_place_is_the_first_letter_of_the_error() {
    type Points = Vec<JsonObject<Point>>;
    for (text, line, column, span, message) in [
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
        ("[{\"x\": [\"\\\"]\"]}]", 1, 9, "\"\\\"]\"", "expected a number, found string \"\\\"]\""),
        ("[{\"x\": [1e400]}]", 1, 9, "1e400", "the number is too large"),
        ("[{\"x\": [NaN]}]", 1, 9, "NaN", "this is not JSON: a value is expected"),
        ("[{\"x\": [tru]}]", 1, 9, "tru", "this is not JSON: a value is expected"),
        ("[{\"x\": [1}]", 1, 10, "}", "expected `,` or `]`"),
        ("[{\"x\": [1],}]", 1, 12, "}", "trailing comma"),
        ("[{x: 1}]", 1, 3, "x", "a key is expected, in double quotes"),
        ("[{\"x\": [1], \"ü\\q\": 1}]", 1, 16, "q", "invalid escape"),
        ("[{\"x\": []},\n {\"x\": [], \"x\": []}]", 2, 12, "\"x\"", "the key `x` appears twice"),
        ("[{\"x\": []},\n  { }]", 2, 3, "{", "the key `x` is missing"),
        ("[] 7", 1, 4, "7", "there is more text after the end"),
        ("[{\"x\": [1, 2\n\n", 1, 13, "", "the text ends too early"),
        ("", 1, 1, "", "the text ends too early"),
    ] {
        let actual = error::<Points>(text);
        assert_eq!(actual, (line, column, span, message.to_owned()), "{text}");
    }
}

#[test]
fn a_message_repeats_no_novel() {
    let text = format!("[{{\"{}\": 1}}]", "ü".repeat(10_000));
    let (_, column, span, message) = error::<Vec<JsonObject<Point>>>(&text);
    assert_eq!((column, span.chars().count()), (3, 10_002));
    assert!(message.chars().count() < 100, "{message}");
}

#[test]
fn names_the_element_of_a_list() {
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
    let place = JsonPlace::of_error(TEXT, part, &error);
    assert_eq!((place.line, place.column, &TEXT[place.span]), (3, 25, "\"ü\""), "{error}");
}

#[test]
fn survives_a_text_that_ends_early() {
    let text = "{\n";
    let error = serde_json::from_str::<BTreeMap<String, f64>>(text).unwrap_err();
    assert_eq!(JsonPlace::of_error(text, text, &error).span, 1..1);
}
