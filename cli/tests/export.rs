//! `iiwasim export` as a process.

use std::fs;

use crate::run::{files, iiwasim};
use assert_cmd::{assert::Assert, cargo::cargo_bin_cmd};
use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

const PROGRAM: &str = r#"{
  "version": 1,
  "mount": { "rpy_deg": [180, 0, 0] },
  "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
  "motions": [
    { "type": "ptp", "joints_deg": [0, 42, 0, -44, 0, 90, 0], "blend": { "cart_mm": 30 } },
    { "type": "lin_rel", "offset": { "z_mm": 20 } }
  ]
}"#;

/// Exports `a.json` to the folder `station`.
fn export(folder: &TempDir, more: &[&str]) -> Assert {
    iiwasim(folder, &[&["export", "--sunrise", "a.json", "-o", "station"], more].concat())
}

#[test]
fn a_program_becomes_a_project() {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("two-motions.json"), PROGRAM).unwrap();
    iiwasim(&folder, &["export", "--sunrise", "two-motions.json", "-o", "station"])
        .success()
        .stdout(contains("the application TwoMotions").and(contains("0,30,0,-60,0,90,0 deg")))
        .stderr(contains("Note: `mount`: "));
    let station = folder.path().join("station");
    let java = fs::read_to_string(station.join("src/application/TwoMotions.java")).unwrap();
    assert!(java.contains("public class TwoMotions extends RoboticsAPIApplication {"));
    assert!(java.contains("lbr.moveAsync(ptp("));
}

#[test]
fn the_answer_in_json_names_class_files_and_start() {
    let folder = tempdir().unwrap();
    let output = cargo_bin_cmd!("iiwasim")
        .current_dir(&folder)
        .args(["export", "--sunrise", "-", "-o", "station", "--json"])
        .write_stdin(PROGRAM)
        .output()
        .unwrap();
    assert!(output.stderr.is_empty());
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(answer["class"], "MotionProgram");
    assert_eq!(answer["start_deg"][3], -60.0);
    for file in answer["files"].as_array().unwrap() {
        assert!(folder.path().join(file.as_str().unwrap()).exists());
    }
    assert_eq!(answer["notices"].as_array().unwrap().len(), 1);
}

#[test]
fn a_project_that_was_edited_is_kept() {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("a.json"), PROGRAM).unwrap();
    fs::create_dir_all(folder.path().join("station/src")).unwrap();
    fs::write(folder.path().join("station/src/Mine.java"), "class Mine {}").unwrap();
    export(&folder, &[]).code(2).stderr(contains("station exists").and(contains("--overwrite")));
    assert!(!folder.path().join("station/RoboticsAPI.data.xml").exists());
    export(&folder, &["--overwrite"]).success();
    assert!(folder.path().join("station/RoboticsAPI.data.xml").exists());
    assert!(folder.path().join("station/src/Mine.java").exists());
}

#[test]
fn unsupported_motions_are_shown_at_their_place() {
    let folder = tempdir().unwrap();
    let text = PROGRAM.replace(r#""z_mm": 20 }"#, r#""z_mm": 20 }, "e1_deg": 5"#);
    fs::write(folder.path().join("a.json"), text).unwrap();
    export(&folder, &[])
        .code(2)
        .stderr(contains("a.json, line 7").and(contains("motion 2: `e1_deg`: ")));
    export(&folder, &["--name", "1st"]).code(2).stderr(contains("give another one with --name"));
    iiwasim(&folder, &["export", "--sunrise", "a.json", "-o", "no/station"])
        .code(1)
        .stderr(contains("no such folder: no"));
    assert_eq!(files(&folder), ["a.json"]);
    // The format must be named: there may be others later.
    iiwasim(&folder, &["export", "a.json", "-o", "x"]).code(2).stderr(contains("--sunrise"));
}
