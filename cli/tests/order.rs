//! `iiwasim order` as a process: the fastest order, the program in that order, and what it refuses.

use std::fs;

use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::Value;
use tempfile::tempdir;

use crate::helpers::{cycle_time, figures, fixture};
use crate::run::iiwasim;

/// Groups of the tasks in the order of a report.
fn groups(report: &Value) -> Vec<&str> {
    let tasks = report["tasks"].as_array().into_iter().flatten();
    tasks.filter_map(|task| task["group"].as_str()).collect()
}

#[test]
fn the_written_program_takes_as_long_as_stated() {
    let folder = tempdir().unwrap();
    let input = fixture("screws.json").display().to_string();
    let arguments = ["order", &input, "-o", "ordered.json", "--json"];
    let report = figures(iiwasim(&folder, &arguments));
    let changed_s = report["changed_cycle_time_s"].as_f64().unwrap();
    assert!(changed_s < report["cycle_time_s"].as_f64().unwrap(), "{report}");
    assert!((cycle_time(&folder, "ordered.json") - changed_s).abs() < 1e-6);
    assert_eq!(
        (&report["all_compared"], &report["checked_for_collisions"]),
        (&true.into(), &false.into())
    );
    let text = fs::read_to_string(folder.path().join("ordered.json")).unwrap();
    let written: Value = serde_json::from_str(&text).unwrap();
    let motions = written["motions"].as_array().unwrap();
    let firsts: Vec<_> = motions.iter().step_by(4).filter_map(|it| it["group"].as_str()).collect();
    assert_eq!(firsts, groups(&report));
    assert_eq!(written["tasks"].as_array().unwrap().len(), 8);

    iiwasim(&folder, &["order", &input]).success().stdout(
        contains("place  was     task")
            .and(contains("70 plans; all allowed orders compared"))
            .and(contains("not checked for collisions")),
    );
    // The fastest order stays as it is. A program that may have been edited is kept.
    iiwasim(&folder, &["order", "ordered.json"]).success().stdout(contains("No other order"));
    iiwasim(&folder, &arguments).code(2).stderr(contains("ordered.json exists"));
    let again = ["order", "ordered.json", "-o", "again.json"];
    iiwasim(&folder, &again).success().stderr(contains("again.json is the unchanged program"));
}

/// A motion to a task on another way may come nearer to an obstacle than before.
#[test]
fn the_order_keeps_clearances() {
    let folder = tempdir().unwrap();
    let input = fixture("screws.json").display().to_string();
    let scene = r#"{ "version": 1, "obstacles": [{ "type": "box", "name": "post",
        "size_mm": [40, 40, 170], "center_mm": [550, 0, 175] }] }"#;
    fs::write(folder.path().join("scene.json"), scene).unwrap();
    let arguments = ["order", &input, "--scene", "scene.json", "--json"];
    let near = figures(iiwasim(&folder, &arguments));
    assert_eq!(near["checked_for_collisions"], true);
    let far = [&arguments[..], &["--min-clearance", "150"]].concat();
    let far = figures(iiwasim(&folder, &far));
    assert_ne!(groups(&near), groups(&far));
    let time_s = |report: &Value| report["changed_cycle_time_s"].as_f64().unwrap();
    assert!(time_s(&near) < time_s(&far) && time_s(&far) < far["cycle_time_s"].as_f64().unwrap());
}

#[test]
fn programs_without_tasks_are_refused() {
    let folder = tempdir().unwrap();
    let input = fixture("pick-and-place.json").display().to_string();
    iiwasim(&folder, &["order", &input]).code(2).stderr(contains("lists no `tasks`"));
    let screws = fixture("screws.json").display().to_string();
    iiwasim(&folder, &["order", &screws, "-o", &screws]).code(2).stderr(contains("--output"));
    let text = fs::read_to_string(&screws).unwrap().replace(r#""screw 2"] }"#, r#""screw 9"] }"#);
    fs::write(folder.path().join("unknown.json"), text).unwrap();
    iiwasim(&folder, &["order", "unknown.json"]).code(2).stderr(
        contains("`after` names `screw 9`, which is not a task").and(contains("unknown.json:")),
    );
}
