//! Programs that include a file, and targets with an inconsistent turn, as processes.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::{fs, fs::File};

use crate::run::{files, iiwasim};
use iiwa_log::JointLog;
use iiwa_program::Program;
use predicates::{
    prelude::PredicateBooleanExt,
    str::{contains, is_empty},
};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

const CELL: &str = r#"{
  "version": 1,
  "tools": { "gripper": { "tcp": { "z_mm": 120 } } },
  "bases": { "table": { "x_mm": 500, "y_mm": -150, "z_mm": 100 } },
  "frames": {
    "pick": { "base": "table", "x_mm": 0, "y_mm": 0, "z_mm": 150,
      "a_deg": 0, "b_deg": 180, "c_deg": 0, "e1_deg": 0, "status": 2 }
  }
}
"#;

const PROGRAM: &str = r#"{
  "version": 1,
  "include": "cells/cell.json",
  "tool": "gripper",
  "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
  "motions": [{ "type": "ptp", "frame": "pick" }]
}
"#;

/// Returns a folder with a program and its cell.
fn folder(program: &str, cell: &str) -> TempDir {
    let folder = tempdir().unwrap();
    fs::create_dir(folder.path().join("cells")).unwrap();
    fs::write(folder.path().join("cells/cell.json"), cell).unwrap();
    fs::write(folder.path().join("program.json"), program).unwrap();
    folder
}

#[test]
fn a_plan_holds_all_of_its_program() {
    let folder = folder(PROGRAM, CELL);
    iiwasim(&folder, &["plan", "program.json"]).success().stderr(is_empty());
    let log = JointLog::read(File::open(folder.path().join("program.mcap")).unwrap()).unwrap();
    let program = Program::from_json(&log.program.unwrap()).unwrap();
    assert!(program.workcell.frames.contains_key("pick"));
    assert!(program.workcell.tools.contains_key("gripper"));
    // Pages depend on this file alone.
    iiwasim(&folder, &["report", "program.mcap"]).success().stderr(is_empty());
}

#[test]
fn a_program_without_is_stored_as_it_is() {
    let text = PROGRAM
        .replace("\"include\": \"cells/cell.json\",", "")
        .replace("\"tool\": \"gripper\",", "")
        .replace("\"frame\": \"pick\"", "\"joints_deg\": [0, 20, 0, -60, 0, 90, 0]");
    let folder = folder(&text, CELL);
    iiwasim(&folder, &["plan", "program.json"]).success();
    let log = JointLog::read(File::open(folder.path().join("program.mcap")).unwrap()).unwrap();
    assert_eq!(log.program.unwrap(), text);
}

#[test]
fn a_frame_of_the_cell_is_reached() {
    let folder = folder(PROGRAM, CELL);
    let ik = |cell: &str, more: &[&str]| -> Value {
        let arguments = [&["ik", "--json", "--frame", "pick", "--program", cell], more].concat();
        let result = iiwasim(&folder, &arguments).success();
        serde_json::from_slice(&result.get_output().stdout).unwrap()
    };
    // Through a program that includes the cell, or directly.
    let of_program = ik("program.json", &[]);
    assert_eq!(of_program, ik("cells/cell.json", &["--tool", "gripper"]));
    assert!((of_program["frame"]["x_mm"].as_f64().unwrap() - 500.0).abs() < 1e-6);
}

#[test]
fn errors_name_the_file_that_they_are_in() {
    let refuses = |program: &str, cell: &str, reasons: &[&str]| {
        let folder = folder(program, cell);
        let refused = iiwasim(&folder, &["plan", "program.json"]).code(2);
        let stderr = String::from_utf8_lossy(&refused.get_output().stderr).replace("\n  │ ", " ");
        for reason in reasons {
            assert!(stderr.contains(reason), "no {reason:?} in {stderr}");
        }
        assert_eq!(files(&folder), ["cells", "program.json"]);
    };
    let other = |name: &str| PROGRAM.replace("cells/cell.json", name);
    refuses(
        PROGRAM,
        &CELL.replace("500", "\"5\""),
        &["cells/cell.json, line 4, column 33: expected"],
    );
    refuses(PROGRAM, "{", &["cells/cell.json, line 1"]);
    refuses(PROGRAM, "root:x:0", &["program.json, line 3, column 14", "not a JSON object"]);
    refuses(
        &other("none.json"),
        CELL,
        &["program.json, line 3, column 14", "no such file: ./none.json"],
    );
    refuses(&other("../cell.json"), CELL, &["program.json, line 3", "in a folder below that"]);
    refuses(&other("/etc/passwd"), CELL, &["program.json, line 3", "in a folder below that"]);
    refuses(
        PROGRAM,
        &CELL.replace("\"bases\"", "\"include\": \"b.json\", \"bases\""),
        &["cells/cell.json, line 4, column 14", "cannot include other files"],
    );
    // Faults of motions are reported as faults of the program.
    refuses(
        &PROGRAM.replace("pick", "pack"),
        CELL,
        &["program.json, line 6", "unknown frame `pack`"],
    );
}

#[test]
fn a_cell_in_a_folder_of_programs_is_no_program() {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("program.json"), PROGRAM.replace("cells/", "")).unwrap();
    fs::write(folder.path().join("cell.json"), CELL).unwrap();
    iiwasim(&folder, &["plan", ".", "--no-output"])
        .success()
        .stdout(contains("1 planned, 0 failed"));
}

#[test]
fn an_odd_turn_is_worth_a_warning() {
    let program =
        PROGRAM.replace("\"frame\": \"pick\"", "\"frame\": \"pick\", \"velocity_rel\": 0.5");
    let cell = CELL.replace("\"status\": 2", "\"status\": 2, \"turn\": 127");
    let folder = folder(&program, &cell);
    let warning = "motion 1: the frame states turn 127, and the joints there have turn";
    iiwasim(&folder, &["plan", "program.json"])
        .success()
        .stderr(contains(format!("Warning: {warning}")));
    fs::copy(folder.path().join("program.json"), folder.path().join("same.json")).unwrap();
    iiwasim(&folder, &["plan", "program.json", "same.json", "--no-output", "--json"])
        .success()
        .stderr(contains(format!("Warning: program.json: {warning}")))
        .stderr(contains(format!("Warning: same.json: {warning}")))
        .stdout(contains("cycle_time_s").and(contains("Warning").not()));
    iiwasim(&folder, &["ik", "--program", "program.json", "--frame", "pick"])
        .success()
        .stderr(contains("Warning: the frame states turn 127"));
}

#[test]
fn a_stop_within_a_spline_is_worth_a_warning() {
    let spline = r#"{ "version": 1, "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
        "motions": [{ "type": "spline", "segments": [
            { "type": "lin", "frame": { "x_mm": 600, "y_mm": 100, "z_mm": 400,
                "a_deg": 180, "b_deg": 0, "c_deg": 180 } },
            { "type": "lin", "frame": { "x_mm": 600, "y_mm": 100, "z_mm": 300,
                "a_deg": 180, "b_deg": 0, "c_deg": 180 } }
        ] }] }"#;
    let folder = folder(spline, CELL);
    iiwasim(&folder, &["plan", "program.json", "--no-output"])
        .success()
        .stderr(contains("Warning: motion 1: the TCP stops once within the spline"));
}

#[test]
fn files_of_other_kinds_are_named_by_their_kind() {
    let folder = folder(PROGRAM, CELL);
    let cases = [
        ("scene.json", r#"{ "version": 1, "obstacles": [] }"#, "is a scene, not a program"),
        ("robot.json", r#"{ "version": 1, "settle_time_s": 0.1 }"#, "is a robot profile"),
        ("cell.json", CELL, "is a file of tools, bases and frames"),
        ("empty.json", r#"{ "version": 1 }"#, "the key `start` is missing"),
    ];
    for (name, text, message) in cases {
        fs::write(folder.path().join(name), text).unwrap();
        iiwasim(&folder, &["plan", name, "--no-output"]).code(2).stderr(contains(message));
    }
    // The opposite mix-up.
    for (option, message) in [
        ("--scene", "program.json is a motion program, not a scene"),
        ("--robot", "program.json is a motion program, not a robot profile"),
    ] {
        iiwasim(&folder, &["plan", "program.json", "--no-output", option, "program.json"])
            .code(2)
            .stderr(contains(message));
    }
    iiwasim(&folder, &["plan", "program.json", "--no-output", "--robot", "scene.json"])
        .code(2)
        .stderr(contains("is a scene, not a robot profile: it belongs to --scene"));
    iiwasim(&folder, &["plan", "program.json", "-o", "plan.mcap"]).success();
    iiwasim(&folder, &["plan", "plan.mcap"]).code(2).stderr(contains("an MCAP file"));
}

#[test]
fn prints_the_schema() {
    let folder = tempdir().unwrap();
    iiwasim(&folder, &["schema", "frames"]).success().stdout(contains("iiwasim frames"));
}

#[test]
fn marks_end_between_characters() {
    let long_name = format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": [0, 30, 0, -60, 0, 90, 0] }},
        "motions": [{{ "type": "ptp", "frame": "{}" }}] }}"#,
        "ü".repeat(50)
    );
    for text in [long_name.as_str(), "\u{feff}\u{feff}1"] {
        let folder = tempdir().unwrap();
        fs::write(folder.path().join("program.json"), text).unwrap();
        let command = ["plan", "program.json", "--no-output"];
        iiwasim(&folder, &command).code(2).stderr(contains("Error: program.json, line "));
    }
}
