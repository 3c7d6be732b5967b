//! TCP paths with results of 40-digit arithmetic and the durations of an independent solver, in
//! `fixtures/reference/cartesian.json`.

#![expect(clippy::panic, reason = "a test fails by it")]

use iiwa_kin::Robot;
use iiwa_program::Program;
use serde_json::{Value, json};

/// Motion from rest to rest, with its reference results.
#[derive(Debug)]
pub struct CartesianCase {
    /// Number and kind of the case.
    pub id: String,
    /// Robot model.
    pub robot: Robot,
    /// Program with this motion only.
    pub program: Program,
    /// Entry in the file, with all reference results.
    pub entry: Value,
}

/// Returns all cases.
///
/// # Panics
///
/// Panics if the file is missing or not as expected.
#[must_use]
pub fn cartesian_cases() -> Vec<CartesianCase> {
    let text = std::fs::read_to_string(crate::fixture("reference/cartesian.json"))
        .unwrap_or_else(|error| panic!("the reference paths: {error}"));
    let mut file: Value =
        serde_json::from_str(&text).unwrap_or_else(|error| panic!("the reference paths: {error}"));
    let Value::Array(entries) = file["cases"].take() else {
        panic!("the reference paths: no cases");
    };
    entries.into_iter().map(case).collect()
}

fn case(entry: Value) -> CartesianCase {
    let id = entry["id"].as_str().unwrap_or_default().to_owned();
    let robot = robot(&entry).unwrap_or_else(|| panic!("reference path {id}: no robot"));
    let program = program(&entry).unwrap_or_else(|error| panic!("reference path {id}: {error}"));
    CartesianCase { id, robot, program, entry }
}

fn robot(entry: &Value) -> Option<Robot> {
    let flange_m = entry["lengths_m"][3].as_f64()?;
    Robot::built_in(entry["robot"].as_str()?)?.with_flange_m(flange_m).ok()
}

fn program(entry: &Value) -> Result<Program, iiwa_program::ProgramError> {
    let mut text = json!({
        "version": 1,
        "start": { "joints_deg": entry["start_joints_deg"] },
        "motions": [entry["motion"]],
    });
    if !entry["tool"].is_null() {
        text["tools"] = json!({ "tool": { "tcp": entry["tool"] } });
        text["tool"] = json!("tool");
    }
    if !entry["base"].is_null() {
        text["bases"] = json!({ "base": entry["base"] });
        text["base"] = json!("base");
    }
    Program::from_json(&text.to_string())
}
