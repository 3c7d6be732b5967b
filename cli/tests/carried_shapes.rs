//! Shapes that a program carries: reports of recordings, and mesh files that are refused.

use std::fs::{self, File};

use predicates::str::contains;
use tempfile::tempdir;

use crate::report::{data, page};
use crate::run::iiwasim;

/// A recording whose wait for an input lasts longer than planned: its arm carries the rod from the
/// same pose on as in the plan.
#[test]
fn a_recording_carries_workpieces_from_their_measured_times_on() {
    let folder = tempdir().unwrap();
    let program = |seconds: f64| {
        serde_json::json!({
            "version": 1,
            "start": { "joints_deg": [0, 0, 0, -90, 0, 90, 0] },
            "motions": [
                { "type": "ptp", "joints_deg": [0, 40, 0, -80, 0, 60, 0] },
                { "type": "wait_for", "io": "part", "value": true, "seconds": seconds },
                { "type": "ptp", "joints_deg": [0, 0, 0, -60, 0, 60, 0] },
                { "type": "load", "load": { "mass_kg": 1, "shapes": [{ "type": "cylinder",
                    "center_mm": [0, 0, 250], "radius_mm": 10, "length_mm": 500 }] } },
                { "type": "ptp", "joints_deg": [40, 0, 0, -60, 0, 60, 0] }
            ]
        })
    };
    for (name, seconds) in [("short", 0.1), ("long", 5.0)] {
        let file = format!("{name}.json");
        fs::write(folder.path().join(&file), program(seconds).to_string()).unwrap();
        iiwasim(&folder, &["plan", &file, "-o", &format!("{name}.mcap")]).success();
    }
    let floor = r#"{ "version": 1, "obstacles": [{ "name": "floor", "type": "plane",
        "point_mm": [0, 0, 0], "normal": [0, 0, 1] }] }"#;
    fs::write(folder.path().join("floor.json"), floor).unwrap();
    let shown = data(&page(&folder, &["short.mcap", "long.mcap", "--scene", "floor.json"]));
    let nearest = |arm: usize| shown["arms"][arm]["clearance"]["nearest"].clone();
    let distance_mm = |arm: usize| nearest(arm)["distance_mm"].as_f64().unwrap();
    let [planned, measured] = [0, 1].map(distance_mm);
    assert!((planned - measured).abs() < 0.1, "{} {}", nearest(0), nearest(1));
    let from_s = |arm: usize| shown["arms"][arm]["bodies"][1]["from_s"].as_f64().unwrap();
    assert!((from_s(1) - from_s(0) - 4.9).abs() < 0.05, "{} {}", from_s(0), from_s(1));

    // Without a comparison, the times are unknown.
    let other = serde_json::json!({
        "version": 1,
        "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
        "motions": [{ "type": "ptp", "joints_deg": [40, 0, 0, 0, 0, 0, 0] }]
    });
    fs::write(folder.path().join("other.json"), other.to_string()).unwrap();
    iiwasim(&folder, &["plan", "other.json", "-o", "other.mcap"]).success();
    let shown = data(&page(&folder, &["short.mcap", "other.mcap", "--scene", "floor.json"]));
    assert!(shown["arms"][0]["clearance"].is_object());
    assert!(shown["arms"][1].get("clearance").is_none());
    let notes = shown["notes"].to_string();
    assert!(notes.contains("other.mcap: the times of its load changes are unknown"), "{notes}");
}

#[test]
fn large_meshes_of_a_scene_are_not_read() {
    let folder = tempdir().unwrap();
    let scene = r#"{ "version": 1, "obstacles": [{ "name": "a", "type": "mesh",
        "file": "a.stl" }] }"#;
    fs::write(folder.path().join("scene.json"), scene).unwrap();
    File::create(folder.path().join("a.stl")).unwrap().set_len(3_000_000_000).unwrap();
    let program = crate::helpers::fixture("ten-motions.json");
    let plan = ["plan", program.to_str().unwrap(), "--no-output", "--scene", "scene.json"];
    iiwasim(&folder, &plan).code(2).stderr(contains("more than 20000000 bytes: make the mesh"));
}

/// A mesh without a volume: an error at its name, within the repeat block, but only with a scene.
#[test]
fn mesh_errors_are_placed_in_repeat_blocks() {
    let folder = tempdir().unwrap();
    let program = r#"{ "version": 1, "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
"motions": [{ "type": "wait", "seconds": 1 },
{ "type": "repeat", "count": 3, "motions": [
{ "type": "ptp", "joints_deg": [0, 50, 0, -60, 0, 90, 0] },
{ "type": "load", "load": { "mass_kg": 1, "shapes": [{ "type": "mesh", "file": "flat.obj" }] } },
{ "type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 90, 0] }] }] }"#;
    fs::write(folder.path().join("program.json"), program).unwrap();
    let flat = "v 0 0 0\nv 60 0 0\nv 0 40 0\nf 1 2 3\n";
    fs::write(folder.path().join("flat.obj"), flat).unwrap();
    fs::write(folder.path().join("scene.json"), r#"{ "version": 1, "obstacles": [] }"#).unwrap();
    let plan = ["plan", "program.json", "--no-output"];
    iiwasim(&folder, &plan).success();
    iiwasim(&folder, &[&plan[..], &["--scene", "scene.json"]].concat())
        .code(2)
        .stderr(contains("program.json:5:"))
        .stderr(contains("shape 1 of the load: `flat.obj`: its points are all in one plane"));
}
