//! Forward and inverse kinematics through the command line.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use crate::run::iiwasim;
use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::Value;
use tempfile::tempdir;

const DOWN: &str =
    r#"{ "x_mm": 600, "y_mm": 0, "z_mm": 400, "a_deg": 0, "b_deg": 180, "c_deg": 0 }"#;

fn json(arguments: &[&str]) -> Value {
    let folder = tempdir().unwrap();
    let assert = iiwasim(&folder, arguments).success();
    serde_json::from_slice(&assert.get_output().stdout).unwrap()
}

fn rejects(arguments: &[&str], reasons: &[&str]) {
    let folder = tempdir().unwrap();
    let assert = iiwasim(&folder, &[&["ik"], arguments].concat()).code(2);
    // Messages are wrapped to the width of the terminal.
    let stderr = String::from_utf8_lossy(&assert.get_output().stderr).replace("\n  │", "");
    for reason in reasons {
        assert!(stderr.contains(reason), "{arguments:?}: no {reason:?} in {stderr}");
    }
}

#[test]
fn a_frame_of_fk_is_reached_by_ik() {
    for (robot, joints) in [
        ("lbr_iiwa_7_r800", "10,-20,30,-40,50,-60,70"),
        ("lbr_iiwa_14_r820", "-100,80,-30,70,-150,100,-170"),
        ("lbr_iiwa_7_r800", "10,0,30,40,50,90,0"),
    ] {
        let frame =
            json(&["fk", "--json", "--robot", robot, "--joints-deg", joints])["frame"].clone();
        let actual = json(&["ik", "--json", "--robot", robot, "--frame", &frame.to_string()]);
        for (j, asked) in joints.split(',').enumerate() {
            let asked: f64 = asked.parse().unwrap();
            let deg = actual["joints_deg"][j].as_f64().unwrap();
            assert!((deg - asked).abs() < 1e-9, "{joints}: {actual}");
            assert!((actual["joints_rad"][j].as_f64().unwrap() - asked.to_radians()).abs() < 1e-11);
        }
        for key in ["status", "turn"] {
            assert_eq!(actual["frame"][key], frame[key]);
        }
        assert_eq!(actual["robot"], robot);
        let inside = actual["allowed_e1_deg"].as_array().unwrap().iter().any(|range| {
            let e1 = frame["e1_deg"].as_f64().unwrap();
            range[0].as_f64().unwrap() <= e1 && e1 <= range[1].as_f64().unwrap()
        });
        assert!(inside, "{actual}");
        assert_eq!(
            actual["singularity"]["least"],
            actual["singularity"][actual["singularity"]["axis"].as_str().unwrap()]
        );
    }
}

#[test]
fn options_stand_above_the_frame_and_near_below_it() {
    let with_all = DOWN.replace('}', r#", "e1_deg": 10, "status": 2 }"#);
    let solve = |frame: &str, more: &[&str]| {
        let solution = json(&[&["ik", "--json", "--frame", frame], more].concat());
        (solution["frame"]["e1_deg"].as_f64().unwrap().round(), solution["frame"]["status"].clone())
    };
    let near = ["--near", "0,30,-80,60,0,90,0"];
    assert_eq!(solve(&with_all, &[]), (10.0, 2.into()));
    assert_eq!(solve(&with_all, &near), (10.0, 2.into()));
    assert_eq!(solve(&with_all, &["--e1-deg", "-30", "--status", "6"]), (-30.0, 6.into()));
    assert_eq!(solve(DOWN, &near).0, -80.0);
    assert_eq!(solve(DOWN, &[&near[..], &["--status", "2"]].concat()), (-80.0, 2.into()));

    let folder = tempdir().unwrap();
    iiwasim(&folder, &["ik", "--frame", &with_all]).success().stdout(
        contains("joints").and(contains("status     2, turn ")).and(contains("deg within limits")),
    );
    let other_turn = with_all.replace('}', r#", "turn": 127 }"#);
    iiwasim(&folder, &["ik", "--frame", &other_turn]).success().stderr(contains("turn 127"));
}

#[test]
fn unreachable_frames_are_rejected_with_the_reason() {
    let with = |frame: &'static str| ["--frame", frame, "--near", "0,30,0,-60,0,90,0"];
    let far = r#"{ "x_mm": 1600, "y_mm": 0, "z_mm": 340, "a_deg": 0, "b_deg": 90, "c_deg": 0 }"#;
    // The outstretched arm reaches 952 mm.
    rejects(&with(far), &["648.000 mm too short"]);
    rejects(&["--frame", DOWN], &["E1, the position of joint A3, is not given", "--e1-deg"]);
    rejects(&["--frame", "pick"], &["`pick` is not a JSON object", "needs --program"]);
    let whole = ["--frame", DOWN, "--e1-deg", "0", "--status", "1.5"];
    rejects(&whole, &["`1.5` is not a whole number"]);
    rejects(&["--frame", DOWN, "--e1-deg", "0"], &["status", "--near"]);
    rejects(&["--frame", DOWN, "--e1-deg", "0", "--status", "8"], &["the range is 0 to 7"]);
    rejects(
        &["--frame", DOWN, "--e1-deg", "171", "--status", "2"],
        &["joint A3 is at 171 deg", "within their limits at E1", "deg"],
    );
    let high = r#"{ "x_mm": 100, "y_mm": 0, "z_mm": 1000, "a_deg": 0, "b_deg": 0, "c_deg": 0 }"#;
    rejects(
        &["--frame", high, "--e1-deg", "90", "--status", "2"],
        &["out of reach with E1 at 90.000 deg", "within reach is E1 from -"],
    );
    rejects(
        &with(r#"{ "x_mm": 1 }"#),
        &["--frame", "line 1", "`y_mm`, `z_mm`, `a_deg`, `b_deg` and `c_deg` are missing"],
    );
    rejects(
        &with(r#"{ "x_mm": 1, "y_mm": 2, "z_mm": 3, "a_deg": 0, "b_deg": 0 }"#),
        &["`c_deg` is missing"],
    );
    rejects(&with(r#"{ "x_mm": 1, "e2_deg": 2 }"#), &["unknown key", "e2_deg"]);
    rejects(
        &with(
            r#"{ "x_mm": 1, "y_mm": 2, "z_mm": 3, "a_deg": 0, "b_deg": 0, "c_deg": 0,
                 "turn": 128 }"#,
        ),
        &["0 to 127"],
    );
    rejects(
        &with(r#"{ "x_mm": 1e9, "y_mm": 2, "z_mm": 3, "a_deg": 0, "b_deg": 0, "c_deg": 0 }"#),
        &["mm too short"],
    );
}

/// Tests the TCP of a program's tool in one of its bases, in both directions.
#[test]
fn tools_and_bases_are_those_of_a_program() {
    let cell = fixture("pick-and-place.json");
    let program = ["--program", cell.as_str()];
    let joints = ["--json", "--joints-deg", "20,30,10,-60,15,80,0"];
    let fk = |more: &[&str]| json(&[&["fk"], &joints[..], more].concat())["frame"].clone();
    let number = |frame: &Value, key: &str| frame[key].as_f64().unwrap();
    // The program's own tool, unless the bare flange is requested.
    let [bare, flange, tcp] =
        [fk(&[]), fk(&[&program[..], &["--tool", "flange"]].concat()), fk(&program)];
    assert_eq!(bare, flange);
    let away_mm = ["x_mm", "y_mm", "z_mm"].map(|key| number(&tcp, key) - number(&bare, key));
    assert!((away_mm.iter().map(|v| v * v).sum::<f64>().sqrt() - 120.0).abs() < 1e-9);
    let left = [&program[..], &["--tool", "gripper/left", "--base", "table"]].concat();
    let frame = fk(&left);
    assert!((number(&frame, "x_mm") - number(&tcp, "x_mm") + 500.0).abs() < 60.0);

    let frame = frame.to_string();
    let actual = json(&[&["ik", "--json", "--frame", &frame], &left[..]].concat());
    for (j, asked) in [20.0, 30.0, 10.0, -60.0, 15.0, 80.0, 0.0].into_iter().enumerate() {
        assert!((actual["joints_deg"][j].as_f64().unwrap() - asked).abs() < 1e-9, "{actual}");
    }
    // A named frame, with its E1 and status.
    let pick = json(&[&["ik", "--json", "--frame", "pick"], &program[..]].concat());
    let near = |key: &str, mm: f64| (number(&pick["frame"], key) - mm).abs() < 1e-6;
    assert!(near("x_mm", 500.0) && near("y_mm", -150.0) && near("z_mm", 250.0), "{pick}");

    let rejects = |more: &[&str], reasons: &[&str]| {
        rejects(&[&["--frame", DOWN, "--near", "0,30,0,-60,0,90,0"], more].concat(), reasons);
    };
    rejects(
        &[&program[..], &["--tool", "hook"]].concat(),
        &["unknown tool `hook`", "`gripper/left`"],
    );
    rejects(&[&program[..], &["--base", "floor"]].concat(), &["unknown base `floor`"]);
    rejects(&["--tool", "gripper"], &["--program"]);
}

fn fixture(name: &str) -> String {
    format!("{}/../fixtures/{name}", env!("CARGO_MANIFEST_DIR"))
}
