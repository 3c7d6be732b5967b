//! Accepted and rejected programs and frames, for the reader here and for the JSON Schema in
//! `tests/peers`.

#![expect(clippy::unwrap_used, clippy::panic, reason = "a failed test panics")]

use std::{fs, path::Path};

use serde_json::{Value, json};

/// A file of tools, bases and frames.
pub(crate) const CELL: &str = r#"{
  "version": 1,
  "tools": { "gripper": { "tcp": { "z_mm": 120 }, "load": { "mass_kg": 1.5 } },
             "probe": { "tcp": { "z_mm": 300 } } },
  "bases": { "table": { "x_mm": 500, "a_deg": 30 }, "tray": { "base": "table", "y_mm": 40 } },
  "frames": {
    "pick": { "base": "tray", "x_mm": 0, "y_mm": 0, "z_mm": 200,
              "a_deg": 0, "b_deg": 180, "c_deg": 0, "e1_deg": 5, "status": 2 },
    "place": { "base": "tray", "x_mm": 50, "y_mm": 0, "z_mm": 200,
               "a_deg": 0, "b_deg": 180, "c_deg": 0 }
  }
}"#;

/// A program that includes [`CELL`].
pub(crate) const PROGRAM: &str = r#"{
  "version": 1,
  "include": "cell.json",
  "tools": { "gripper": { "tcp": { "z_mm": 130 } } },
  "bases": { "table": { "x_mm": 480 } },
  "tool": "gripper",
  "base": "tray",
  "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
  "motions": [
    { "type": "ptp", "frame": "pick", "velocity_rel": 0.30 },
    { "type": "lin", "frame": "place", "cart_velocity_mm_s": 250.0 }
  ]
}"#;

/// Test documents of one kind.
pub(crate) struct Documents {
    pub(crate) good: Value,
    /// Rejected variants of the valid document, with one change each.
    pub(crate) bad: Vec<Value>,
    /// Accepted variants that may look odd.
    pub(crate) odd: Vec<Value>,
}

fn read(file: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

/// All programs among the fixtures.
pub(crate) fn fixtures() -> Vec<Value> {
    // From the crate, and from tests/peers, which includes this file.
    let mut folders = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    let fixtures =
        folders.find_map(|folder| Some(folder.join("fixtures")).filter(|f| f.is_dir())).unwrap();
    let reference = read(&fixtures.join("reference/programs.json"));
    let mut programs: Vec<Value> =
        reference["cases"].as_array().unwrap().iter().map(|case| case["program"].clone()).collect();
    assert_eq!(programs.len(), 12);
    let folders =
        [&fixtures, &fixtures.join("hostile")].map(|folder| fs::read_dir(folder).unwrap());
    for entry in folders.into_iter().flatten() {
        let file = entry.unwrap().path();
        if file.extension().is_some_and(|extension| extension == "json") {
            let json = read(&file);
            // Scenes are not programs.
            if json.get("obstacles").is_none() {
                programs.push(json);
            }
        }
    }
    programs
}

/// A program and a file of frames that name their schema for editors.
pub(crate) fn with_schema_key() -> [Value; 2] {
    let program = json!({ "$schema": "program.schema.json", "version": 1,
        "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
        "motions": [{ "type": "wait", "seconds": 1 }] });
    [program, json!({ "$schema": "frames.schema.json", "version": 1 })]
}

/// The program with another value at a pointer.
fn with(program: &Value, pointer: &str, value: Value) -> Value {
    let mut program = program.clone();
    let (owner, key) = pointer.rsplit_once('/').unwrap();
    match program.pointer_mut(owner).unwrap() {
        Value::Object(object) => object.insert(key.to_owned(), value),
        Value::Array(array) => {
            array.get_mut(key.parse::<usize>().unwrap()).map(|v| std::mem::replace(v, value))
        }
        _ => panic!("{pointer}"),
    };
    program
}

/// The program without the value at a pointer.
fn without(program: &Value, pointer: &str) -> Value {
    let mut program = program.clone();
    let (owner, key) = pointer.rsplit_once('/').unwrap();
    program.pointer_mut(owner).unwrap().as_object_mut().unwrap().remove(key).unwrap();
    program
}

/// Motions to joint positions.
pub(crate) fn joint_programs() -> Documents {
    let good = json!({
        "version": 1,
        "robot": "lbr_iiwa_14_r820",
        "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
        "motions": [
            { "type": "ptp", "joints_rad": [1, 0, 0, 0, 0, 0, 0], "velocity_rel": 0.5,
              "acceleration_rel": [1, 1, 1, 0.5, 1, 1, 1], "blend": { "fraction": 0.5 } },
            { "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
            { "type": "wait", "seconds": 1 }
        ]
    });
    let at = |pointer: &str, value: Value| with(&good, pointer, value);
    let without = |pointer: &str| without(&good, pointer);
    let bad = vec![
        json!([1]),
        without("/version"),
        without("/start"),
        without("/motions"),
        without("/start/joints_deg"),
        without("/motions/0/joints_rad"),
        without("/motions/0/type"),
        without("/motions/2/seconds"),
        at("/version", json!(2)),
        at("/version", json!("1")),
        at("/robot", json!(14)),
        at("/cell", json!("A")),
        at("/start", json!([[0, 0, 0, 0, 0, 0, 0]])),
        at("/start/joints_deg", json!([0, 0, 0, 0, 0, 0])),
        at("/start/joints_rad", json!([0, 0, 0, 0, 0, 0, 0])),
        at("/motions", json!([])),
        at("/motions", json!({})),
        at("/motions/0", json!(["ptp"])),
        at("/motions/0/type", json!("fly")),
        at("/motions/0/speed", json!(1)),
        at("/motions/0/joints_deg", json!([0, 0, 0, 0, 0, 0, 0])),
        at("/motions/0/joints_rad", json!([0, 0, 0, 0, 0, 0, 0, 0])),
        at("/motions/0/joints_rad", json!([0, 0, 0, 0, 0, 0, "0"])),
        at("/motions/0/joints_rad", json!([0, 0, 0, 0, 0, 0, null])),
        at("/motions/0/velocity_rel", json!(0)),
        at("/motions/0/velocity_rel", json!(-1)),
        at("/motions/0/velocity_rel", json!(1.5)),
        at("/motions/0/velocity_rel", json!([1, 1, 1, 1, 1, 1])),
        at("/motions/0/velocity_rel", json!([1, 1, 1, 1, 1, 1, 0])),
        at("/motions/0/jerk_rel", json!(null)),
        at("/motions/0/blend", json!({})),
        at("/motions/0/blend", json!(0.5)),
        at("/motions/0/blend", json!({ "fraction": 0.1, "cart_mm": 5 })),
        at("/motions/0/blend", json!({ "fraction": 0.6 })),
        at("/motions/0/blend", json!({ "sunrise_rel": 1.1 })),
        at("/motions/0/blend", json!({ "cart_mm": -5 })),
        at("/motions/0/blend", json!({ "radius": 5 })),
        at("/motions/2/seconds", json!(-1)),
        at("/motions/2/seconds", json!(1e9)),
        at("/motions/2/blend", json!({ "fraction": 0.1 })),
    ];
    let odd = vec![
        at("/robot", json!(null)),
        at("/motions/0/blend", json!(null)),
        at("/motions/0/blend", json!({ "cart_mm": 1e6 })),
        at("/motions/2/seconds", json!(0)),
    ];
    Documents { good, bad, odd }
}

/// Motions to frames.
pub(crate) fn frame_programs() -> Documents {
    let frame =
        json!({ "x_mm": 600, "y_mm": 0, "z_mm": 300, "a_deg": 0, "b_deg": 180, "c_deg": 0 });
    let good = json!({
        "version": 1,
        "tools": { "gripper": { "tcp": { "z_mm": 120 } } },
        "bases": { "table": { "x_mm": 500 } },
        "frames": { "pick": frame },
        "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
        "motions": [
            { "type": "ptp", "frame": "pick" },
            { "type": "lin", "frame": frame, "cart_velocity_mm_s": 100,
              "blend": { "cart_mm": 20 } },
            { "type": "spline", "segments": [
                { "type": "spl", "frame": frame, "velocity_rel": 0.5 },
                { "type": "lin", "frame": "pick", "cart_jerk_mm_s3": 1000 } ] }
        ]
    });
    let at = |pointer: &str, value: Value| with(&good, pointer, value);
    let circle = |aux: Value| json!({ "type": "circ", "aux": aux, "frame": frame });
    let point = json!({ "x_mm": 600, "y_mm": 40, "z_mm": 300, "base": "table" });
    let odd = vec![
        at("/motions/1", circle(point.clone())),
        at("/motions/2/segments/0", circle(point.clone())),
    ];
    let bad = vec![
        at("/motions/1", circle(without(&point, "/z_mm"))),
        at("/motions/1", circle(with(&point, "/a_deg", json!(0)))),
        at("/motions/1", circle(with(&point, "/e1_deg", json!(0)))),
        at("/motions/1", json!({ "type": "circ", "aux": frame, "frame": point })),
        without(&good, "/frames/pick/x_mm"),
        without(&good, "/frames/pick/c_deg"),
        without(&good, "/motions/1/frame"),
        without(&good, "/motions/2/segments/0/frame"),
        at("/frames/pick/c_rad", json!(0)),
        at("/motions/1/frame/a_rad", json!(0)),
        at("/frames/pick/status", json!(8)),
        at("/frames/pick/e1", json!(0)),
        at("/bases/table", json!({ "a_deg": 0, "a_rad": 0 })),
        at("/tools/gripper/tcp", json!({ "b_deg": 0, "b_rad": 0 })),
        at("/motions/1/blend", json!({})),
        at("/motions/1/blend", json!({ "fraction": 0.2 })),
        at("/motions/1/cart_velocity_mm_s", json!(0)),
        at("/motions/1/cart_acceleration_mm_s2", json!(0.5)),
        at("/motions/1/segments", json!([])),
        at("/motions/2/segments", json!([])),
        at("/motions/2/segments/0/velocity_rel", json!(2)),
        at("/motions/2/segments/0/blend", json!({ "cart_mm": 5 })),
        at("/motions/2/segments/1/cart_jerk_mm_s3", json!(0)),
        at("/motions/2/segments/1/aux", json!("pick")),
    ];
    Documents { good, bad, odd }
}

/// Payloads and a mounting.
pub(crate) fn load_programs() -> Documents {
    let load =
        json!({ "mass_kg": 3, "center_mm": [0, 0, 60], "inertia_kg_m2": [0.01, 0.01, 0.01] });
    let good = json!({
        "version": 1,
        "mount": { "rpy_deg": [0, 90, 0] },
        "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
        "motions": [{ "type": "load", "load": load }, { "type": "load", "load": null }]
    });
    let shapes = json!([
        { "type": "box", "center_mm": [0, 0, 50], "size_mm": [60, 40, 100], "rpy_deg": [0, 0, 9] },
        { "type": "cylinder", "center_mm": [0, 0, 50], "radius_mm": 20, "length_mm": 100 },
        { "type": "sphere", "center_mm": [0, 0, 50], "radius_mm": 20 },
        { "type": "mesh", "file": "parts/blank.STL", "origin_mm": [0, 0, 5], "scale": 1000 },
        { "type": "mesh", "file": "data:model/obj;base64,AAAA" }
    ]);
    let mut good = good;
    good["motions"][0]["load"]["shapes"] = shapes;
    let at = |pointer: &str, value: Value| with(&good, pointer, value);
    let bad = vec![
        without(&good, "/motions/0/load"),
        without(&good, "/motions/0/load/mass_kg"),
        without(&good, "/mount/rpy_deg"),
        at("/motions/0/load/mass_kg", json!(-1)),
        at("/motions/0/load/center_mm", json!([0, 0])),
        at("/motions/0/load/weight", json!(1)),
        at("/motions/0/load", json!("gripper")),
        without(&good, "/motions/0/load/shapes/0/size_mm"),
        without(&good, "/motions/0/load/shapes/1/length_mm"),
        without(&good, "/motions/0/load/shapes/2/center_mm"),
        without(&good, "/motions/0/load/shapes/3/file"),
        at("/motions/0/load/shapes/0/type", json!("sphere")),
        at("/motions/0/load/shapes/0/type", json!("ball")),
        at("/motions/0/load/shapes/0/size_mm", json!([60, 40, 0])),
        at("/motions/0/load/shapes/0/center_mm", Value::Null),
        at("/motions/0/load/shapes/2/radius_mm", json!(0)),
        at("/motions/0/load/shapes/3/file", json!("blank.step")),
        at("/motions/0/load/shapes/3/scale", json!(0)),
        at("/motions/0/load/shapes", json!({})),
        at("/motions/0/seconds", json!(1)),
        at("/mount/rpy_deg", json!([0, 90])),
        at("/mount", json!("wall")),
    ];
    Documents { good, bad, odd: Vec::new() }
}

/// Repeat blocks.
pub(crate) fn repeat_programs() -> Documents {
    let wait = json!({ "type": "wait", "seconds": 1 });
    let inner = json!({ "type": "repeat", "count": 2, "motions": [wait], "group": "inner" });
    let good = json!({
        "version": 1,
        "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
        "motions": [wait, { "type": "repeat", "count": 3, "motions": [wait, inner],
            "name": "stack", "comment": "two\nlines", "group": "outer" }]
    });
    let at = |pointer: &str, value: Value| with(&good, pointer, value);
    let bad = vec![
        without(&good, "/motions/1/count"),
        without(&good, "/motions/1/motions"),
        without(&good, "/motions/1/motions/1/count"),
        at("/motions/1/count", json!(0)),
        at("/motions/1/count", json!(-1)),
        at("/motions/1/count", json!(2.5)),
        at("/motions/1/count", json!("3")),
        at("/motions/1/count", json!(100_001)),
        at("/motions/1/motions", json!([])),
        at("/motions/1/motions", json!({})),
        at("/motions/1/motions/0", json!({ "type": "fly" })),
        at("/motions/1/motions/1/motions/0/seconds", json!(-1)),
        at("/motions/1/motions/1/rounds", json!(2)),
        at("/motions/1/name", json!("")),
        at("/motions/1/source", json!({ "file": "a.java", "line": 1 })),
    ];
    let odd = vec![
        at("/motions/1/count", json!(1)),
        at("/motions/1/comment", json!("")),
        at("/motions/1/group", json!(null)),
        at("/motions", json!([inner])),
    ];
    Documents { good, bad, odd }
}

/// Rejected files of frames.
pub(crate) fn bad_cells() -> Vec<Value> {
    vec![
        json!({}),
        json!({ "version": 2 }),
        json!({ "version": 1, "include": "other.json" }),
        json!({ "version": 1, "motions": [] }),
        json!({ "version": 1, "frames": { "a": { "x_mm": "1" } } }),
    ]
}
