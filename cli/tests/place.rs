//! `iiwasim place` as a process: the map, the program for the best place, and what it refuses.

use std::{fs, path::Path};

use assert_cmd::assert::Assert;
use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

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

/// Writes a scene with a wall 200 mm behind the robot, whose foot has a radius of 115 mm.
#[expect(clippy::unwrap_used, reason = "a test fails by it")]
fn write_wall(folder: &Path) {
    let scene = r#"{ "version": 1, "obstacles": [{ "type": "plane", "name": "wall",
        "point_mm": [-200, 0, 0], "normal": [1, 0, 0] }] }"#;
    fs::write(folder.join("wall.json"), scene).unwrap();
}

/// Searches along x, on which a wall is behind the robot.
fn placed(folder: &TempDir, options: &[&str]) -> Assert {
    let input = fixture("pick-and-place.json").display().to_string();
    let grid = ["place", &input, "--x=-100:100", "--y=0"];
    iiwasim(folder, &[&grid[..], options].concat())
}

#[test]
fn places_too_near_to_a_wall_are_not_chosen() {
    let folder = tempdir().unwrap();
    write_wall(folder.path());
    let free = figures(placed(&folder, &["--json"]));
    assert_eq!(free.get("too_near"), None);
    assert!(free["places"].as_array().unwrap().iter().all(|it| it.get("too_near").is_none()));

    let scene = ["--scene", "wall.json"];
    let with = |options: &[&str]| placed(&folder, &[&scene[..], options].concat());
    let near = figures(with(&["--json", "-o", "placed.json", "--picture", "map.svg"]));
    let flags = |report: &Value| {
        let rows = report["places"].as_array().unwrap().iter();
        rows.map(|row| row["too_near"].as_bool().unwrap()).collect::<Vec<_>>()
    };
    assert_eq!(flags(&near), [true, false, false, false, false]);
    assert_eq!(near["too_near"], 1);
    let times = |report: &Value| {
        let rows = report["places"].as_array().unwrap().iter();
        rows.map(|row| row["cycle_time_s"].clone()).collect::<Vec<_>>()
    };
    assert_eq!(times(&near), times(&free));
    let best = &near["best"];
    assert_eq!(best["too_near"], false);
    let best_mm = best["x_mm"].as_f64().unwrap();
    assert!((-75.2..=-50.0).contains(&best_mm), "{best}");
    let best_s = best["cycle_time_s"].as_f64().unwrap();
    assert!(best_s > free["best"]["cycle_time_s"].as_f64().unwrap());
    assert!((cycle_time(&folder, "placed.json") - best_s).abs() < 1e-6);
    let svg = fs::read_to_string(folder.path().join("map.svg")).unwrap();
    // Once in the map, and once in the legend.
    assert_eq!((svg.matches("too near").count(), svg.matches("#F0A096").count()), (1, 2));
    let first_s = format!("{:.3}", near["places"][0]["cycle_time_s"].as_f64().unwrap());
    assert!(!svg.contains(&first_s), "{first_s}");

    let wide = figures(with(&["--json", "--min-clearance", "50"]));
    assert_eq!(
        (flags(&wide), &wide["too_near"]),
        (vec![true, true, false, false, false], &2.into())
    );
    with(&[]).success().stdout(
        contains("too near")
            .and(contains("too near to an obstacle or to itself at 1 of them"))
            .and(contains(&first_s).not())
            .and(contains("not checked for collisions").not()),
    );
    let all = ["--min-clearance", "1000", "--json"];
    let none = figures(with(&all));
    assert_eq!(none["best"], Value::Null, "{none}");
    with(&all[..2]).success().stdout(contains("No place that keeps the clearances saves"));
}

#[test]
fn obstacles_that_move_with_the_robot_are_named() {
    let folder = tempdir().unwrap();
    write_wall(folder.path());
    let free = figures(placed(&folder, &["--json"]));
    let scene = ["--scene", "wall.json", "--with-robot"];
    let with = |names: &str| placed(&folder, &[&scene[..], &[names, "--json"]].concat());
    let moving = figures(with("wall"));
    assert_eq!((&moving["too_near"], &moving["best"]["x_mm"]), (&0.into(), &free["best"]["x_mm"]));
    placed(&folder, &scene[..2])
        .success()
        .stdout(contains("too near").and(contains("keeps its clearances").not()));
    placed(&folder, &[&scene[..], &["wall"]].concat())
        .success()
        .stdout(contains("keeps its clearances at all of them").and(contains("too near").not()));
    for names in ["door", "wall,door"] {
        let message = "--with-robot: unknown obstacle `door`; `wall` is known";
        with(names).code(2).stderr(contains(message));
    }
    placed(&folder, &["--with-robot", "wall"])
        .code(2)
        .stderr(contains("--with-robot needs a scene"));
    // A scene by default.
    fs::write(folder.path().join("iiwasim.toml"), "scene = \"wall.json\"").unwrap();
    let by_default = figures(placed(&folder, &["--with-robot", "wall", "--json"]));
    assert_eq!(by_default["too_near"], 0);
    placed(&folder, &["--scene", "wall.json", "-o", "wall.json"])
        .code(2)
        .stderr(contains("--output"));
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
