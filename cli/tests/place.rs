//! `iiwasim place` as a process: the map, the program for the best place, and what it refuses.

use std::fs;

use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::Value;
use tempfile::tempdir;

use crate::helpers::{cycle_time, figures, fixture};
use crate::run::iiwasim;

#[test]
fn the_written_program_takes_as_long_as_stated() {
    let folder = tempdir().unwrap();
    let input = fixture("pick-and-place.json").display().to_string();
    let range = ["place", &input, "--x", "-50:50", "--y", "0", "--steps", "3"];
    let arguments = [&range[..], &["-o", "placed.json", "--json"]].concat();
    let report = figures(iiwasim(&folder, &arguments));
    let best_s = report["best"]["cycle_time_s"].as_f64().unwrap();
    assert!(best_s < report["cycle_time_s"].as_f64().unwrap(), "{report}");
    assert!((cycle_time(&folder, "placed.json") - best_s).abs() < 1e-6);
    let x_mm: Vec<_> = report["places"].as_array().unwrap().iter().map(|it| &it["x_mm"]).collect();
    assert_eq!(x_mm, [-50.0, 0.0, 50.0]);
    assert_eq!(report["joint_targets"], 2);

    // The program names the robot that it was planned on, so that its place holds for it.
    let other = [&range[..], &["--robot", "lbr_iiwa_14_r820", "-o", "other.json", "--json"]];
    let report = figures(iiwasim(&folder, &other.concat()));
    let best_s = report["best"]["cycle_time_s"].as_f64().unwrap();
    assert!((cycle_time(&folder, "other.json") - best_s).abs() < 1e-6);

    // A program that may have been edited is kept.
    iiwasim(&folder, &arguments).code(2).stderr(contains("placed.json exists"));
    iiwasim(&folder, &range).success().stdout(
        contains("x -50 mm")
            .and(contains("Fastest at x -50 mm"))
            .and(contains("at the edge of a range"))
            .and(contains("Targets in joints"))
            .and(contains("not checked for collisions")),
    );
}

#[test]
fn the_picture_shows_the_map() {
    let folder = tempdir().unwrap();
    let input = fixture("pick-and-place.json").display().to_string();
    let grid = ["place", &input, "--x=-400:0", "--y=0:60", "--steps", "3", "--json"];
    let report = figures(iiwasim(&folder, &[&grid[..], &["--picture", "map.svg"]].concat()));
    let svg = fs::read_to_string(folder.path().join("map.svg")).unwrap();
    let times = report["places"].as_array().unwrap().iter().map(|it| it["cycle_time_s"].as_f64());
    let (in_reach, out_of_reach): (Vec<_>, Vec<_>) = times.partition(Option::is_some);
    assert!(!in_reach.is_empty() && !out_of_reach.is_empty(), "{report}");
    for time_s in in_reach.into_iter().flatten() {
        assert!(svg.contains(&format!("{time_s:.3}")), "{time_s}");
    }
    for text in ["out of reach", "present place", "at z 0 mm, yaw 0 deg", "x in mm", "y in mm"] {
        assert!(svg.contains(text), "{text}");
    }

    let refused = |options: &[&str], message: &str| {
        iiwasim(&folder, &[&grid[..2], options].concat()).code(2).stderr(contains(message));
    };
    refused(&["--x=0", "--y=0", "--picture", "map.svg"], "a map needs several places");
    refused(&["--picture", "map.bmp"], "as .svg, .png or .pdf");
    fs::write(folder.path().join("mine.svg"), "{}").unwrap();
    refused(&["--picture", "mine.svg"], "mine.svg");
    assert_eq!(fs::read_to_string(folder.path().join("mine.svg")).unwrap(), "{}");
}

#[test]
fn ranges_and_grids_are_checked() {
    let folder = tempdir().unwrap();
    let input = fixture("pick-and-place.json").display().to_string();
    let refused = |options: &[&str], message: &str| {
        let arguments = [&["place", &input], options].concat();
        iiwasim(&folder, &arguments).code(2).stderr(contains(message));
    };
    refused(&["--x", "50:-50"], "`50:-50` runs backwards");
    refused(&["--x", "near"], "`near` is not a number");
    refused(&["--z=-9:9", "--yaw=-9:9", "--steps", "100"], "100000000 places");
    refused(&["--steps", "1"], "2..=100");
    refused(&["-o", &input], "--output");
}

/// Gravity would turn with the base of a robot on a wall.
#[test]
fn a_robot_on_a_wall_does_not_turn() {
    let folder = tempdir().unwrap();
    let text = fs::read_to_string(fixture("pick-and-place.json")).unwrap();
    let mut wall: Value = serde_json::from_str(&text).unwrap();
    wall["mount"] = serde_json::json!({ "rpy_deg": [0, 90, 0] });
    fs::write(folder.path().join("wall.json"), wall.to_string()).unwrap();
    let at = ["place", "wall.json", "--x", "0", "--y", "0"];
    iiwasim(&folder, &[&at[..], &["--yaw", "0:9"]].concat()).code(2).stderr(contains("--yaw"));
    iiwasim(&folder, &at).success();
}
