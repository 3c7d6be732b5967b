//! The JSON Schema and the reader agree on what a program is.

// Helpers of tests may fail.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::{fs, path::Path};

use iiwa_program::{Program, Workcell};
use jsonschema::Validator;
use serde_json::{Value, json};

fn schema() -> Validator {
    jsonschema::validator_for(&Program::schema()).unwrap()
}

fn read(file: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

#[test]
fn takes_all_fixtures() {
    let fixtures = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures"));
    let schema = schema();
    let reference = read(&fixtures.join("reference/programs.json"));
    let mut programs: Vec<Value> =
        reference["cases"].as_array().unwrap().iter().map(|case| case["program"].clone()).collect();
    assert_eq!(programs.len(), 12);
    let folders = [fixtures, &fixtures.join("hostile")].map(|folder| fs::read_dir(folder).unwrap());
    for entry in folders.into_iter().flatten() {
        let file = entry.unwrap().path();
        if file.extension().is_some_and(|extension| extension == "json") {
            let json = read(&file);
            // A scene is none.
            if json.get("obstacles").is_none() {
                programs.push(json);
            }
        }
    }
    for program in programs {
        if let Err(error) = schema.validate(&program) {
            panic!("{error}: {program}");
        }
        Program::from_json(&program.to_string()).unwrap();
    }
}

/// Editors bind a schema to a file by this key.
#[test]
fn files_may_name_their_schema() {
    let program = json!({ "$schema": "program.schema.json", "version": 1,
        "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] }, "motions": [{ "type": "wait", "seconds": 1 }] });
    schema().validate(&program).unwrap();
    Program::from_json(&program.to_string()).unwrap();
    let cell = json!({ "$schema": "frames.schema.json", "version": 1 });
    assert!(jsonschema::is_valid(&Workcell::schema(), &cell));
    assert!(Workcell::from_json(&cell.to_string()).unwrap().is_empty());
}

/// A program with another value at a pointer.
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

/// A program without what is at a pointer.
fn without(program: &Value, pointer: &str) -> Value {
    let mut program = program.clone();
    let (owner, key) = pointer.rsplit_once('/').unwrap();
    program.pointer_mut(owner).unwrap().as_object_mut().unwrap().remove(key).unwrap();
    program
}

#[test]
fn refuses_what_the_reader_refuses() {
    let schema = schema();
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
    assert!(schema.is_valid(&good));
    Program::from_json(&good.to_string()).unwrap();

    let at = |pointer: &str, value: Value| with(&good, pointer, value);
    let without = |pointer: &str| without(&good, pointer);
    for bad in [
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
    ] {
        assert!(Program::from_json(&bad.to_string()).is_err(), "the reader takes {bad}");
        assert!(!schema.is_valid(&bad), "the schema takes {bad}");
    }
    // What they both take, although it may look odd.
    for odd in [
        at("/robot", json!(null)),
        at("/motions/0/blend", json!(null)),
        at("/motions/0/blend", json!({ "cart_mm": 1e6 })),
        at("/motions/2/seconds", json!(0)),
    ] {
        Program::from_json(&odd.to_string()).unwrap();
        assert!(schema.is_valid(&odd), "{odd}");
    }
}

#[test]
fn refuses_what_the_reader_refuses_of_frames() {
    let schema = schema();
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
            { "type": "lin", "frame": frame, "cart_velocity_mm_s": 100, "blend": { "cart_mm": 20 } },
            { "type": "spline", "segments": [
                { "type": "spl", "frame": frame, "velocity_rel": 0.5 },
                { "type": "lin", "frame": "pick", "cart_jerk_mm_s3": 1000 } ] }
        ]
    });
    assert!(schema.is_valid(&good));
    Program::from_json(&good.to_string()).unwrap();
    let at = |pointer: &str, value: Value| with(&good, pointer, value);
    for bad in [
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
    ] {
        assert!(Program::from_json(&bad.to_string()).is_err(), "the reader takes {bad}");
        assert!(!schema.is_valid(&bad), "the schema takes {bad}");
    }
}

#[test]
fn refuses_what_the_reader_refuses_of_loads() {
    let schema = schema();
    let load =
        json!({ "mass_kg": 3, "center_mm": [0, 0, 60], "inertia_kg_m2": [0.01, 0.01, 0.01] });
    let good = json!({
        "version": 1,
        "mount": { "rpy_deg": [0, 90, 0] },
        "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
        "motions": [{ "type": "load", "load": load }, { "type": "load", "load": null }]
    });
    assert!(schema.is_valid(&good));
    Program::from_json(&good.to_string()).unwrap();
    let at = |pointer: &str, value: Value| with(&good, pointer, value);
    for bad in [
        without(&good, "/motions/0/load"),
        without(&good, "/motions/0/load/mass_kg"),
        without(&good, "/mount/rpy_deg"),
        at("/motions/0/load/mass_kg", json!(-1)),
        at("/motions/0/load/center_mm", json!([0, 0])),
        at("/motions/0/load/weight", json!(1)),
        at("/motions/0/load", json!("gripper")),
        at("/motions/0/seconds", json!(1)),
        at("/mount/rpy_deg", json!([0, 90])),
        at("/mount", json!("wall")),
    ] {
        assert!(Program::from_json(&bad.to_string()).is_err(), "the reader takes {bad}");
        assert!(!schema.is_valid(&bad), "the schema takes {bad}");
    }
}
