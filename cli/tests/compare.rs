//! `iiwasim compare` as a process: figures, gates, pictures, invalid files.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::{fmt::Write as _, fs};

use predicates::{
    prelude::PredicateBooleanExt,
    str::{contains, is_empty, is_match},
};
use tempfile::{TempDir, tempdir};

use crate::helpers::fixture;
use crate::run::{files, iiwasim};

/// Returns a folder with `plan.mcap`, and `real.mcap`: the same program without jerk limits, and
/// with other blends.
fn plans() -> TempDir {
    let folder = tempdir().unwrap();
    let program = fixture("waits-and-stops.json");
    let program = program.to_str().unwrap();
    iiwasim(&folder, &["plan", program, "-o", "plan.mcap"]).success();
    let other = ["--timing", "acceleration", "--blend-shape", "alpha", "--rate", "1000"];
    iiwasim(&folder, &[&["plan", program, "-o", "real.mcap"], &other[..]].concat()).success();
    folder
}

#[test]
fn a_plan_against_itself_is_without_error() {
    let folder = plans();
    iiwasim(&folder, &["compare", "plan.mcap", "plan.mcap"])
        .success()
        .stdout(contains("off by 0.0000 s, 0.00 %").and(is_match(r"-0\.0+\b").unwrap().not()))
        .stderr(is_empty());
    let gates = ["--max-error-percent", "0.0000001", "--max-deviation-mm", "0.0000001"];
    iiwasim(&folder, &[&["compare", "plan.mcap", "plan.mcap"], &gates[..]].concat()).success();
}

#[test]
fn milliseconds_are_not_seconds() {
    let folder = plans();
    let mut table = String::from("t_s,A1_deg,A2_deg,A3_deg,A4_deg,A5_deg,A6_deg,A7_deg\n");
    for k in 0..100 {
        writeln!(table, "{k},{},0,0,0,0,0,0", f64::from(k) * 0.1).unwrap();
    }
    fs::write(folder.path().join("ms.csv"), table).unwrap();
    iiwasim(&folder, &["compare", "plan.mcap", "ms.csv"])
        .code(2)
        .stderr(contains("implausible sample rate: 1.000 Hz"));
}

#[test]
fn gates_name_both_figures() {
    let folder = plans();
    let both = ["--max-error-percent", "5", "--max-deviation-mm", "1"];
    iiwasim(&folder, &[&["compare", "plan.mcap", "real.mcap", "--json"], &both[..]].concat())
        .code(3)
        .stdout(contains("\"error_percent\":21.5"))
        .stderr(contains("off by +21.5").and(contains("mm, more than 1 mm")));
    let wide = ["--max-error-percent", "22", "--max-deviation-mm", "3"];
    iiwasim(&folder, &[&["compare", "plan.mcap", "real.mcap"], &wide[..]].concat()).success();
    iiwasim(&folder, &["compare", "plan.mcap", "real.mcap", "--max-error-percent", "-1"]).code(2);
}

#[test]
fn figures_are_as_promised() {
    let folder = plans();
    let assert = iiwasim(&folder, &["compare", "plan.mcap", "real.mcap", "--json"]).success();
    let figures: serde_json::Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    let number = |key: &str| figures.pointer(key).and_then(serde_json::Value::as_f64).unwrap();
    let (simulated_s, real_s) = (number("/cycle_time/simulated_s"), number("/cycle_time/real_s"));
    // The real cycle time is known, since that file is also a plan.
    assert!((real_s - number("/cycle_time/stated_s")).abs() < 1e-4, "{real_s}");
    let error_s = number("/cycle_time/error_s");
    assert!((error_s - (simulated_s - real_s)).abs() < 1e-12);
    assert!((number("/cycle_time/error_percent") - 100.0 * error_s / real_s).abs() < 1e-9);
    assert!((number("/cycle_time/standing_s") - 0.05).abs() < 1e-9);
    let motions = figures["motions"].as_array().unwrap();
    assert_eq!(motions.len(), 8);
    assert_eq!((&motions[2]["type"], &motions[2]["index"]), (&"wait".into(), &3.into()));
    for key in ["/tcp_deviation/max_mm", "/joint_deviation/max_rad", "/noise_rad", "/departure_s"] {
        number(key);
    }
    assert!((1.0..5.0).contains(&number("/tcp_deviation/max_mm")));
    assert_eq!(figures["robot"], "lbr_iiwa_7_r800");
}

#[test]
fn a_picture_shows_both_paths() {
    let folder = plans();
    let picture =
        |name| iiwasim(&folder, &["compare", "plan.mcap", "real.mcap", "--picture", name]);
    picture("both.svg").success().stdout(contains("Picture in both.svg"));
    let svg = fs::read_to_string(folder.path().join("both.svg")).unwrap();
    for word in ["planned", "measured", "y in mm", "z in mm", "in mrad"] {
        assert!(svg.contains(word), "{word}");
    }
    let plan = fs::read(folder.path().join("plan.mcap")).unwrap();
    picture("plan.mcap").code(2).stderr(contains("pictures are written as .svg"));
    assert_eq!(fs::read(folder.path().join("plan.mcap")).unwrap(), plan);
}

/// Returns joint positions as CSV, in rad or in degrees.
fn csv(unit: &str, factor: f64) -> String {
    let names: Vec<_> = (1..=7).map(|joint| format!("joint_{joint}_{unit}")).collect();
    let mut text = format!("t_s,{}\n", names.join(","));
    for k in 0..2000_u32 {
        // Slowly from 20 to 60 degrees and back.
        let turn = (f64::from(k) / 2000.0 * std::f64::consts::TAU).cos();
        let joints = [20.0, 40.0 - 20.0 * turn, 0.0, -70.0, 0.0, 90.0, 0.0];
        let joints = joints.map(|deg: f64| (deg.to_radians() * factor).to_string());
        writeln!(text, "{},{}", 0.004 * f64::from(k), joints.join(",")).unwrap();
    }
    text
}

#[test]
fn files_that_are_not_the_program_are_refused() {
    let folder = plans();
    let path = |name: &str| folder.path().join(name);
    let appendix_b = fixture("appendix-b.json");
    iiwasim(&folder, &["plan", appendix_b.to_str().unwrap(), "-o", "other.mcap"]).success();
    fs::write(path("empty.mcap"), "").unwrap();
    fs::write(path("text.csv"), "not a table\n").unwrap();
    fs::write(path("rad.csv"), csv("rad", 1.0)).unwrap();
    fs::write(path("degrees.csv"), csv("rad", 180.0 / std::f64::consts::PI)).unwrap();
    let whole = fs::read(path("plan.mcap")).unwrap();
    fs::write(path("cut.mcap"), &whole[..whole.len() / 2]).unwrap();
    let before = files(&folder);
    for (measured, words) in [
        ("other.mcap", "not the same program"),
        ("empty.mcap", "empty"),
        ("text.csv", "neither an MCAP file nor a table"),
        ("rad.csv", "not the same program"),
        ("degrees.csv", "joint"),
        ("none.mcap", "cannot read none.mcap"),
        (".", "cannot read ."),
        ("cut.mcap", "cut.mcap"),
    ] {
        let assert = iiwasim(&folder, &["compare", "plan.mcap", measured, "--picture", "x.svg"]);
        let assert = assert.code(2).stdout(is_empty());
        let message = String::from_utf8_lossy(&assert.get_output().stderr).replace("\n  │ ", " ");
        assert!(message.contains(words), "{measured}: {message}");
    }
    for (plan, words) in [
        ("empty.mcap", "empty.mcap"),
        ("rad.csv", "rad.csv"),
        ("cut.mcap", "cut.mcap"),
        ("none.mcap", "cannot read none.mcap"),
    ] {
        let assert = iiwasim(&folder, &["compare", plan, "real.mcap"]).code(2).stdout(is_empty());
        assert.stderr(contains(words));
    }
    assert_eq!(files(&folder), before);
}
