//! Valid and invalid scenes, for the reader here, and for the JSON Schema in `tests/peers`.

#![expect(clippy::unwrap_used, reason = "a failed test panics")]

use iiwasim_tests::fixture;
use serde_json::{Value, json};

/// Scene with a box and a plane.
pub(crate) const GOOD: &str = r#"{ "version": 1, "obstacles": [
  { "name": "table", "type": "box", "center_mm": [600, 0, -50], "size_mm": [800, 1200, 100],
    "rpy_deg": [0, 0, 90] },
  { "name": "floor", "type": "plane", "point_mm": [0, 0, -700], "normal": [0, 3, 4] }
] }"#;

/// Returns GOOD with pairs to ignore.
pub(crate) fn ignoring(pairs: &str) -> String {
    GOOD.replacen("\n] }", &format!("\n], \"ignore\": [{pairs}] }}"), 1)
}

fn with_pair() -> Value {
    serde_json::from_str(&ignoring(r#"["link 2", "table"]"#)).unwrap()
}

/// Returns scenes of boxes and planes.
pub(crate) fn good_scenes() -> [Value; 4] {
    let cage = std::fs::read_to_string(fixture("cage.json")).unwrap();
    let cage = serde_json::from_str(&cage).unwrap();
    [serde_json::from_str(GOOD).unwrap(), with_pair(), cage, rounds()]
}

/// Returns a scene with a cylinder and a sphere.
fn rounds() -> Value {
    json!({ "version": 1, "obstacles": [
        { "name": "post", "type": "cylinder", "center_mm": [600, 0, 250], "radius_mm": 40,
          "length_mm": 500, "rpy_deg": [0, 90, 0] },
        { "name": "lamp", "type": "sphere", "center_mm": [0, 700, 300], "radius_mm": 80 }
    ], "ignore": [["workpiece", "lamp"]] })
}

/// Returns valid scenes, each with one change that makes it invalid.
pub(crate) fn wrong_scenes() -> Vec<Value> {
    let good: Value = serde_json::from_str(GOOD).unwrap();
    let at = |pointer: &str, value: Value| {
        let mut scene = good.clone();
        *scene.pointer_mut(pointer).unwrap() = value;
        scene
    };
    let wrong_pair = |pair: Value| {
        let mut scene = with_pair();
        scene["ignore"][0] = pair;
        scene
    };
    let round = |pointer: &str, value: Value| {
        let mut scene = rounds();
        *scene.pointer_mut(pointer).unwrap() = value;
        scene
    };
    vec![
        round("/obstacles/0/radius_mm", json!(0)),
        round("/obstacles/0/length_mm", json!(2e6)),
        round("/obstacles/0/type", json!("sphere")),
        round("/obstacles/1/radius_mm", json!([80])),
        round("/obstacles/1/center_mm", json!([0, 700])),
        wrong_pair(json!(["link 1", "table"])),
        wrong_pair(json!(["link 2"])),
        wrong_pair(json!(["link 2", "table", "table"])),
        wrong_pair(json!("link 2")),
        at("/version", json!(2)),
        at("/obstacles", json!({})),
        at("/obstacles/0/type", json!("plane")),
        at("/obstacles/0/name", json!("")),
        at("/obstacles/0/size_mm", json!([1, 1, 0])),
        at("/obstacles/0/size_mm", json!([1, 1])),
        at("/obstacles/0/center_mm", json!([1, 1, 2e6])),
        at("/obstacles/0/rpy_deg", json!([0, 0, 361])),
        at("/obstacles/0/rpy_deg", Value::Null),
        at("/obstacles/1/normal", json!([0, 0, 0])),
        at("/obstacles/1/point_mm", json!("here")),
        at("/obstacles/1", json!({ "name": "a", "type": "plane", "point_mm": [0, 0, 0] })),
    ]
}

/// Creates a scene with a shape of the tool, as JSON.
pub(crate) fn with_tool(shape: &str) -> Value {
    let shape: Value = serde_json::from_str(shape).unwrap();
    json!({ "version": 1, "obstacles": [], "tool": [shape] })
}

/// Tool shape that is a mesh.
pub(crate) const GOOD_MESH: &str =
    r#"{ "type": "mesh", "file": "a.StL", "scale": 2.5, "rpy_deg": [0, 0, 90] }"#;

/// Invalid meshes.
pub(crate) const WRONG_MESHES: [&str; 7] = [
    r#"{ "type": "mesh" }"#,
    r#"{ "type": "mesh", "file": "a.step" }"#,
    r#"{ "type": "mesh", "file": 1 }"#,
    r#"{ "type": "mesh", "file": "a.stl", "scale": 0 }"#,
    r#"{ "type": "mesh", "file": "a.stl", "scale": 1e7 }"#,
    r#"{ "type": "mesh", "file": "a.stl", "origin_mm": [0, 0] }"#,
    r#"{ "type": "mesh", "file": "a.stl", "center_mm": [0, 0, 0] }"#,
];
