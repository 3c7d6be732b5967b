//! `iiwasim identify` as a process: recordings in, a profile out.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::{fs, path::Path};

use iiwa_eval::{
    VirtualRobot,
    experiment::{self, Trial},
};
use iiwa_kin::Robot;
use predicates::{
    prelude::PredicateBooleanExt,
    str::{contains, is_empty},
};
use tempfile::{TempDir, tempdir};

use crate::run::{files, iiwasim};

/// Runs a trial on a robot that is slower than the model and has a longer settle time; writes
/// NAME.json and NAME.csv.
fn record(folder: &Path, trial: &Trial) {
    let mut limits = *Robot::default().limits();
    limits.velocity_rad_s = limits.velocity_rad_s.map(|limit| 0.9 * limit);
    let robot = Robot::default()
        .with_limits(limits)
        .with_settle_time_s(0.08)
        .with_blend_kappa([-3.5, 0.006, 0.0003]);
    let mut robot = VirtualRobot::new(robot, 1);
    robot.noise_rad = 1e-5;
    let log = robot.run(&trial.program).unwrap();
    let mut csv = Vec::new();
    log.write_csv(&mut csv).unwrap();
    let file = folder.join(&trial.name);
    fs::write(file.with_extension("csv"), csv).unwrap();
    fs::write(file.with_extension("json"), trial.program.to_json()).unwrap();
}

fn wide(folder: &TempDir) {
    record(folder.path(), experiment::limits().last().unwrap());
}

#[test]
fn a_profile_that_plans() {
    let folder = tempdir().unwrap();
    wide(&folder);
    iiwasim(&folder, &["identify", "wide.csv", "--program", "wide.json", "--name", "cell 3"])
        .success()
        .stdout(
            contains("A1  88.")
                .and(contains("Settles for 0.0800"))
                .and(contains("kappa over gamma: not found"))
                .and(contains("Profile of cell 3 in identified.json")),
        )
        .stderr(is_empty());
    let robot =
        Robot::from_profile(&fs::read_to_string(folder.path().join("identified.json")).unwrap())
            .unwrap();
    assert_eq!(robot.name(), "cell 3");
    let velocity = robot.limits().velocity_rad_s.map(f64::to_degrees);
    for (actual, model) in velocity.iter().zip([98.0, 98.0, 100.0, 130.0, 140.0, 180.0, 180.0]) {
        assert!((actual / (0.9 * model) - 1.0).abs() < 1e-4, "{velocity:?}");
    }
    iiwasim(&folder, &["plan", "wide.json", "--robot", "identified.json", "--no-output"])
        .success()
        .stdout(contains("Planned for cell 3; limits: velocity"));
}

#[test]
fn blends_from_a_recording_that_holds_its_program() {
    let folder = tempdir().unwrap();
    record(folder.path(), &experiment::blends(0.5));
    // A plan file is accepted as a recording, of the model.
    iiwasim(&folder, &["plan", "circle.json", "--rate", "1000"]).success();
    iiwasim(&folder, &["identify", "circle.mcap", "--no-output"]).success().stdout(
        contains("kappa = -3.974").and(contains("confirmed")).and(contains("this is a plan")),
    );
    let output =
        iiwasim(&folder, &["identify", "circle.csv", "--program", "circle.json", "--json"]);
    let figures: serde_json::Value =
        serde_json::from_slice(&output.success().get_output().stdout).unwrap();
    let kappa = &figures["kappa"];
    assert!((kappa["coefficients"][0].as_f64().unwrap() + 3.5).abs() < 0.01);
    assert!(kappa["residual_of_model"].as_f64().unwrap() > 0.3);
    assert_eq!(kappa["at"].as_array().unwrap().len(), 17);
    assert_eq!(figures["blends"].as_array().unwrap().len(), 34);
    assert_eq!(figures["velocity_deg_s"][0], serde_json::Value::Null);
    assert_eq!(figures["settle"], serde_json::Value::Null);
    assert_eq!(figures["output"], "identified.json");
}

#[test]
fn missing_and_wrong_inputs_are_reported() {
    let folder = tempdir().unwrap();
    wide(&folder);
    fs::write(folder.path().join("empty.csv"), "").unwrap();
    let still = "t_s,q1,q2,q3,q4,q5,q6,q7\n0,0,0,0,0,0,0,0\n1,0,0,0,0,0,0,0\n";
    fs::write(folder.path().join("still.csv"), still).unwrap();
    fs::write(folder.path().join("other.json"), experiment::blends(0.5).program.to_json()).unwrap();
    for (arguments, message) in [
        (&["wide.csv"][..], "does not hold the program that was run; name it with --program"),
        (&["empty.csv", "--program", "wide.json"], "empty"),
        (&["still.csv", "--program", "wide.json"], "still.csv"),
        (&["none.csv", "--program", "wide.json"], "cannot read none.csv"),
        (&["wide.csv", "--program", "other.json"], "never where the program starts"),
        (&["wide.csv", "--program", "wide.json", "--robot", "r2d2"], "no robot is called"),
        (&["wide.csv", "--program", "wide.json", "--name", "\u{1}"], "--name"),
        (
            &["wide.csv", "--program", "wide.json", "-o", "wide.json"],
            "would be written over the program",
        ),
        (&[], "required"),
    ] {
        let before = files(&folder);
        let arguments = [&["identify"], arguments].concat();
        let output = iiwasim(&folder, &arguments).code(2).stdout(is_empty());
        // Lines may break anywhere.
        let stderr = String::from_utf8(output.get_output().stderr.clone()).unwrap();
        let words: Vec<_> = stderr.split_whitespace().filter(|word| *word != "│").collect();
        assert!(words.join(" ").contains(message), "{arguments:?}: {stderr}");
        assert_eq!(files(&folder), before, "{arguments:?}");
    }
}

/// Tests ramps as in Sunrise, at an override.
#[test]
fn ramps_at_an_override() {
    let folder = tempdir().unwrap();
    let program = r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] }, "motions": [
        { "type": "ptp", "joints_deg": [120, 20, -30, 20, -60, 40, 30] },
        { "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 0] }] }"#;
    fs::write(folder.path().join("program.json"), program).unwrap();
    let plan = ["plan", "program.json", "--override", "40", "--rate", "500", "-o", "plan.mcap"];
    iiwasim(&folder, &plan).success();
    let plan = fs::read(folder.path().join("plan.mcap")).unwrap();
    let log = iiwa_log::JointLog::read(&*plan).unwrap();
    let mut csv = Vec::new();
    iiwa_log::JointLog::new(log.t_s, log.q_rad).write_csv(&mut csv).unwrap();
    fs::write(folder.path().join("slow.csv"), csv).unwrap();
    let slow = ["identify", "slow.csv", "--program", "program.json", "--override", "40"];
    iiwasim(&folder, &slow).success().stdout(
        contains("Ramps begin with constant snap, as under Sunrise: 2 motions")
            .and(contains("A1  98.00000"))
            .and(contains("R at stops, Nm/s: "))
            .and(contains("keep the values of the model")),
    );
    iiwasim(&folder, &["identify", "slow.csv", "--override", "0"])
        .code(2)
        .stderr(contains("the range is 0.1 to 100 %"));
}

/// A recording that ends early is evaluated up to its end, with a note.
#[test]
fn losses_are_reported() {
    let folder = tempdir().unwrap();
    wide(&folder);
    let csv = fs::read_to_string(folder.path().join("wide.csv")).unwrap();
    fs::write(folder.path().join("half.csv"), &csv[..csv.len() / 2]).unwrap();
    iiwasim(&folder, &["identify", "half.csv", "--program", "wide.json", "--no-output"])
        .success()
        .stdout(
            contains("A7              not found")
                .and(contains("the arm does not follow the program from here on"))
                .and(contains("Note: half.csv: ")),
        );
}
