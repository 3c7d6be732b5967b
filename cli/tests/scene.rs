//! `iiwasim plan --scene` as a process: figures, gates, rejected input.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::fs;

use assert_cmd::assert::Assert;
use predicates::{
    prelude::PredicateBooleanExt,
    str::{contains, is_empty},
};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

use crate::helpers::{fixture, program};
use crate::run::{files, iiwasim};

/// Returns a folder with the ten motions and the cage.
fn cell() -> TempDir {
    let folder = tempdir().unwrap();
    for name in ["ten-motions.json", "cage.json"] {
        fs::copy(fixture(name), folder.path().join(name)).unwrap();
    }
    folder
}

fn plan(folder: &TempDir, arguments: &[&str]) -> Assert {
    iiwasim(folder, &[&["plan", "--no-output"], arguments].concat())
}

fn json(assert: Assert) -> Value {
    serde_json::from_slice(&assert.success().get_output().stdout).unwrap()
}

/// Returns messages without their line breaks.
fn stderr(assert: &Assert) -> String {
    String::from_utf8_lossy(&assert.get_output().stderr).replace("\n  │ ", " ")
}

#[test]
fn tells_how_near_the_arm_comes() {
    let cell = cell();
    let arguments = ["ten-motions.json", "--scene", "cage.json"];
    plan(&cell, &arguments)
        .success()
        .stdout(contains("\nClearance 79.1 mm: link 6 to column at 1.0"))
        .stderr(is_empty());
    let figures = json(plan(&cell, &[&arguments[..], &["--json"]].concat()));
    let clearance = &figures["clearance"];
    assert!((clearance["distance_mm"].as_f64().unwrap() - 79.1).abs() < 0.1, "{clearance}");
    assert_eq!((&clearance["link"], &clearance["obstacle"]), (&6.into(), &"column".into()));
    assert!((clearance["at_s"].as_f64().unwrap() - 1.008).abs() < 0.01, "{clearance}");
    assert_eq!(clearance.as_object().unwrap().len(), 4);
    let itself = &figures["self_clearance"];
    assert!(itself["distance_mm"].as_f64().unwrap() > 30.0, "{itself}");
    assert_eq!(itself.as_object().unwrap().len(), 4);

    let figures = json(plan(&cell, &["ten-motions.json", "--json"]));
    assert_eq!((figures.get("clearance"), figures.get("self_clearance")), (None, None));
    plan(&cell, &["ten-motions.json"]).success().stdout(contains("Clearance").not());
}

/// Tests a long tool that points back along the forearm as the wrist bends.
#[test]
fn an_arm_that_touches_itself_meets_no_gate() {
    let cell = cell();
    let scene = |length: u32| {
        format!(
            r#"{{ "version": 1, "obstacles": [], "tool": [{{ "type": "box",
                "center_mm": [{}, 0, 20], "size_mm": [{length}, 40, 40] }}] }}"#,
            length / 2
        )
    };
    let program = r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, -60, 0, 0, 0] },
        "motions": [{ "type": "ptp", "joints_deg": [0, 0, 0, -60, 0, 115, 170] },
                    { "type": "ptp", "joints_deg": [0, 0, 0, -60, 0, 115, 0] }] }"#;
    let write = |name: &str, text: &str| fs::write(cell.path().join(name), text).unwrap();
    write("bend.json", program);
    write("long.json", &scene(400));
    write("short.json", &scene(60));
    let gate = |scene| plan(&cell, &["bend.json", "--scene", scene, "--min-clearance", "0"]);
    gate("short.json").success().stdout(contains("\nArm from itself "));
    let refused =
        gate("long.json").code(3).stdout(contains("\nThe arm touches itself: the tool and link "));
    let message = stderr(&refused);
    assert!(message.contains("touches itself: the tool and link "), "{message}");
    // Without a gate, `plan` reports the contact and exits with 0.
    plan(&cell, &["bend.json", "--scene", "long.json"]).success();
}

#[test]
fn a_clearance_that_is_too_small_exits_with_3() {
    let cell = cell();
    let gate =
        |mm| plan(&cell, &["ten-motions.json", "--scene", "cage.json", "--min-clearance", mm]);
    gate("79").success();
    let message = stderr(&gate("80").code(3).stdout(contains("Clearance 79.1 mm")));
    assert!(message.contains("comes within 79.1 mm of column, less than 80 mm"), "{message}");
    // Both gates at once.
    let both = ["--scene", "cage.json", "--min-clearance", "80", "--max-cycle-time", "7"];
    let message = stderr(&plan(&cell, &[&["ten-motions.json"], &both[..]].concat()).code(3));
    assert!(message.contains("more than 7 s, and comes within 79.1 mm"), "{message}");
}

#[test]
fn an_arm_that_touches_has_no_clearance() {
    let folder = tempdir().unwrap();
    let table = r#"{ "version": 1, "obstacles": [
        { "name": "table", "type": "plane", "point_mm": [0, 0, 200], "normal": [0, 0, 1] }
    ] }"#;
    fs::write(folder.path().join("table.json"), table).unwrap();
    let down = r#"{ "type": "ptp", "joints_deg": [0, 90, 0, -30, 0, 60, 0] }"#;
    fs::write(folder.path().join("down.json"), program(down)).unwrap();
    let arguments = ["down.json", "--scene", "table.json"];
    plan(&folder, &arguments).success().stdout(contains("Clearance none: link 7 touches table at"));
    // Contact violates any gate.
    let assert = plan(&folder, &[&arguments[..], &["--min-clearance", "0"]].concat()).code(3);
    assert!(stderr(&assert).contains("touches table: link 7 at"), "{}", stderr(&assert));
}

#[test]
fn many_programs_are_held_against_the_scene() {
    let cell = cell();
    fs::copy(fixture("appendix-b.json"), cell.path().join("appendix-b.json")).unwrap();
    // The scene is not taken for a program of the folder.
    let assert = plan(&cell, &[".", "--scene", "cage.json", "--min-clearance", "75"]).success();
    let table = String::from_utf8(assert.get_output().stdout.clone()).unwrap();
    assert!(table.contains("clearance mm") && table.contains("79.1"), "{table}");
    assert!(table.contains("2 planned, 0 failed"), "{table}");
    let near = plan(&cell, &[".", "--scene", "cage.json", "--min-clearance", "80"]);
    let near = near.code(3).stdout(contains("too near"));
    let message = stderr(&near);
    assert!(message.contains("1 of 2 programs with a clearance below 80 mm"), "{message}");
    let lines = plan(&cell, &[".", "--scene", "cage.json", "--json"]).success();
    for line in String::from_utf8(lines.get_output().stdout.clone()).unwrap().lines() {
        let figures: Value = serde_json::from_str(line).unwrap();
        assert!(figures["clearance"]["distance_mm"].as_f64().unwrap() > 75.0, "{line}");
    }
}

#[test]
fn a_scene_without_obstacles_has_no_clearance() {
    let cell = cell();
    fs::write(cell.path().join("empty.json"), r#"{ "version": 1, "obstacles": [] }"#).unwrap();
    let arguments = ["ten-motions.json", "--scene", "empty.json", "--min-clearance", "1000"];
    plan(&cell, &arguments).success().stdout(contains("Clearance").not());
}

#[test]
fn other_files_than_scenes_are_rejected() {
    let cell = cell();
    let before = files(&cell);
    let refused = |arguments: &[&str], words: &[&str]| {
        let message = stderr(&plan(&cell, arguments).code(2).stdout(is_empty()));
        for word in words {
            assert!(message.contains(word), "`{word}` is missing in:\n{message}");
        }
    };
    refused(&["ten-motions.json", "--min-clearance", "5"], &["--scene"]);
    refused(&["ten-motions.json", "--scene", "cage.json", "--min-clearance=-1"], &["negative"]);
    refused(&["ten-motions.json", "--scene", "none.json"], &["cannot read none.json"]);
    let program = ["ten-motions.json", "--scene", "ten-motions.json"];
    refused(&program, &["is a motion program, not a scene"]);
    let wrong = "{ \"version\": 1, \"obstacles\": [\n  { \"name\": \"a\", \"type\": \"box\", \
                 \"center_mm\": [0, 0, 0], \"size_mm\": [1, 0, 1] } ] }";
    fs::write(cell.path().join("wrong.json"), wrong).unwrap();
    let words = ["wrong.json, line 2, column", "obstacle 1", "size_mm is 0; a size is above 0"];
    refused(&["ten-motions.json", "--scene", "wrong.json"], &words);
    fs::remove_file(cell.path().join("wrong.json")).unwrap();
    // The scene is not overwritten.
    let over = ["plan", "ten-motions.json", "--scene", "cage.json", "-o", "cage.json"];
    let message = stderr(&iiwasim(&cell, &over).code(2));
    assert!(message.contains("over the scene"), "{message}");
    assert_eq!(files(&cell), before);
}

const WEDGE: &str = "v 0 0 0\nv 60 0 0\nv 0 40 0\nv 0 0 90\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// Writes the cage, with a mesh as tool.
fn cage_with(folder: &TempDir, file: &str) {
    let mut scene: Value =
        serde_json::from_str(&fs::read_to_string(fixture("cage.json")).unwrap()).unwrap();
    scene["tool"] = serde_json::json!([{ "type": "mesh", "file": file }]);
    fs::write(folder.path().join("cage.json"), scene.to_string()).unwrap();
}

#[test]
fn a_mesh_is_read_from_beside_the_scene() {
    let cell = cell();
    fs::create_dir(cell.path().join("cad")).unwrap();
    fs::write(cell.path().join("cad/wedge.obj"), WEDGE).unwrap();
    cage_with(&cell, "cad/wedge.obj");
    let arguments = ["ten-motions.json", "--scene", "cage.json"];
    let figures = json(plan(&cell, &[&arguments[..], &["--json"]].concat()));
    // The tool extends beyond the wrist, which is nearest without it.
    let clearance = &figures["clearance"];
    assert!(clearance["distance_mm"].as_f64().unwrap() < 79.0, "{clearance}");
    assert_eq!(clearance["link"], 8, "{clearance}");
    // A scene with a mesh is not taken for a program of the folder either.
    let all = plan(&cell, &[".", "--scene", "cage.json"]).success();
    assert_eq!(stderr(&all), "Note: ./cage.json is a scene, and is not planned\n");
}

#[test]
fn no_mesh_is_read_from_elsewhere() {
    let cell = cell();
    let outside = tempdir().unwrap();
    fs::write(outside.path().join("wedge.obj"), WEDGE).unwrap();
    let refused = |file: &str, words: &[&str]| {
        cage_with(&cell, file);
        let message = stderr(&plan(&cell, &["ten-motions.json", "--scene", "cage.json"]).code(2));
        for word in words.iter().chain(&["cage.json, line 1", "tool, shape 1"]) {
            assert!(message.contains(word), "`{word}` is missing in:\n{message}");
        }
    };
    let path = outside.path().join("wedge.obj");
    refused(path.to_str().unwrap(), &["beside the scene or in a folder below it"]);
    refused("../wedge.obj", &["beside the scene or in a folder below it"]);
    refused("ten-motions.json", &["*.stl or *.obj"]);
    refused("none.stl", &["no such file", "none.stl"]);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&path, cell.path().join("link.obj")).unwrap();
        refused("link.obj", &["leads out of the folder of the file that names it"]);
    }
    fs::write(cell.path().join("secret.obj"), "v hunter2\n").unwrap();
    refused("secret.obj", &["not a valid OBJ file"]);
    let message = stderr(&plan(&cell, &["ten-motions.json", "--scene", "cage.json"]));
    assert!(!message.contains("hunter2"), "{message}");
}

#[test]
fn prints_the_schema() {
    let schema = json(iiwasim(&tempdir().unwrap(), &["schema", "scene"]));
    assert_eq!(schema["title"], "iiwasim scene");
}
