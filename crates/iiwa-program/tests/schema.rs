//! The JSON Schema and the reader agree on what a program is.

// Helpers of tests may fail.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::{fs, path::Path};

use iiwa_program::Program;
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

    let at = |pointer: &str, value: Value| {
        let mut program = good.clone();
        let (owner, key) = pointer.rsplit_once('/').unwrap();
        match program.pointer_mut(owner).unwrap() {
            Value::Object(object) => object.insert(key.to_owned(), value),
            Value::Array(array) => {
                array.get_mut(key.parse::<usize>().unwrap()).map(|v| std::mem::replace(v, value))
            }
            _ => panic!("{pointer}"),
        };
        program
    };
    let without = |pointer: &str| {
        let mut program = good.clone();
        let (owner, key) = pointer.rsplit_once('/').unwrap();
        program.pointer_mut(owner).unwrap().as_object_mut().unwrap().remove(key).unwrap();
        program
    };
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
