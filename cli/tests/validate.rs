//! `iiwasim validate` as a process: a recording and a program in, a table and a score out.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::fs;

use iiwa_log::JointLog;
use predicates::{
    prelude::PredicateBooleanExt,
    str::{contains, is_empty},
};
use tempfile::{TempDir, tempdir};

use crate::helpers::fixture;
use crate::run::iiwasim;

/// Returns a folder with a program in `secret/program.json`, and with `secret/log.csv`: the motion
/// of a robot with the ramps of `timing` at an override of 50 %.
fn recorded(timing: &str) -> TempDir {
    let folder = tempdir().unwrap();
    let secret = folder.path().join("secret");
    fs::create_dir(&secret).unwrap();
    fs::copy(fixture("waits-and-stops.json"), secret.join("program.json")).unwrap();
    let plan = ["plan", "secret/program.json", "-o", "plan.mcap", "--timing", timing];
    iiwasim(&folder, &[&plan[..], &["--override", "50", "--rate", "500"]].concat()).success();
    let plan = fs::read(folder.path().join("plan.mcap")).unwrap();
    let log = JointLog::read(&*plan).unwrap();
    let t_s = log.t_s.iter().map(|t_s| 7.0 + t_s).collect();
    let mut csv = Vec::new();
    JointLog::new(t_s, log.q_rad).write_csv(&mut csv).unwrap();
    fs::write(secret.join("log.csv"), csv).unwrap();
    folder
}

const FILES: [&str; 3] = ["validate", "secret/program.json", "secret/log.csv"];

fn figures(folder: &TempDir, options: &[&str]) -> serde_json::Value {
    let output = iiwasim(folder, &[&FILES[..], &["--json"], options].concat()).success();
    serde_json::from_slice(&output.get_output().stdout).unwrap()
}

#[test]
fn a_plan_of_the_same_robot_scores_zero() {
    let folder = recorded("sunrise");
    iiwasim(&folder, &[&FILES[..], &["--override", "50"]].concat())
        .success()
        .stdout(
            contains("Time        off by 0.00 % (median)")
                .and(contains("Recording   log.csv: a table, 500 Hz"))
                .and(contains("timing sunrise, override 50 %"))
                .and(contains("secret").not()),
        )
        .stderr(is_empty());
    let actual = figures(&folder, &["--override", "50"]);
    assert_eq!(
        (&actual["recording"], &actual["program"]),
        (&"log.csv".into(), &"program.json".into())
    );
    assert!(!actual.to_string().contains("secret"));
    let motions = actual["motions"].as_array().unwrap();
    assert_eq!(motions.len(), 8);
    // At the override, motions take twice as long as planned at full speed.
    let first = &motions[0];
    let [planned, measured] = ["planned_s", "measured_s"].map(|key| first[key].as_f64().unwrap());
    assert!((planned - measured).abs() < 1e-6 && (0.9..1.2).contains(&planned), "{first}");
    // The duration of waits does not depend on the override.
    let wait = &motions[2];
    assert_eq!((&wait["type"], &wait["planned_s"]), (&"wait".into(), &0.5.into()));
    assert!(wait["error_percent"].as_f64().unwrap().abs() < 0.1, "{wait}");
    for key in
        ["/score/time_percent/worst", "/score/joint_off_deg/worst", "/score/tcp_off_mm/worst"]
    {
        let worst = actual.pointer(key).unwrap().as_f64().unwrap();
        assert!(worst < 1e-3, "{key}: {worst}");
    }
}

#[test]
fn names_are_shown() {
    let folder = recorded("sunrise");
    let path = folder.path().join("secret/program.json");
    let mut program: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    program["motions"][0]["name"] = "to the pallet".into();
    fs::write(&path, program.to_string()).unwrap();
    let at_half = ["--override", "50"];
    iiwasim(&folder, &[&FILES[..], &at_half].concat())
        .success()
        .stdout(contains("motion  type  name").and(contains("     1  ptp   to the pallet")));
    let motions = &figures(&folder, &at_half)["motions"];
    assert_eq!(motions[0]["name"], "to the pallet");
    assert!(motions[1].get("name").is_none(), "{motions}");
    let plan = ["plan", "secret/program.json", "-o", "named.mcap"];
    iiwasim(&folder, &[&plan[..], &at_half].concat()).success();
    iiwasim(&folder, &["compare", "named.mcap", "secret/log.csv"])
        .success()
        .stdout(contains("motion  type  name").and(contains("     1  ptp   to the pallet")));
}

#[test]
fn other_ramps_and_overrides_show() {
    let folder = recorded("jerk");
    let actual = figures(&folder, &["--override", "50"]);
    let worst = actual.pointer("/score/time_percent/worst").unwrap().as_f64().unwrap();
    assert!(worst > 1.0, "{worst}");
    let actual = figures(&folder, &["--override", "50", "--timing", "jerk"]);
    assert!(actual.pointer("/score/time_percent/worst").unwrap().as_f64().unwrap() < 0.01);
    iiwasim(&folder, &[&FILES[..], &["--timing", "jerk"]].concat())
        .success()
        .stdout(contains("Note: most motions took far longer than planned: was the robot in T1"));
}

#[test]
fn faults_are_reported() {
    let folder = recorded("sunrise");
    for (arguments, words) in [
        (&["validate", "secret/log.csv", "secret/program.json"][..], "secret/log.csv"),
        (&["validate", "secret/program.json", "secret/none.csv"], "cannot read secret/none.csv"),
        (&["validate", "secret/program.json"], "RECORDING"),
        (
            &["validate", "secret/program.json", "secret/log.csv", "--override", "120"],
            "0.1 to 100 %",
        ),
    ] {
        iiwasim(&folder, arguments).code(2).stdout(is_empty()).stderr(contains(words));
    }
}
