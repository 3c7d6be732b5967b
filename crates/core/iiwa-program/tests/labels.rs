//! Names, comments and groups of motions in JSON.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_program::{MAX_COMMENT, MAX_NAME, MotionIndex, MotionLabel, MotionList, Program};
use serde_json::{Value, json};

/// One motion of each type.
fn motions() -> Vec<Value> {
    let frame =
        json!({ "x_mm": 500, "y_mm": 0, "z_mm": 400, "a_deg": 0, "b_deg": 180, "c_deg": 0 });
    vec![
        json!({ "type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 90, 0] }),
        json!({ "type": "ptp", "frame": frame }),
        json!({ "type": "lin", "frame": frame }),
        json!({ "type": "lin_rel", "offset": { "z_mm": 5 } }),
        json!({ "type": "circ", "aux": frame, "frame": frame }),
        json!({ "type": "spl", "frame": frame }),
        json!({ "type": "spline", "segments": [
            { "type": "lin", "frame": frame }, { "type": "spl", "frame": frame }
        ] }),
        json!({ "type": "wait", "seconds": 0.5 }),
        json!({ "type": "load", "load": null }),
    ]
}

fn text(motions: &[Value]) -> String {
    json!({
        "version": 1,
        "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
        "motions": motions,
    })
    .to_string()
}

/// Error message of a program whose motion has these keys, and the text at its place.
fn error(keys: &[(&str, Value)]) -> (String, String) {
    let mut motion = motions()[0].clone();
    for (key, value) in keys {
        motion[*key] = value.clone();
    }
    let text = text(&[motions()[0].clone(), motion]);
    let error = Program::from_json(&text).unwrap_err();
    (error.message(), text[error.place().span.clone()].to_owned())
}

#[test]
fn all_types_have_names_comments_and_groups() {
    let mut labelled = motions();
    for (index, motion) in labelled.iter_mut().enumerate() {
        motion["name"] = json!(format!("Motion \"{index}\" Größe"));
        motion["comment"] = json!(format!("first line {index}\nsecond\tline\r\n"));
        motion["group"] = json!("pick");
    }
    let program = Program::from_json(&text(&labelled)).unwrap();
    assert_eq!(program.sources.labels().count(), labelled.len());
    let expected = MotionLabel::named("Motion \"8\" Größe")
        .with_comment("first line 8\nsecond\tline\r\n")
        .in_group("pick");
    assert_eq!(program.sources.label(MotionIndex::new(8)), Some(&expected));

    assert_eq!(Program::from_json(&program.to_json()).unwrap(), program);
    let list = MotionList::from(program);
    let json = serde_json::to_string(&list).unwrap();
    assert_eq!(MotionList::from_json(&json).unwrap(), list);
    assert_eq!(json.matches("\"group\":\"pick\"").count(), labelled.len());
}

#[test]
fn programs_without_labels_are_written_without_their_keys() {
    let program = Program::from_json(&text(&motions())).unwrap();
    assert_eq!(program.sources.labels().count(), 0);
    let written = program.to_json();
    let keys = ["\"name\"", "\"comment\"", "\"group\""];
    assert!(keys.iter().all(|key| !written.contains(key)), "{written}");
    // Null is the same as an absent key.
    let mut with_null = motions();
    with_null[0]["name"] = Value::Null;
    assert_eq!(Program::from_json(&text(&with_null)).unwrap(), program);
}

#[test]
fn unsuitable_texts_are_errors_at_their_place() {
    let long = "ö".repeat(MAX_NAME + 1);
    let (message, place) = error(&[("name", json!(long))]);
    assert_eq!(message, "motion 2: `name` has 201 characters; at most 200 are allowed");
    assert_eq!(place, format!("\"{long}\""));
    let (message, place) = error(&[("name", json!("a\nb"))]);
    assert_eq!(message, "motion 2: `name` contains the control character \\u{a}");
    assert_eq!(place, r#""a\nb""#);
    let (message, place) = error(&[("name", json!("press")), ("group", json!(""))]);
    assert_eq!(
        (message.as_str(), place.as_str()),
        ("motion 2 \"press\": `group` is empty", "\"\"")
    );
    let (message, _) = error(&[("comment", json!("\u{1b}[31m"))]);
    assert_eq!(message, "motion 2: `comment` contains the control character \\u{1b}");
    let (message, _) = error(&[("comment", json!("c".repeat(MAX_COMMENT + 1)))]);
    assert_eq!(message, "motion 2: `comment` has 2001 characters; at most 2000 are allowed");
    let (message, place) = error(&[("name", json!(3))]);
    assert!(message.contains("expected a string"), "{message}");
    assert_eq!(place, "3");
    let longest = json!({ "type": "wait", "seconds": 1, "name": "ö".repeat(MAX_NAME),
        "group": "ö".repeat(MAX_NAME), "comment": "ö".repeat(MAX_COMMENT) });
    Program::from_json(&text(&[longest])).unwrap();
}

#[test]
fn errors_contain_the_name() {
    let (message, _) = error(&[("name", json!("approach")), ("velocity_rel", json!(2))]);
    assert!(message.starts_with("motion 2 \"approach\": velocity_rel is 2"), "{message}");
    let (message, place) = error(&[("name", json!("approach")), ("speed", json!(2))]);
    assert!(message.starts_with("motion 2 \"approach\": unknown key `speed`"), "{message}");
    assert_eq!(place, "\"speed\"");
    let source = json!({ "file": "Weld.java", "line": 84 });
    let keys = [("name", json!("x".repeat(100))), ("speed", json!(2)), ("source", source)];
    let (message, _) = error(&keys);
    let expected = format!("motion 2 \"{}...\" (Weld.java:84): unknown", "x".repeat(60));
    assert!(message.starts_with(&expected), "{message}");
}

#[test]
fn misspelt_keys_are_suggested() {
    let (message, _) = error(&[("comments", json!("text"))]);
    assert!(message.contains("did you mean `comment`?"), "{message}");
}

#[test]
fn the_schema_has_the_bounds() {
    let schema = Program::schema();
    for definition in ["Ptp", "Lin", "LinRel", "Circ", "Spl", "Spline", "Wait", "LoadStep"] {
        let keys = &schema["$defs"][definition]["properties"];
        assert_eq!(keys["name"]["maxLength"], MAX_NAME, "{definition}");
        assert_eq!(keys["group"]["maxLength"], MAX_NAME, "{definition}");
        assert_eq!(keys["comment"]["maxLength"], MAX_COMMENT, "{definition}");
        assert_eq!(keys["name"]["minLength"], 1, "{definition}");
        assert!(keys["name"]["pattern"].is_string(), "{definition}");
    }
}
