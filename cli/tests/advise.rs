//! `iiwasim advise` as a process: its rows, the changed program, scenes and wrong usage.

use std::fs;

use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::{Value, json};
use tempfile::tempdir;

use crate::helpers::{cycle_time, figures, fixture, program};
use crate::run::iiwasim;

const FIXTURES: [&str; 4] =
    ["appendix-b.json", "pick-and-place.json", "ten-motions.json", "waits-and-stops.json"];

fn path(name: &str) -> String {
    fixture(name).display().to_string()
}

#[test]
fn the_plan_of_a_changed_program_saves_as_much_as_its_row_says() {
    let mut rows = 0;
    for name in FIXTURES {
        let (folder, program) = (tempdir().unwrap(), path(name));
        let before_s = cycle_time(&folder, &program);
        let advice = figures(iiwasim(&folder, &["advise", &program, "--json"]));
        assert!((advice["cycle_time_s"].as_f64().unwrap() - before_s).abs() < 1e-9);
        for row in advice["changes"].as_array().unwrap().iter().take(3) {
            let number = row["row"].to_string();
            let changed = format!("{number}.json");
            let arguments = ["advise", &program, "--apply", &number, "-o", &changed];
            iiwasim(&folder, &arguments).success();
            let saved_s = before_s - cycle_time(&folder, &changed);
            let expected_s = row["saved_s"].as_f64().unwrap();
            assert!((saved_s - expected_s).abs() < 1e-6, "{name}: {row} {saved_s}");
            rows += 1;
        }
    }
    assert!(rows > 5, "{rows}");
}

#[test]
fn all_changes_together_are_the_faster_program() {
    let (folder, program) = (tempdir().unwrap(), path("pick-and-place.json"));
    let arguments = ["advise", &program, "--apply", "all", "-o", "all.json", "--json"];
    let advice = figures(iiwasim(&folder, &arguments));
    let expected_s = advice["changed_cycle_time_s"].as_f64().unwrap();
    assert!((cycle_time(&folder, "all.json") - expected_s).abs() < 1e-6);
    assert!(expected_s < advice["cycle_time_s"].as_f64().unwrap());
    assert_eq!(advice["checked_for_collisions"], json!(false));
    iiwasim(&folder, &["advise", &program])
        .success()
        .stdout(contains("not checked for collisions").and(contains("Cycle time")));
    // A program is not written over another file.
    iiwasim(&folder, &["advise", &program, "--apply", "1", "-o", "all.json"])
        .code(2)
        .stderr(contains("all.json exists"));
}

/// In the cage, changes are checked. If the arm has to stay a metre away, which it does not in the
/// unchanged program, no change may bring it nearer.
#[test]
fn a_scene_removes_changes_that_come_nearer() {
    let (folder, program, cage) =
        (tempdir().unwrap(), path("pick-and-place.json"), path("cage.json"));
    let nearest = |program: &str| {
        let arguments = ["plan", program, "--no-output", "--json", "--scene", &cage];
        let planned = figures(iiwasim(&folder, &arguments));
        planned["clearance"]["distance_mm"].as_f64().unwrap()
    };
    let arguments = ["advise", &program, "--json", "--scene", &cage];
    let all = figures(iiwasim(&folder, &arguments));
    assert_eq!(all["checked_for_collisions"], json!(true));
    let options = ["--min-clearance", "1000", "--apply", "all", "-o", "near.json"];
    let near = figures(iiwasim(&folder, &[&arguments[..], &options].concat()));
    let changed_s = |advice: &Value| advice["changed_cycle_time_s"].as_f64().unwrap();
    assert!(changed_s(&near) > changed_s(&all) + 1e-3, "{near} {all}");
    assert!(changed_s(&near) < near["cycle_time_s"].as_f64().unwrap());
    assert!(nearest("near.json") > nearest(&program) - 1e-6);
}

/// A change that touches an obstacle cannot be told from a program that does.
#[test]
fn a_program_in_contact_is_not_checked() {
    let (folder, program) = (tempdir().unwrap(), path("pick-and-place.json"));
    let scene = json!({
        "version": 1,
        "obstacles": [{ "name": "crate", "type": "box", "center_mm": [500, 0, 300],
            "size_mm": [400, 400, 400] }]
    });
    fs::write(folder.path().join("crate.json"), scene.to_string()).unwrap();
    iiwasim(&folder, &["advise", &program, "--scene", "crate.json"])
        .code(2)
        .stderr(contains("the arm touches crate in motion"));
}

#[test]
fn wrong_usage_is_explained() {
    let (folder, program) = (tempdir().unwrap(), path("ten-motions.json"));
    iiwasim(&folder, &["advise", &program, "--apply", "99", "-o", "a.json"])
        .code(2)
        .stderr(contains("no row 99"));
    assert!(!folder.path().join("a.json").exists());
    iiwasim(&folder, &["advise", &program, "--apply", "x", "-o", "a.json"])
        .code(2)
        .stderr(contains("is not the number of a row"));
    iiwasim(&folder, &["advise", &program, "--apply", "1,1", "-o", "a.json"])
        .code(2)
        .stderr(contains("has a row twice"));
    iiwasim(&folder, &["advise", &program, "--apply", "1"]).code(2).stderr(contains("--output"));
    iiwasim(&folder, &["advise", "missing.json"]).code(2).stderr(contains("cannot read"));
}

/// Programs without anything to change stay as they are, and say so.
#[test]
fn a_program_of_waits_has_no_rows() {
    let folder = tempdir().unwrap();
    let waits = program(r#"{ "type": "wait", "seconds": 1.0 }"#);
    fs::write(folder.path().join("waits.json"), waits).unwrap();
    iiwasim(&folder, &["advise", "waits.json"])
        .success()
        .stdout(contains("none of the changes that were tried"));
}

#[cfg(feature = "sunrise")]
#[test]
fn rows_of_a_project_name_lines_of_java() {
    let folder = tempdir().unwrap();
    let advice = figures(iiwasim(&folder, &["advise", &path("sunrise/cell"), "--json"]));
    let rows = advice["changes"].as_array().unwrap();
    assert!(!rows.is_empty());
    for row in rows {
        assert!(row["source"].as_str().unwrap().contains("Palletising.java:"), "{row}");
    }
}
