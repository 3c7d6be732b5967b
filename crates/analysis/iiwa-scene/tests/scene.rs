//! Accepted and rejected scenes, with the place of each fault. `tests/peers` checks that the JSON
//! Schema agrees.

// Test helpers may panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iiwa_scene::{Form, IgnoredPair, Obstacle, Scene, SceneError, SceneFault};
use serde_json::json;

use crate::documents::{GOOD, good_scenes, ignoring, wrong_scenes};

#[test]
fn reads_boxes_and_planes() {
    let named = GOOD.replace("\"version\"", "\"$schema\": \"scene.schema.json\", \"version\"");
    assert_eq!(Scene::from_json(&named).unwrap(), Scene::from_json(GOOD).unwrap());
    let scene = Scene::from_json(GOOD).unwrap();
    let [table, floor] = scene.obstacles() else { panic!("{scene:?}") };
    assert_eq!((table.name.as_str(), floor.name.as_str()), ("table", "floor"));
    let rpy_rad = [0.0, 0.0, std::f64::consts::FRAC_PI_2];
    let cuboid = Form::Box { center_m: [0.6, 0.0, -0.05], size_m: [0.8, 1.2, 0.1], rpy_rad };
    assert_eq!(table.form, cuboid);
    assert_eq!(floor.form, Form::Plane { point_m: [0.0, 0.0, -0.7], normal: [0.0, 3.0, 4.0] });
    assert!(
        Scene::from_json(r#"{ "version": 1, "obstacles": [] }"#).unwrap().obstacles().is_empty()
    );
}

#[test]
fn is_drawn_in_m() {
    let drawn = serde_json::to_value(Scene::from_json(GOOD).unwrap()).unwrap();
    let [table, floor] = drawn["obstacles"].as_array().unwrap().as_slice() else {
        panic!("{drawn}")
    };
    assert_eq!((&table["type"], &table["name"]), (&json!("box"), &json!("table")));
    assert_eq!(
        (&table["center_m"], &table["size_m"]),
        (&json!([0.6, 0.0, -0.05]), &json!([0.8, 1.2, 0.1]))
    );
    let rows: [[f64; 3]; 3] = serde_json::from_value(table["rotation"].clone()).unwrap();
    for (row, expected) in rows.iter().zip([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]) {
        assert!(row.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{rows:?}");
    }
    assert_eq!((&floor["type"], &floor["point_m"]), (&json!("plane"), &json!([0.0, 0.0, -0.7])));
    let normal: [f64; 3] = serde_json::from_value(floor["normal"].clone()).unwrap();
    assert!(normal.iter().zip([0.0, 0.6, 0.8]).all(|(a, b)| (a - b).abs() < 1e-15), "{normal:?}");
}

/// Returns GOOD with a change, and the resulting message.
fn refused(from: &str, to: &str) -> (String, usize, String) {
    let text = GOOD.replacen(from, to, 1);
    assert_ne!(text, GOOD, "nothing is changed");
    let error = Scene::from_json(&text).unwrap_err();
    let place = error.place().clone();
    assert_eq!(error.to_string(), format!("{}, at {place}", error.message()));
    (error.message(), place.line, text[place.span].to_owned())
}

#[test]
fn invalid_scenes_are_reported_with_their_place() {
    let long = format!("\"{}\"", "x".repeat(101));
    let huge = format!("[{}, 0, 0]", "1e400");
    for (from, to, message, line, span) in [
        ("\"version\": 1", "\"version\": 2", "version 2; version 1 is understood", 1, "2"),
        ("\"version\": 1", "\"version\": 1, \"a\": 1", "unknown key `a`", 1, "\"a\""),
        (
            "\"type\": \"box\"",
            "\"type\": \"ball\"",
            "unknown type `ball`; `box`, `plane`, `cylinder`, `sphere` and `mesh` are known",
            2,
            "\"ball\"",
        ),
        ("\"type\": \"plane\", ", "", "obstacle 2: it has no `type`", 4, "{"),
        ("\"normal\"", "\"normals\"", "obstacle 2: unknown key `normals`", 4, "\"normals\""),
        ("\"name\": \"table\", ", "", "obstacle 1: the key `name` is missing", 2, "{"),
        (
            "\"floor\"",
            "\"table\"",
            "obstacle 2: it is called \"table\", and so is obstacle 1",
            4,
            "\"table\"",
        ),
        ("\"floor\"", "\"\"", "obstacle 2: the name \"\" cannot be used", 4, "\"\""),
        ("\"floor\"", "\"a\\u001b\"", "cannot be used", 4, "\"a\\u001b\""),
        ("\"floor\"", long.as_str(), "1 to 100 characters", 4, long.as_str()),
        ("\"floor\"", "7", "obstacle 2: expected a string, found `7`", 4, "7"),
        ("[0, 3, 4]", "[0, 0, 0]", "obstacle 2: the normal has zero length", 4, "[0, 0, 0]"),
        ("[0, 3, 4]", "[0, 3]", "expected three numbers, for x, y and z, found 2", 4, "["),
        ("[0, 3, 4]", "[0, 3, 4, 5]", "expected three numbers, for x, y and z, found 4", 4, "["),
        ("[0, 3, 4]", "null", "expected three numbers, for x, y and z, found null", 4, "null"),
        ("[0, 3, 4]", huge.as_str(), "the number is too large", 4, "1e400"),
        (
            "[800, 1200, 100]",
            "[800, 0, 100]",
            "obstacle 1: number 2 of size_mm is 0; a size is above 0",
            2,
            "0",
        ),
        (
            "[800, 1200, 100]",
            "[800, 1200, -1]",
            "number 3 of size_mm is -1; a size is above 0",
            2,
            "-1",
        ),
        (
            "[800, 1200, 100]",
            "[1e-4, 1200, 1]",
            "number 1 of size_mm is 0.0001; it must be from 0.001 to 1000000",
            2,
            "1e-4",
        ),
        (
            "[600, 0, -50]",
            "[600, 1e7, -50]",
            "number 2 of center_mm is 10000000; it must be from -1000000 to 1000000",
            2,
            "1e7",
        ),
        (
            "[0, 0, 90]",
            "[0, 400, 90]",
            "number 2 of rpy_deg is 400; it must be from -360 to 360",
            3,
            "400",
        ),
        ("[0, 0, -700]", "[0, -1e9, 0]", "number 2 of point_mm is -1000000000", 4, "-1e9"),
    ] {
        let (actual, place, text) = refused(from, to);
        assert!(actual.contains(message), "{to}: {actual}");
        assert_eq!(place, line, "{to}: {actual}");
        let shown =
            if span.len() == 1 && !span.contains(char::is_numeric) { &text[..1] } else { &text };
        assert_eq!(shown, span, "{to}: {actual}");
    }
}

#[test]
fn pairs_are_ignored_by_name() {
    let text = ignoring(r#"["link 2", "table"], ["tool", "floor"]"#);
    let pairs = Scene::from_json(&text).unwrap().ignored().to_vec();
    let pair = |link, obstacle| IgnoredPair { link, obstacle };
    assert_eq!(pairs, [pair(2, 0), pair(8, 1)]);
    for (pair, message, span) in [
        (
            r#"["link 2", "tablet"]"#,
            "unknown obstacle `tablet`; did you mean `table`?",
            "\"tablet\"",
        ),
        (r#"["link 1", "table"]"#, "unknown part of the arm `link 1`; did you mean", "\"link 1\""),
        (r#"["link7", "table"]"#, "did you mean `link 7`?", "\"link7\""),
        (r#"["link 2"]"#, "a pair is [\"link 2\", \"NAME\"]", "[\"link 2\"]"),
        (r#"["link 2", 7]"#, "expected a string, found `7`", "["),
        ("7", "a pair is", "7"),
    ] {
        let text = ignoring(&format!("[\"link 3\", \"floor\"], {pair}"));
        let error = Scene::from_json(&text).unwrap_err();
        let actual = error.message();
        assert!(actual.starts_with("ignored pair 2: ") && actual.contains(message), "{actual}");
        assert!(text[error.place().span.clone()].starts_with(span), "{actual}: {}", error.place());
        assert_eq!(error.place().line, 5, "{actual}");
    }
    let scene = Scene::from_json(GOOD).unwrap();
    for actual in [pair(1, 0), pair(10, 0), pair(2, 2)] {
        let error = scene.clone().with_ignored(vec![pair(3, 1), actual]);
        assert_eq!(error, Err(SceneFault::Ignored { pair: 1, found: actual }));
    }
}

#[test]
fn scenes_made_in_code_are_checked() {
    let cuboid = |size_m| Form::Box { center_m: [0.0; 3], size_m, rpy_rad: [0.0; 3] };
    let scene = |form| Scene::new(vec![Obstacle { name: "it".to_owned(), form }]);
    assert!(matches!(
        scene(cuboid([1.0, f64::NAN, 1.0])),
        Err(SceneFault::Range { obstacle: 0, key: "size", axis: Some(1), .. })
    ));
    let plane = |normal| Form::Plane { point_m: [0.0; 3], normal };
    assert!(scene(plane([0.0, f64::INFINITY, 0.0])).is_err());
    // For any length of the normal.
    for length in [1e-300, 1e300] {
        let scene = scene(plane([0.0, length, 0.0])).unwrap();
        let drawn = serde_json::to_value(&scene).unwrap();
        assert_eq!(drawn["obstacles"][0]["normal"], json!([0.0, 1.0, 0.0]));
    }
    let same = Obstacle { name: "it".to_owned(), form: cuboid([1.0; 3]) };
    let many = (0..10_001).map(|i| Obstacle { name: i.to_string(), ..same.clone() });
    assert_eq!(Scene::new(many.collect()), Err(SceneFault::TooMany { found: 10_001, max: 10_000 }));
}

#[test]
fn documents_valid_by_the_schema_are_read() {
    for scene in good_scenes() {
        Scene::from_json(&scene.to_string()).unwrap();
    }
}

#[test]
fn documents_invalid_by_the_schema_are_refused() {
    for wrong in wrong_scenes() {
        let error = Scene::from_json(&wrong.to_string()).unwrap_err();
        let is_version = matches!(error, SceneError::Version { .. });
        assert_eq!(is_version, wrong["version"] == 2, "{error}");
    }
}
