//! `iiwasim optimise` as a process: the changed program or project, and what it refuses.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::fs;

use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::{Value, json};
use tempfile::tempdir;

use crate::helpers::{cycle_time, figures, fixture, program};
use crate::run::iiwasim;

fn path(name: &str) -> String {
    fixture(name).display().to_string()
}

fn seconds(report: &Value, key: &str) -> f64 {
    report[key].as_f64().unwrap()
}

#[test]
fn the_written_program_takes_as_long_as_stated() {
    let (folder, program) = (tempdir().unwrap(), path("pick-and-place.json"));
    let free = "e1,blends,speeds";
    let arguments = ["optimise", &program, "--free", free, "-o", "faster.json", "--json"];
    let report = figures(iiwasim(&folder, &arguments));
    let changed_s = seconds(&report, "changed_cycle_time_s");
    assert!((cycle_time(&folder, "faster.json") - changed_s).abs() < 1e-9);
    assert!((cycle_time(&folder, &program) - seconds(&report, "cycle_time_s")).abs() < 1e-9);
    assert!(changed_s < 0.85 * seconds(&report, "cycle_time_s"), "{report}");
    assert_eq!(report["complete"], json!(true));
    assert_eq!(report["checked_for_collisions"], json!(false));
    let differences = &report["differences"];
    assert!(differences["motions"].as_array().is_some_and(|motions| motions.len() > 3), "{report}");

    // A file that may have been edited is kept.
    iiwasim(&folder, &arguments).code(2).stderr(contains("faster.json exists"));
    iiwasim(&folder, &["optimise", &program, "--free", free, "-o", "faster.json", "--overwrite"])
        .success()
        .stdout(
            contains("plans compared")
                .and(contains("not checked for collisions"))
                .and(contains("Cycle time")),
        );
}

/// The bound is known where elbow angles alone may change, between stops.
#[test]
fn a_lower_bound_is_printed() {
    let (folder, program) = (tempdir().unwrap(), path("production/move-a-casting.json"));
    let arguments = ["optimise", &program, "-o", "faster.json"];
    let shown = iiwasim(&folder, &arguments).success();
    shown.stdout(contains("for E1 in steps of 1 deg: ").and(contains("(0.0 % below the result)")));
    let again = [&arguments[..], &["--overwrite", "--json"]].concat();
    let report = figures(iiwasim(&folder, &again));
    let bound = &report["lower_bound"];
    let gap_s = seconds(&report, "changed_cycle_time_s") - seconds(bound, "cycle_time_s");
    assert!((0.0..2e-3).contains(&gap_s), "{report}");
    assert_eq!(bound["e1_step_deg"], json!(1));

    let report = figures(iiwasim(&folder, &[&again[..], &["--free", "e1,blends"]].concat()));
    assert_eq!(report["lower_bound"], json!(null));
}

/// The page holds both plans and the changes, and loads nothing.
#[test]
fn a_page_shows_both_plans() {
    let (folder, program) = (tempdir().unwrap(), path("pick-and-place.json"));
    let free = ["--free", "blends", "-o", "faster.json", "--json"];
    let arguments = [&["optimise", &program, "--page", "both.html"][..], &free].concat();
    let report = figures(iiwasim(&folder, &arguments));
    let page = fs::read_to_string(folder.path().join("both.html")).unwrap();
    let (_, data) = page.split_once(r#"<script id="data" type="application/json">"#).unwrap();
    let data: Value = serde_json::from_str(data.split_once("</script>").unwrap().0).unwrap();
    for (plan, key) in [(0, "cycle_time_s"), (1, "changed_cycle_time_s")] {
        let plan = &data["plans"][plan];
        // With the standstill at the end.
        let motion_s = seconds(&report, key) - seconds(plan, "end_s");
        assert!((0.0..0.1).contains(&motion_s), "{motion_s}");
        assert!(plan["html"].as_str().unwrap().contains(r#"class="framed""#));
    }
    let changes = report["changes"].as_array().unwrap().len();
    assert_eq!(data["changes"]["rows"].as_array().unwrap().len(), changes);
    assert!(!page.contains("src=\\\"http") && !page.contains("src=\"http"));

    for (wrong, code, message) in [
        ("both.json", 2, "written as HTML"),
        (&*program, 2, "over the program"),
        ("no/such/folder.html", 1, "no such folder"),
    ] {
        let arguments = ["optimise", &program, "-o", "other.json", "--page", wrong];
        iiwasim(&folder, &arguments).code(code).stderr(contains(message));
        assert!(!folder.path().join("other.json").exists());
    }
}

/// Elbow angles are free by default, and nothing else.
#[test]
fn what_is_not_free_stays() {
    let (folder, program) = (tempdir().unwrap(), path("ten-motions.json"));
    let arguments = ["optimise", &program, "-o", "same.json"];
    iiwasim(&folder, &arguments)
        .success()
        .stdout(contains("nothing was changed"))
        .stderr(contains("--free e1,blends,speeds"));
    assert_eq!(cycle_time(&folder, "same.json"), cycle_time(&folder, &program));
    iiwasim(&folder, &["optimise", &program, "--free", "order", "-o", "a.json"])
        .code(2)
        .stderr(contains("possible values: e1, blends, speeds"));
    iiwasim(&folder, &["optimise", &program]).code(2).stderr(contains("--output"));
    assert!(!folder.path().join("a.json").exists());
}

/// In the cage, each motion keeps its distance.
#[test]
fn clearances_are_kept_in_a_scene() {
    let (folder, program, cage) =
        (tempdir().unwrap(), path("pick-and-place.json"), path("cage.json"));
    let nearest = |program: &str| {
        let arguments = ["plan", program, "--no-output", "--json", "--scene", &cage];
        let planned = figures(iiwasim(&folder, &arguments));
        planned["clearance"]["distance_mm"].as_f64().unwrap()
    };
    let free = ["--free", "e1,blends,speeds", "--scene", &cage, "--json"];
    let far = ["optimise", &program, "--min-clearance", "1000", "-o", "far.json"];
    let far = figures(iiwasim(&folder, &[&far[..], &free].concat()));
    assert_eq!(far["checked_for_collisions"], json!(true));
    assert!(nearest("far.json") > nearest(&program) - 0.2, "{far}");
    let near = ["optimise", &program, "-o", "near.json"];
    let near = figures(iiwasim(&folder, &[&near[..], &free].concat()));
    assert!(nearest("near.json") > 9.8_f64.min(nearest(&program) - 0.2));
    assert!(
        seconds(&near, "changed_cycle_time_s") < seconds(&far, "changed_cycle_time_s") - 1e-3,
        "{near} {far}"
    );
}

#[test]
fn a_program_of_waits_is_written_as_it_is() {
    let folder = tempdir().unwrap();
    let waits = program(r#"{ "type": "wait", "seconds": 1.0 }"#);
    fs::write(folder.path().join("waits.json"), waits).unwrap();
    let arguments = ["optimise", "waits.json", "--free", "e1,blends,speeds", "-o", "out.json"];
    iiwasim(&folder, &arguments).success().stdout(contains("nothing was changed"));
    assert_eq!(cycle_time(&folder, "out.json"), 1.0);
}

/// The exported project, imported and planned again, has the stated cycle time.
#[cfg(feature = "sunrise")]
#[test]
fn a_project_becomes_a_faster_project() {
    let (folder, project) = (tempdir().unwrap(), path("sunrise/cell"));
    let free = ["--free", "e1,blends,speeds", "--json"];
    let arguments = [&["optimise", &project, "-o", "faster"][..], &free].concat();
    let report = figures(
        iiwasim(&folder, &arguments).stderr(contains("the application Faster; the arm must be at")),
    );
    let changed_s = seconds(&report, "changed_cycle_time_s");
    assert!(changed_s < 0.8 * seconds(&report, "cycle_time_s"), "{report}");
    let again = ["plan", "faster", "--application", "Faster", "--no-output", "--json"];
    let again_s = figures(iiwasim(&folder, &again))["cycle_time_s"].as_f64().unwrap();
    assert!((again_s - changed_s).abs() < 1e-9);
    for change in report["changes"].as_array().unwrap() {
        assert!(change["source"].as_str().unwrap().contains("Palletising.java:"), "{change}");
    }
    iiwasim(&folder, &arguments).code(2).stderr(contains("faster"));
    // The project that is read is kept.
    for inside in ["faster", "faster/src"] {
        let arguments = ["optimise", "faster", "--application", "Faster", "-o", inside];
        iiwasim(&folder, &[&arguments[..], &["--overwrite"]].concat())
            .code(2)
            .stderr(contains("lie in each other"));
    }
}

/// The written program names the robot that it was planned for.
#[test]
fn another_robot_is_written_with_the_program() {
    let (folder, program) = (tempdir().unwrap(), path("ten-motions.json"));
    let free = ["--free", "blends", "--robot", "lbr_iiwa_14_r820", "--json"];
    let arguments = [&["optimise", &program, "-o", "large.json"][..], &free].concat();
    let report = figures(iiwasim(&folder, &arguments));
    let changed_s = seconds(&report, "changed_cycle_time_s");
    assert!((cycle_time(&folder, "large.json") - changed_s).abs() < 1e-9);
    iiwasim(&folder, &["optimise", "large.json", "-o", "large.json", "--overwrite"])
        .code(2)
        .stderr(contains("would be written over the program"));
}
