//! Outputs: names, permissions, two of one name; help that cannot be printed.

use std::{fs, process::Command};

use predicates::str::contains;
use tempfile::tempdir;

use crate::run::{files, iiwasim};

const PROGRAM: &str = r#"{
    "version": 1,
    "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
    "motions": [{ "type": "ptp", "joints_deg": [10, 30, 0, -60, 0, 90, 0] }]
}"#;

#[expect(clippy::unwrap_used, reason = "a test fails by it")]
fn with_program() -> tempfile::TempDir {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("go.json"), PROGRAM).unwrap();
    folder
}

#[test]
fn outputs_that_would_lose_another_are_refused() {
    let folder = with_program();
    for (arguments, message) in [
        (
            &["-o", "same", "--csv", "./same"][..],
            "over the trajectory, same; name another file with --csv",
        ),
        (
            &["-o", "p.mcap", "--csv", "p", "--picture", "./p.svg", "--scene", "p.svg"],
            "over the scene",
        ),
        (
            &["--no-output", "--csv", "p.svg", "--picture", "p.svg"],
            "written as CSV, in a file *.csv",
        ),
        (&["-o", "plan.csv"], "plan.csv: the trajectory is written as MCAP, in a file *.mcap"),
        (&["-o", "plan.JSON"], "written as MCAP"),
        (&["-o", "-"], "cannot be written to standard output"),
        (&["--no-output", "--csv", "-"], "cannot be written to standard output"),
    ] {
        let arguments = [&["plan", "go.json"], arguments].concat();
        iiwasim(&folder, &arguments).code(2).stderr(contains(message));
        assert_eq!(files(&folder), ["go.json"], "{arguments:?}");
    }
    iiwasim(&folder, &["plan", "go.json", "-o", "plan.bag"]).success();
    iiwasim(&folder, &["report", "plan.bag", "-o", "x.pdf"]).code(2).stderr(contains("as HTML"));
    let identify = ["identify", "plan.bag", "-o", "x.mcap"];
    iiwasim(&folder, &identify).code(2).stderr(contains("written as JSON"));
}

#[test]
fn gates_compare_at_the_precision_that_they_print() {
    let folder = with_program();
    let planned = |limit: &str| {
        iiwasim(&folder, &["plan", "go.json", "--no-output", "--json", "--max-cycle-time", limit])
    };
    let output = planned("100").success();
    let figures: serde_json::Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    let cycle_time_s = figures["cycle_time_s"].as_f64().unwrap();
    let shown = format!("{cycle_time_s:.3}");
    // The limit that a message would print is met, a millisecond less is not.
    planned(&shown).success();
    let less = format!("{:.3}", shown.parse::<f64>().unwrap() - 1e-3);
    planned(&less).code(3).stderr(contains(format!("takes {shown} s, more than {less} s")));
}

#[test]
fn a_blend_into_a_motion_that_does_not_move_is_reported() {
    let folder = tempdir().unwrap();
    let target = r#""type": "ptp", "joints_deg": [10, 30, 0, -60, 0, 90, 0]"#;
    let motions = format!(
        r#"{{ {target}, "blend": {{ "cart_mm": 50 }} }}, {{ {target} }}, {{ {} }}"#,
        target.replace("10,", "20,")
    );
    let program =
        PROGRAM.replace(r#"{ "type": "ptp", "joints_deg": [10, 30, 0, -60, 0, 90, 0] }"#, &motions);
    fs::write(folder.path().join("go.json"), program).unwrap();
    iiwasim(&folder, &["plan", "go.json", "--no-output"]).success().stderr(contains(
        "motion 2 does not move: the blend of motion 1 has nothing to blend into",
    ));
}

#[test]
fn empty_variables_count_as_unset() {
    let folder = with_program();
    let status = Command::new(env!("CARGO_BIN_EXE_iiwasim"))
        .args(["plan", "go.json", "--no-output"])
        .envs([("IIWASIM_SCENE", ""), ("IIWASIM_ROBOT", ""), ("IIWASIM_ROS_NAMES", "")])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(status.status.success(), "{status:?}");
}

/// Tests against a device that is always full.
#[cfg(target_os = "linux")]
#[test]
fn help_that_cannot_be_printed_is_a_failure() {
    for arguments in [&["--help"][..], &["--version"], &["plan", "--help"]] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_iiwasim"))
            .args(arguments)
            .stdout(full)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert!(stderr.contains("cannot write to standard output"), "{stderr}");
    }
}
