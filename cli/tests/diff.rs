//! `iiwasim diff` as a process: programs, plans, projects and folders.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::fs;
#[cfg(feature = "sunrise")]
use std::path::Path;

use predicates::{
    prelude::PredicateBooleanExt,
    str::{contains, is_empty},
};
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use crate::helpers::{cycle_time, fixture};
use crate::run::iiwasim;

const FIXTURES: [&str; 5] = [
    "appendix-b.json",
    "pick-and-place.json",
    "sunrise/frames/expected.json",
    "ten-motions.json",
    "waits-and-stops.json",
];

/// Changes of two projects: a slower share of speed, and a longer line.
#[cfg(feature = "sunrise")]
const CHANGES: [(&str, [&str; 2]); 2] = [
    ("joints", ["FAST = 0.6", "FAST = 0.4"]),
    ("async", ["linRel(0, 0, -60)", "linRel(0, 0, -90)"]),
];

fn program(name: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(fixture(name)).unwrap()).unwrap()
}

fn store(folder: &TempDir, name: &str, program: &Value) {
    let path = folder.path().join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, program.to_string()).unwrap();
}

fn answer(folder: &TempDir, arguments: &[&str]) -> Value {
    let output = iiwasim(folder, &[&["diff"], arguments, &["--json"]].concat()).success();
    serde_json::from_slice(&output.get_output().stdout).unwrap()
}

#[test]
fn a_removed_motion_is_one_row_and_the_times_are_those_of_the_plans() {
    for name in FIXTURES {
        let folder = tempdir().unwrap();
        let old = program(name);
        let mut new = old.clone();
        let motions = new["motions"].as_array_mut().unwrap();
        // The last motion: nothing starts where it ends.
        let removed = motions.pop().unwrap();
        if motions.last().unwrap()["blend"].is_object() {
            motions.last_mut().unwrap().as_object_mut().unwrap().remove("blend");
        }
        store(&folder, "old.json", &old);
        store(&folder, "new.json", &new);
        let difference = answer(&folder, &["old.json", "new.json"]);
        for (side, file) in [("old", "old.json"), ("new", "new.json")] {
            assert_eq!(difference["cycle_time_s"][side], json!(cycle_time(&folder, file)));
        }
        let rows = difference["motions"].as_array().unwrap();
        let removed_rows: Vec<_> = rows.iter().filter(|row| row["change"] == "removed").collect();
        assert_eq!(removed_rows.len(), 1, "{name}: {difference}");
        assert_eq!(removed_rows[0]["type"], removed["type"]);
        assert_eq!(removed_rows[0]["old"]["index"], old["motions"].as_array().unwrap().len());
        assert!(rows.iter().all(|row| row["change"] != "added"), "{name}: {difference}");
    }
}

#[test]
fn a_program_and_its_plan_are_equal() {
    for name in FIXTURES {
        let folder = tempdir().unwrap();
        store(&folder, "program.json", &program(name));
        iiwasim(&folder, &["plan", "program.json", "-o", "plan.mcap"]).success();
        for files in [["plan.mcap", "program.json"], ["program.json", "plan.mcap"]] {
            let difference = answer(&folder, &files);
            assert_eq!(difference["motions"], json!([]), "{name}");
            assert_eq!(difference["cycle_time_s"]["old"], difference["cycle_time_s"]["new"]);
        }
        iiwasim(&folder, &["diff", "plan.mcap", "program.json"])
            .success()
            .stdout(contains("0.000 s (0.0 %)").and(contains(" unchanged")))
            .stderr(is_empty());
    }
}

#[test]
fn names_are_in_tables_and_escaped_in_markdown() {
    let folder = tempdir().unwrap();
    let motion = |deg: f64, name: &str| {
        let joints_deg = [deg, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        json!({ "type": "ptp", "joints_deg": joints_deg, "name": name })
    };
    let program = |motions: [Value; 2]| {
        json!({ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
            "motions": motions })
    };
    let old = program([motion(20.0, "<b>a|b</b>"), motion(30.0, "first name")]);
    let new = program([motion(25.0, "<b>a|b</b>"), motion(30.0, "second name")]);
    store(&folder, "old.json", &old);
    store(&folder, "new.json", &new);
    let difference = answer(&folder, &["old.json", "new.json"]);
    assert_eq!(difference["motions"][1]["old"]["name"], "first name");
    assert_eq!(difference["motions"][1]["new"]["name"], "second name");
    iiwasim(&folder, &["diff", "old.json", "new.json"])
        .success()
        .stdout(contains("old  new  type  name").and(contains("<b>a|b</b>")));
    iiwasim(&folder, &["diff", "old.json", "new.json", "--markdown"]).success().stdout(
        contains("&lt;b>a\\|b&lt;/b>")
            .and(contains("second name, was first name"))
            .and(contains("<b>").not()),
    );
    // Plans in files have the names, too.
    iiwasim(&folder, &["plan", "old.json", "-o", "old.mcap"]).success();
    let of_plan = answer(&folder, &["old.mcap", "new.json"]);
    assert_eq!(of_plan["motions"], difference["motions"]);
    // A new name alone is a difference, too.
    let renamed = program([motion(20.0, "<b>a|b</b>"), motion(30.0, "`a_b*c`")]);
    store(&folder, "renamed.json", &renamed);
    let rows = &answer(&folder, &["old.json", "renamed.json"])["motions"];
    assert_eq!(rows.as_array().unwrap().len(), 1, "{rows}");
    assert_eq!(rows[0]["change"], "renamed");
    iiwasim(&folder, &["diff", "old.json", "renamed.json", "--markdown"])
        .success()
        .stdout(contains("1 renamed, 1 unchanged").and(contains(r"\`a\_b\*c\`, was first name")));
}

/// Times of groups before and after; a group that is the same in both is in the JSON only.
#[test]
fn groups_and_their_times_are_compared() {
    let folder = tempdir().unwrap();
    let mut old = program("waits-and-stops.json");
    old["motions"][0]["group"] = json!("a|b");
    old["motions"][7]["group"] = json!("go");
    let mut new = old.clone();
    new["motions"][7]["velocity_rel"] = json!(0.2);
    store(&folder, "old.json", &old);
    store(&folder, "new.json", &new);
    store(&folder, "same.json", &old);
    let groups = &answer(&folder, &["old.json", "new.json"])["groups"];
    let time = |group: usize, side: &str| groups[group][side]["duration_s"].as_f64().unwrap();
    assert_eq!((&groups[0]["name"], &groups[1]["name"]), (&json!("a|b"), &json!("go")));
    assert!((time(0, "old") - time(0, "new")).abs() < 1e-6, "{groups}");
    assert!(time(1, "new") > time(1, "old") + 0.1, "{groups}");
    assert_eq!(groups[1]["old"]["motions"], 1);
    let head = "group  old motions  new motions  old s  new s  change s";
    iiwasim(&folder, &["diff", "old.json", "new.json"]).success().stdout(contains(head));
    iiwasim(&folder, &["diff", "old.json", "new.json", "--markdown"])
        .success()
        .stdout(contains("|group |").and(contains("|a\\|b").not()));
    iiwasim(&folder, &["diff", "old.json", "same.json"]).success().stdout(contains("group").not());
    // Another group alone is a difference, too.
    new = old.clone();
    new["motions"][7]["group"] = json!("a|b");
    store(&folder, "new.json", &new);
    let difference = answer(&folder, &["old.json", "new.json"]);
    assert_eq!(difference["motions"], json!([]));
    assert_eq!(difference["groups"][1]["new"], Value::Null);
    iiwasim(&folder, &["diff", "old.json", "new.json"]).success().stdout(contains(head));
    iiwasim(&folder, &["diff", "old.json", "new.json", "--markdown"])
        .success()
        .stdout(contains("|a\\|b"));
}

#[test]
fn clearances_to_a_scene_are_compared() {
    let folder = tempdir().unwrap();
    let old = program("waits-and-stops.json");
    let mut new = old.clone();
    new["motions"][0]["joints_deg"][1] = json!(70);
    store(&folder, "old.json", &old);
    store(&folder, "new.json", &new);
    let scene = json!({ "version": 1, "obstacles": [
        { "name": "table", "type": "box", "center_mm": [0, 0, -500], "size_mm": [3000, 3000, 60] }
    ] });
    store(&folder, "scene.json", &scene);
    let planned = |name: &str| -> Value {
        let arguments = ["plan", name, "--scene", "scene.json", "--no-output", "--json"];
        let output = iiwasim(&folder, &arguments).success();
        serde_json::from_slice(&output.get_output().stdout).unwrap()
    };
    let difference = answer(&folder, &["old.json", "new.json", "--scene", "scene.json"]);
    for (side, name) in [("old", "old.json"), ("new", "new.json")] {
        let figures = planned(name);
        for key in ["clearance", "self_clearance"] {
            assert_eq!(difference[key][side], figures[key], "{key} {side}");
        }
    }
    assert_ne!(difference["clearance"]["old"], difference["clearance"]["new"]);
    iiwasim(&folder, &["diff", "old.json", "new.json", "--scene", "scene.json"])
        .success()
        .stdout(contains("Clearance ").and(contains(" mm before, ")).and(contains("to table at")));
    // The plan of a file has the clearance to its own scene.
    let plan = ["plan", "old.json", "--scene", "scene.json", "-o", "old.mcap"];
    iiwasim(&folder, &plan).success();
    let of_plan = answer(&folder, &["old.mcap", "new.json", "--scene", "scene.json"]);
    assert_eq!(of_plan["clearance"], difference["clearance"]);
    iiwasim(&folder, &["diff", "old.mcap", "new.json", "--scene", "scene.json"])
        .success()
        .stderr(contains("old.mcap is a plan: its clearances are those in the scene"));
    assert_eq!(answer(&folder, &["old.json", "new.json"])["clearance"], Value::Null);
}

/// A program of which only the carried workpiece grows is a changed one.
#[test]
fn programs_of_a_folder_differ_by_their_clearances() {
    let folder = tempdir().unwrap();
    let scene = json!({ "version": 1, "obstacles": [
        { "name": "table", "type": "box", "center_mm": [0, 0, -500], "size_mm": [3000, 3000, 60] }
    ] });
    store(&folder, "scene.json", &scene);
    for (version, radius_mm) in [("before", 20), ("after", 80)] {
        let mut program = program("waits-and-stops.json");
        let sphere = json!({ "type": "sphere", "center_mm": [0, 0, 100], "radius_mm": radius_mm });
        let load = json!({ "type": "load", "load": { "mass_kg": 1, "shapes": [sphere] } });
        program["motions"].as_array_mut().unwrap().insert(0, load);
        fs::create_dir(folder.path().join(version)).unwrap();
        store(&folder, &format!("{version}/p.json"), &program);
    }
    iiwasim(&folder, &["diff", "before", "after"]).success().stdout(contains("1 unchanged"));
    iiwasim(&folder, &["diff", "before", "after", "--scene", "scene.json"])
        .success()
        .stdout(contains("1 changed").and(contains("Clearance ")));
}

#[test]
fn a_gate_on_growth_names_it() {
    let folder = tempdir().unwrap();
    let old = program("appendix-b.json");
    let mut new = old.clone();
    new["override_percent"] = json!(50);
    store(&folder, "old.json", &old);
    store(&folder, "new.json", &new);
    let [before, after] = ["old.json", "new.json"].map(|file| cycle_time(&folder, file));
    let growth = format!("{:.1} %", 100.0 * (after - before) / before);
    iiwasim(&folder, &["diff", "old.json", "new.json", "--max-growth-percent", "2"])
        .code(3)
        .stdout(contains(&growth))
        .stderr(contains(format!("the cycle time grows by {growth}, more than 2 %")));
    // From a program that takes no time, every growth is too much.
    let motions = json!([{ "type": "wait", "seconds": 0 }]);
    let rest = json!({ "version": 1, "start": old["start"], "motions": motions });
    store(&folder, "rest.json", &rest);
    iiwasim(&folder, &["diff", "rest.json", "old.json", "--max-growth-percent", "2"])
        .code(3)
        .stderr(contains("the cycle time grows from 0 s, by more than 2 %"));
    // A program that became faster meets every gate.
    iiwasim(&folder, &["diff", "new.json", "old.json", "--max-growth-percent", "0"]).success();
    // In the other direction, the change has the other sign.
    let [forth, back] =
        [["old.json", "new.json"], ["new.json", "old.json"]].map(|files| answer(&folder, &files));
    assert_eq!(forth["cycle_time_s"]["old"], back["cycle_time_s"]["new"]);
    assert_eq!(forth["unchanged"], back["unchanged"]);
}

#[test]
fn folders_are_compared_by_names() {
    let folder = tempdir().unwrap();
    let mut slow = program("ten-motions.json");
    slow["override_percent"] = json!(80);
    store(&folder, "a/equal.json", &program("appendix-b.json"));
    store(&folder, "b/equal.json", &program("appendix-b.json"));
    store(&folder, "a/slow.json", &program("ten-motions.json"));
    store(&folder, "b/slow.json", &slow);
    store(&folder, "a/gone.json", &program("waits-and-stops.json"));
    store(&folder, "b/new.json", &program("waits-and-stops.json"));
    iiwasim(&folder, &["diff", "a", "b"])
        .success()
        .stdout(contains("Programs: 1 changed, 1 added, 1 removed, 1 unchanged"));
    iiwasim(&folder, &["diff", "a", "b", "--markdown"])
        .success()
        .stdout(contains("|slow.json ").and(contains("<details><summary>slow.json</summary>")))
        .stdout(contains("<summary>equal.json").not());
    let lines = iiwasim(&folder, &["diff", "a", "b", "--json"]).success();
    let lines = String::from_utf8(lines.get_output().stdout.clone()).unwrap();
    let results: Vec<Value> =
        lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let named = |name: &str| results.iter().find(|line| line["program"] == name).unwrap();
    assert_eq!(named("equal.json")["motions"], json!([]));
    assert_eq!(named("gone.json")["result"], "removed");
    assert!(named("gone.json")["cycle_time_s"]["old"].is_number());
    assert!(named("gone.json")["cycle_time_s"]["new"].is_null());
    assert_eq!(named("new.json")["result"], "added");
    assert!(!named("slow.json")["motions"].as_array().unwrap().is_empty());
    // A program with an error does not hide the others.
    fs::write(folder.path().join("b/slow.json"), r#"{ "motions": [] }"#).unwrap();
    iiwasim(&folder, &["diff", "a", "b"])
        .code(3)
        .stdout(contains("1 added, 1 removed, 1 failed, 1 unchanged"))
        .stderr(contains("slow.json").and(contains("one program failed")));
    // A change that mends it is a program that was added.
    iiwasim(&folder, &["diff", "b", "a"])
        .success()
        .stdout(contains("Programs: 2 added, 1 removed, 1 unchanged"))
        .stderr(contains("Note: slow.json before the change: "));
}

#[test]
fn unlike_inputs_are_refused() {
    let folder = tempdir().unwrap();
    store(&folder, "a/one.json", &program("appendix-b.json"));
    store(&folder, "one.json", &program("appendix-b.json"));
    iiwasim(&folder, &["diff", "a", "one.json"])
        .code(2)
        .stderr(contains("a is a folder of programs and one.json is not"));
    iiwasim(&folder, &["diff", "one.json", "one.json"]).code(2).stderr(contains("with itself"));
    iiwasim(&folder, &["diff", "one.json", "two.json"]).code(2).stderr(contains("cannot read"));
    fs::write(folder.path().join("cut.mcap"), b"\x89MCAP0\r\n\x01").unwrap();
    iiwasim(&folder, &["diff", "one.json", "cut.mcap"]).code(2).stderr(contains("cut.mcap"));
}

/// Copies the fixture project, with `from` replaced by `to` in its Java files.
#[cfg(feature = "sunrise")]
fn changed_project(name: &str, target: &Path, [from, to]: [&str; 2]) {
    let project = fixture("sunrise").join(name);
    let mut folders = vec![project.clone()];
    let mut replaced = false;
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let copy = target.join(path.strip_prefix(&project).unwrap());
            fs::create_dir_all(copy.parent().unwrap()).unwrap();
            let text = fs::read_to_string(&path).unwrap();
            let is_java = path.extension().is_some_and(|extension| extension == "java");
            replaced |= is_java && text.contains(from);
            fs::write(copy, if is_java { text.replace(from, to) } else { text }).unwrap();
        }
    }
    assert!(replaced, "no {from} in {name}");
}

/// The rows name lines of Java.
#[test]
#[cfg(feature = "sunrise")]
fn projects_are_compared_by_lines_of_java() {
    for (name, change) in CHANGES {
        let folder = tempdir().unwrap();
        changed_project(name, &folder.path().join("new"), change);
        let old = fixture("sunrise").join(name);
        let difference = answer(&folder, &[old.to_str().unwrap(), "new"]);
        let rows = difference["motions"].as_array().unwrap();
        assert!(!rows.is_empty(), "{name}");
        for row in rows {
            let source = row["new"]["source"].as_str().unwrap();
            assert!(source.contains(".java:"), "{source}");
        }
        iiwasim(&folder, &["diff", old.to_str().unwrap(), "new"])
            .success()
            .stdout(contains(".java:"));
    }
}
