//! `iiwasim report` as a process: content of the page, and files that cannot be shown.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::{collections::BTreeMap, fmt::Write as _, fs, io::Cursor, time::Duration};

use iiwa_kin::Robot;
use iiwa_log::{JointLog, Recorder, RecorderConfig, Recording};
use predicates::{
    prelude::PredicateBooleanExt,
    str::{contains, is_empty},
};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

use crate::helpers::fixture;
use crate::run::{files, iiwasim};

/// Returns a folder with the plan of a fixture.
fn plan(name: &str) -> TempDir {
    let folder = tempdir().unwrap();
    let program = fixture(name);
    iiwasim(&folder, &["plan", program.to_str().unwrap(), "-o", "plan.mcap"]).success();
    folder
}

/// Returns the page of a file.
pub(crate) fn page(folder: &TempDir, arguments: &[&str]) -> String {
    let all = [&["report"], arguments, &["-o", "page.html"]].concat();
    iiwasim(folder, &all).success().stdout(contains("Page in page.html"));
    fs::read_to_string(folder.path().join("page.html")).unwrap()
}

pub(crate) fn data(html: &str) -> Value {
    let (_, rest) = html.split_once(r#"<script id="data" type="application/json">"#).unwrap();
    let (json, _) = rest.split_once("</script>").unwrap();
    serde_json::from_str(json).unwrap()
}

/// Decodes base64 text.
fn bytes(text: &Value) -> Vec<u8> {
    let digit = |c: char| match c {
        'A'..='Z' => c as u32 - 65,
        'a'..='z' => c as u32 - 71,
        '0'..='9' => c as u32 + 4,
        '+' => 62,
        _ => 63,
    };
    let digits: Vec<u32> =
        text.as_str().unwrap().trim_end_matches('=').chars().map(digit).collect();
    let four = |digits: &[u32]| {
        let bits =
            digits.iter().fold(0, |bits, digit| bits << 6 | digit) << (6 * (4 - digits.len()));
        bits.to_be_bytes()[1..digits.len()].to_vec()
    };
    digits.chunks(4).flat_map(four).collect()
}

fn doubles(text: &Value) -> Vec<f64> {
    bytes(text).chunks(8).map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap())).collect()
}

fn singles(text: &Value) -> Vec<f64> {
    bytes(text).chunks(4).map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap()))).collect()
}

#[test]
fn a_page_needs_nothing_but_itself() {
    let folder = plan("ten-motions.json");
    let html = page(&folder, &["plan.mcap"]);
    assert!(html.len() < 6_000_000, "{} bytes", html.len());
    for outside in ["http:", "https:", "//www", "src=", "@import", "url(", "fetch(", "import("] {
        assert!(!html.contains(outside), "{outside}");
    }
    for place in ["/*style.css*/", "/*main.js*/", "<!--data-->", "<!--title-->"] {
        assert!(!html.contains(place), "{place}");
    }
    assert!(html.contains("<title>plan.mcap - iiwasim</title>"));
    // The same input gives the same page.
    assert_eq!(page(&folder, &["plan.mcap"]), html);
    // The default name of the page is that of the file.
    iiwasim(&folder, &["report", "plan.mcap"]).success().stderr(is_empty());
    assert_eq!(files(&folder), ["page.html", "plan.html", "plan.mcap"]);
}

/// The page contains the scene and the clearance of the plan if a scene is given; otherwise
/// neither.
#[test]
fn a_scene_is_around_the_arm() {
    let folder = plan("ten-motions.json");
    let without = data(&page(&folder, &["plan.mcap"]));
    assert!(without.get("scene").is_none() && without["arms"][0].get("clearance").is_none());
    let mut scene: Value =
        serde_json::from_str(&fs::read_to_string(fixture("cage.json")).unwrap()).unwrap();
    for tool in [
        serde_json::json!([]),
        serde_json::json!([{ "type": "sphere", "center_mm": [0, 20, 60], "radius_mm": 45 }]),
        // The arm touches the table, and later the brace: the first contact counts.
        serde_json::json!([
            { "type": "cylinder", "center_mm": [0, 0, 100], "radius_mm": 40, "length_mm": 200 }
        ]),
    ] {
        scene["tool"] = tool;
        fs::write(folder.path().join("scene.json"), scene.to_string()).unwrap();
        let mut with = data(&page(&folder, &["plan.mcap", "--scene", "scene.json"]));
        let program = fixture("ten-motions.json");
        let planned = ["plan", program.to_str().unwrap(), "--json", "--no-output"];
        let planned = iiwasim(&folder, &[&planned[..], &["--scene", "scene.json"]].concat());
        let figures: Value = serde_json::from_slice(&planned.get_output().stdout).unwrap();
        let (expected, actual) = (&figures["clearance"], &with["arms"][0]["clearance"]["nearest"]);
        for (key, tolerance) in [("distance_mm", 0.1), ("at_s", 0.01)] {
            let off = expected[key].as_f64().unwrap() - actual[key].as_f64().unwrap();
            assert!(off.abs() < tolerance, "{expected} {actual}");
        }
        assert_eq!((&expected["link"], &expected["obstacle"]), (&actual["link"], &actual["other"]));
        let (planned, nearest) =
            (&figures["self_clearance"], &with["arms"][0]["self_clearance"]["nearest"]);
        let off =
            planned["distance_mm"].as_f64().unwrap() - nearest["distance_mm"].as_f64().unwrap();
        assert!(off.abs() < 0.1, "{planned} {nearest}");
        assert_eq!(nearest["link"], planned["link"]);
        assert_eq!(nearest["other"], format!("link {}", planned["other_link"]));
        // The curve has the same minimum, up to its sampling.
        let curve = singles(&with["arms"][0]["clearance"]["distance"]["low"]);
        let min_mm = 1e3 * curve.into_iter().fold(f64::MAX, f64::min);
        let off = min_mm - actual["distance_mm"].as_f64().unwrap();
        assert!((-1e-4..2.0).contains(&off), "{off}");
        assert_eq!(
            with["scene"]["tool"].as_array().unwrap().len(),
            scene["tool"].as_array().unwrap().len()
        );
        // All other data are unchanged.
        with.as_object_mut().unwrap().remove("scene");
        for distance in ["clearance", "self_clearance"] {
            with["arms"][0].as_object_mut().unwrap().remove(distance);
        }
        assert_eq!(with, without);
    }
    let over = ["report", "plan.mcap", "--scene", "scene.json", "-o", "scene.json"];
    iiwasim(&folder, &over).code(2).stderr(contains("over the scene"));
    iiwasim(&folder, &["report", "plan.mcap", "--scene", "plan.mcap"]).code(2);
}

#[test]
fn a_plan_is_in_its_page() {
    let folder = plan("ten-motions.json");
    let data = data(&page(&folder, &["plan.mcap"]));
    let file = Recording::from_bytes(&fs::read(folder.path().join("plan.mcap")).unwrap()).unwrap();
    let assert = iiwasim(
        &folder,
        &["plan", fixture("ten-motions.json").to_str().unwrap(), "--json", "--no-output"],
    );
    let figures: Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    for key in ["cycle_time_s", "motion_time_s", "timing", "motions", "blends"] {
        assert_eq!(data["figures"][key], figures[key], "{key}");
    }

    let arm = &data["arms"][0];
    assert_eq!((&arm["role"], &arm["file"]), (&"plan".into(), &"plan.mcap".into()));
    let curves = ["position", "velocity", "acceleration"].map(|name| {
        assert_eq!(arm[name]["samples_a_column"], 1);
        (doubles(&arm[name]["t_s"]), singles(&arm[name]["low"]))
    });
    // Every trajectory node of the file is on the curves.
    for point in &file.trajectory {
        let t_s = point.time_from_start.as_secs_f64();
        let values = [&point.positions, &point.velocities, &point.accelerations];
        for ((times, rows), values) in curves.iter().zip(values) {
            let index = times.partition_point(|time| *time < t_s - 1e-9);
            assert!((times[index] - t_s).abs() < 1e-9, "{t_s}");
            for (actual, value) in rows[7 * index..7 * index + 7].iter().zip(values) {
                assert!((actual - value).abs() <= 1e-6 * value.abs().max(1.0), "{t_s}: {actual}");
            }
        }
    }
    // The joint states are on the curves, too.
    let (times, rows) = &curves[0];
    for state in &file.joint_states {
        let index = times.partition_point(|time| *time <= state.t_s).clamp(1, times.len() - 1);
        let share = (state.t_s - times[index - 1]) / (times[index] - times[index - 1]);
        for (j, q) in state.q.iter().enumerate() {
            let [a, b] = [index - 1, index].map(|i| rows[7 * i + j]);
            assert!((a + share.min(1.0) * (b - a) - q).abs() < 5e-4, "{}: {q}", state.t_s);
        }
    }
    // The mean jerk keeps its limits, up to the planner's tolerance between nodes.
    let limits = Robot::default().limits().jerk_rad_s3;
    for row in singles(&arm["jerk"]["low"]).chunks(7) {
        for (jerk, limit) in row.iter().zip(limits) {
            assert!(jerk.abs() < 1.04 * limit, "{jerk} {limit}");
        }
    }
    let kinds = data["pieces"].as_array().unwrap().iter().map(|piece| &piece["kind"]);
    assert_eq!(kinds.filter(|kind| **kind == "blend").count(), 9);
    assert_eq!(data["pieces"].as_array().unwrap().len(), file.motions.len());
    assert_eq!(data["robot"]["urdf"], file.robot_description.unwrap());
    assert_eq!(data["notes"].as_array().unwrap().len(), 0);
}

#[test]
fn spheres_are_about_their_targets() {
    let folder = plan("appendix-b.json");
    let data = data(&page(&folder, &["plan.mcap"]));
    let corners = data["corners"].as_array().unwrap();
    assert!(!corners.is_empty());
    let middles = data["figures"]["blends"].as_array().unwrap();
    for (corner, blend) in corners.iter().zip(middles) {
        assert_eq!(corner["motion"], blend["after_motion"]);
        let Some(radius_m) = corner["radius_m"].as_f64() else { continue };
        let number = |list: &Value, i: usize| list[i].as_f64().unwrap();
        let off = |i| number(&corner["target_m"], i) - number(&blend["mid_tcp_m"], i);
        let away_m = (0..3).map(|i| off(i) * off(i)).sum::<f64>().sqrt();
        assert!(away_m < radius_m, "{away_m} {radius_m}");
    }
}

/// The arm is at rest at the smallest clearance: plan, report and the report of a recording name
/// the time of its arrival.
#[test]
fn the_nearest_instant_is_the_same_everywhere() {
    let folder = tempdir().unwrap();
    let program = r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, -60, 0, 60, 0] },
        "motions": [
            { "type": "ptp", "joints_deg": [13, 61, 7, -31, 5, 50, 0] },
            { "type": "wait", "seconds": 1 },
            { "type": "ptp", "joints_deg": [0, 0, 0, -60, 0, 60, 0] } ] }"#;
    let scene = r#"{ "version": 1, "obstacles": [
        { "name": "wall", "type": "plane", "point_mm": [1200, 300, 0],
          "normal": [-1, -0.1, 0.02] } ] }"#;
    fs::write(folder.path().join("program.json"), program).unwrap();
    fs::write(folder.path().join("scene.json"), scene).unwrap();
    let planned = iiwasim(
        &folder,
        &[
            "plan",
            "program.json",
            "--timing",
            "jerk",
            "--scene",
            "scene.json",
            "-o",
            "plan.mcap",
            "--json",
        ],
    );
    let planned: Value = serde_json::from_slice(&planned.success().get_output().stdout).unwrap();
    let at_s = planned["clearance"]["at_s"].as_f64().unwrap();
    let measured = recorded(&fs::read(folder.path().join("plan.mcap")).unwrap(), program);
    fs::write(folder.path().join("measured.mcap"), measured).unwrap();
    let data = data(&page(&folder, &["plan.mcap", "measured.mcap", "--scene", "scene.json"]));
    for arm in data["arms"].as_array().unwrap() {
        let found_s = arm["clearance"]["nearest"]["at_s"].as_f64().unwrap();
        assert!((found_s - at_s).abs() < 0.015, "{found_s} {at_s}");
    }
}

#[test]
fn two_files_are_held_against_each_other() {
    let folder = plan("waits-and-stops.json");
    let program = fixture("waits-and-stops.json");
    let other = ["-o", "real.mcap", "--timing", "acceleration", "--blend-shape", "alpha"];
    let rate = ["--rate", "1000"];
    iiwasim(&folder, &[&["plan", program.to_str().unwrap()], &other[..], &rate].concat()).success();
    let assert = iiwasim(&folder, &["compare", "plan.mcap", "real.mcap", "--json"]);
    let compared: Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    let data = data(&page(&folder, &["plan.mcap", "real.mcap"]));
    assert_eq!(data["compared"]["report"], compared);
    assert_eq!(data["arms"].as_array().unwrap().len(), 2);
    let most_mm = singles(&data["compared"]["tcp_mm"]["low"]).into_iter().fold(0.0, f64::max);
    let max_mm = compared["tcp_deviation"]["max_mm"].as_f64().unwrap();
    assert!((most_mm - max_mm).abs() < 0.05 * max_mm, "{most_mm} {max_mm}");
    // The second motion begins at the departure of the arm, not at the start of its file.
    let start_s = data["arms"][1]["start_s"].as_f64().unwrap();
    let departure_s = compared["departure_s"].as_f64().unwrap();
    let moves = |piece: &&Value| piece["kind"] == "line" || piece["kind"] == "blend";
    let pieces = data["pieces"].as_array().unwrap();
    let leaves_s = pieces.iter().find(moves).unwrap()["start_s"].as_f64().unwrap();
    assert!((start_s - (leaves_s - departure_s)).abs() < 1e-9);
}

#[test]
fn narrower_motion_limits_are_reported() {
    let folder = plan("waits-and-stops.json");
    let data = data(&page(&folder, &["plan.mcap"]));
    let shares = data["shares"].as_object().unwrap();
    assert_eq!(shares.keys().collect::<Vec<_>>(), ["4", "6", "8"]);
    let each = |share: f64| Value::from(vec![share; 7]);
    assert_eq!(shares["4"]["velocity"], each(0.4));
    assert_eq!(shares["4"]["acceleration"], each(1.0));
    let mixed = Value::from(vec![1.0, 0.5, 1.0, 0.5, 1.0, 0.5, 1.0]);
    assert_eq!(shares["6"]["acceleration"], mixed);
    assert_eq!(shares["8"]["jerk"], each(1.0));
}

/// Returns the recording of a robot that moves as planned, with its program.
fn recorded(plan: &[u8], program: &str) -> Vec<u8> {
    let log = JointLog::read(plan).unwrap();
    let storage = Cursor::new(Vec::new());
    let mut recorder =
        Recorder::new(storage, &Robot::default(), RecorderConfig::default()).unwrap();
    for (t_s, q) in log.t_s.iter().zip(&log.q_rad) {
        recorder.sample(Duration::from_secs_f64(*t_s), q).unwrap();
    }
    let program = ("program.json", "application/json", program.as_bytes());
    recorder.finish(&BTreeMap::new(), &[program]).unwrap().into_inner()
}

#[test]
fn a_recording_alone_is_beside_the_plan_of_its_program() {
    let folder = plan("waits-and-stops.json");
    let whole = fs::read(folder.path().join("plan.mcap")).unwrap();
    let program = fs::read_to_string(fixture("waits-and-stops.json")).unwrap();
    fs::write(folder.path().join("real.mcap"), recorded(&whole, &program)).unwrap();
    let with_plan = data(&page(&folder, &["plan.mcap", "real.mcap"]));
    let html = page(&folder, &["real.mcap"]);
    assert!(html.contains("<title>real.mcap - iiwasim</title>"));
    let alone = data(&html);
    for key in ["pieces", "corners", "shares", "robot"] {
        assert_eq!(alone[key], with_plan[key], "{key}");
    }
    for key in ["cycle_time_s", "motions", "blends"] {
        assert_eq!(alone["figures"][key], with_plan["figures"][key], "{key}");
    }
    for key in ["cycle_time", "motions", "joint_deviation", "tcp_deviation"] {
        let [alone, with_plan] = [&alone, &with_plan].map(|data| &data["compared"]["report"][key]);
        assert_eq!(alone, with_plan, "{key}");
    }
    let roles = |data: &Value| [0, 1].map(|i| data["arms"][i]["role"].clone());
    assert_eq!(roles(&alone), ["plan", "recording"]);
    assert_eq!(alone["arms"][1], with_plan["arms"][1]);
    assert!(alone["notes"].to_string().contains("made for this page"), "{}", alone["notes"]);

    // A recording is shown even if its program cannot be planned.
    let broken = program.replace("[40, 45", "[400, 45");
    fs::write(folder.path().join("real.mcap"), recorded(&whole, &broken)).unwrap();
    let alone = data(&page(&folder, &["real.mcap"]));
    assert_eq!(alone["arms"].as_array().unwrap().len(), 1);
    assert!(alone["notes"].to_string().contains("no plan of the program"), "{}", alone["notes"]);
}

#[test]
fn a_plan_that_does_not_match_its_recording_is_reported() {
    let folder = plan("waits-and-stops.json");
    let whole = fs::read(folder.path().join("plan.mcap")).unwrap();
    fs::write(folder.path().join("real.mcap"), recorded(&whole, "{}")).unwrap();
    iiwasim(&folder, &["report", "real.mcap", "plan.mcap"])
        .code(2)
        .stderr(contains("real.mcap is a recording").and(contains("name the plan first")));
    iiwasim(&folder, &["report", "plan.mcap", "plan.mcap", "-o", "x.html"])
        .success()
        .stderr(contains("a plan, too: nothing in it was measured"));
    iiwasim(&folder, &["report", "real.mcap", "real.mcap", "-o", "x.html"])
        .success()
        .stderr(contains("not compared").and(contains("not a whole plan")));
    // Plan of another robot.
    let program = fs::read_to_string(fixture("appendix-b.json")).unwrap();
    let program = program.replace("lbr_iiwa_7_r800", "lbr_iiwa_14_r820");
    fs::write(folder.path().join("other.json"), program).unwrap();
    iiwasim(&folder, &["plan", "other.json", "-o", "other.mcap"]).success();
    for arguments in [["other.mcap", "real.mcap"], ["plan.mcap", "other.mcap"]] {
        iiwasim(&folder, &[&["report"], &arguments[..]].concat())
            .code(2)
            .stderr(contains("robot").and(contains("lbr_iiwa_14_r820")));
    }
}

/// Returns a table of `seconds` at `rate_hz` of a joint that oscillates at 1 Hz, with one outlier.
fn csv(seconds: u32, rate_hz: u32) -> String {
    let mut text = String::from("t_s,q1,q2,q3,q4,q5,q6,q7\n");
    for k in 0..seconds * rate_hz {
        let t_s = f64::from(k) / f64::from(rate_hz);
        let off = if k == 12_345 { 0.01 } else { 0.0 };
        let q = 0.2 * (t_s * std::f64::consts::TAU).sin() + off;
        writeln!(text, "{t_s},{q:.9},0.1,0.2,-1,0,0.5,0").unwrap();
    }
    text
}

#[test]
fn long_recordings_are_thinned_out_and_keep_their_peaks() {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("long.csv"), csv(120, 1000)).unwrap();
    let assert = iiwasim(&folder, &["report", "long.csv", "-o", "page.html"]).success();
    assert.stderr(contains("names no robot"));
    let html = fs::read_to_string(folder.path().join("page.html")).unwrap();
    assert!(html.len() < 6_000_000, "{} bytes", html.len());
    let data = data(&html);
    let arm = &data["arms"][0];
    assert_eq!((&arm["role"], &arm["samples"]), (&"recording".into(), &120_000.into()));
    assert_eq!(arm["position"]["samples_a_column"], 15);
    assert_eq!(data["pieces"].as_array().unwrap().len(), 0);
    let times = doubles(&arm["position"]["t_s"]);
    let [low, high] = ["low", "high"].map(|name| singles(&arm["position"][name]));
    let index = times.partition_point(|t_s| *t_s <= 12.345) - 1;
    let q = 0.2 * (0.345 * std::f64::consts::TAU).sin() + 0.01;
    assert!((high[7 * index] - q).abs() < 1e-6, "{}", high[7 * index]);
    // The velocity is that of the sine with its known amplitude.
    let velocity = singles(&arm["velocity"]["low"]);
    let peak = velocity.chunks(7).skip(2000).map(|row| row[0].abs()).fold(0.0, f64::max);
    assert!((peak / (0.2 * std::f64::consts::TAU) - 1.0).abs() < 0.01, "{peak}");
    assert!(low.iter().chain(&high).all(|q| q.is_finite()));
}

#[test]
fn a_file_that_is_cut_off_is_shown_up_to_its_break() {
    let folder = tempdir().unwrap();
    // Long enough for several chunks.
    let program = fixture("waits-and-stops.json");
    let fast = ["plan", program.to_str().unwrap(), "-o", "plan.mcap", "--rate", "4000"];
    iiwasim(&folder, &fast).success();
    let whole = fs::read(folder.path().join("plan.mcap")).unwrap();
    fs::write(folder.path().join("cut.mcap"), &whole[..whole.len() * 2 / 3]).unwrap();
    let assert = iiwasim(&folder, &["report", "cut.mcap", "-o", "page.html"]).success();
    assert.stderr(contains("the file is cut off"));
    let html = fs::read_to_string(folder.path().join("page.html")).unwrap();
    let data = data(&html);
    let notes = data["notes"].to_string();
    assert!(notes.contains("is lost") && notes.contains("cut off"), "{notes}");
    let log = JointLog::read(&whole[..whole.len() * 2 / 3]).unwrap();
    assert_eq!(data["arms"][0]["samples"], log.t_s.len());
    assert_eq!(data["arms"][0]["end_s"], *log.t_s.last().unwrap());
    assert_eq!(data["arms"][0]["role"], "part");
    assert!(!data["pieces"].as_array().unwrap().is_empty());

    // With the whole plan, both are shown, and the reason for missing errors.
    let assert = iiwasim(&folder, &["report", "plan.mcap", "cut.mcap", "-o", "both.html"]);
    assert.success().stderr(contains("not compared").and(contains("cut off")));
}

#[test]
fn unsupported_files_are_rejected() {
    let folder = plan("waits-and-stops.json");
    let write = |name: &str, content: &[u8]| {
        fs::write(folder.path().join(name), content).unwrap();
    };
    write("empty.mcap", b"");
    write("text.csv", b"not a table\n");
    let whole = fs::read(folder.path().join("plan.mcap")).unwrap();
    write("cut.mcap", &whole[..200]);
    write("far.csv", b"t_s,q1,q2,q3,q4,q5,q6,q7\n0,0,2.5,0,0,0,0,0\n0.1,0,2.5,0,0,0,0,0\n");
    let before = files(&folder);
    for (file, words) in [
        ("empty.mcap", "the file is empty"),
        ("text.csv", "neither an MCAP file nor a table"),
        ("cut.mcap", "cut off"),
        ("far.csv", "joint A2"),
        ("none.mcap", "cannot read none.mcap"),
    ] {
        for arguments in [vec![file], vec!["plan.mcap", file]] {
            let all = [&["report"], &arguments[..], &["-o", "x.html"]].concat();
            let assert = iiwasim(&folder, &all).code(2).stdout(is_empty());
            let message = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
            let message = message.replace("\n  │ ", " ");
            assert!(message.contains(words), "{file}: {message}");
        }
    }
    // A page that cannot be written is not an input fault.
    iiwasim(&folder, &["report", "plan.mcap", "-o", "none/x.html"]).code(1);
    iiwasim(&folder, &["report", "."]).code(2).stderr(contains("is a directory"));
    let over = ["report", "plan.mcap", "-o", "plan.mcap"];
    iiwasim(&folder, &over).code(2).stderr(contains("written over"));
    assert_eq!(fs::read(folder.path().join("plan.mcap")).unwrap(), whole);
    assert_eq!(files(&folder), before);
}

#[test]
fn a_file_without_joint_states_is_named() {
    let folder = tempdir().unwrap();
    let stream = std::io::Cursor::new(Vec::new());
    let mut writer = iiwa_log::Writer::new(stream, iiwa_log::Config::default()).unwrap();
    writer.robot_description(std::time::Duration::ZERO, &Robot::default().to_urdf()).unwrap();
    let file = writer.finish().unwrap().into_inner();
    fs::write(folder.path().join("described.mcap"), file).unwrap();
    iiwasim(&folder, &["report", "described.mcap"])
        .code(2)
        .stderr(contains("described.mcap").and(contains("no joint positions in the file")));
}

#[test]
fn file_names_are_escaped() {
    let folder = tempdir().unwrap();
    let name = "<script>&x.csv";
    fs::write(folder.path().join(name), csv(1, 100)).unwrap();
    let html = page(&folder, &[name]);
    assert!(html.contains("<title>&lt;script&gt;&amp;x.csv - iiwasim</title>"));
    assert_eq!(html.matches("<script").count(), 2);
    assert_eq!(data(&html)["arms"][0]["file"], name);
}

/// Tetrahedron as OBJ.
const WEDGE: &str = "v 0 0 0\nv 60 0 0\nv 0 40 0\nv 0 0 20\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// Returns the generated URDF, with this mesh on link 4.
fn urdf_with(robot: &Robot, mesh: &str) -> String {
    let visual = format!(
        "<link name=\"iiwa_link_4\"><visual><geometry><mesh filename=\"{mesh}\" scale=\"0.001 \
         0.001 0.001\"/></geometry>\
         <material name=\"red\"><color rgba=\"1 0 0 1\"/></material></visual>"
    );
    robot.to_urdf().replace("<link name=\"iiwa_link_4\">", &visual)
}

#[test]
fn meshes_of_a_urdf_are_drawn() {
    let folder = plan("appendix-b.json");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    write("cell/arm/meshes/wedge.obj", WEDGE);
    let urdf = urdf_with(&Robot::default(), "package://arm/meshes/wedge.obj");
    write("arm.urdf", &urdf);
    // A second slash does not make the path absolute.
    write("slashes.urdf", &urdf.replace("arm/meshes", "arm//meshes"));
    let single = data(&page(&folder, &["plan.mcap"]));
    let links = single["robot"]["look"]["links"].as_array().unwrap();
    assert!(links.iter().all(|link| !link.as_array().unwrap().is_empty()));
    assert_eq!(single["robot"]["look"]["is_closed"], true);
    // The folder that contains the package, the package itself, and a folder beside the URDF.
    write("arm/urdf/arm.urdf", &urdf);
    write("arm/meshes/wedge.obj", WEDGE);
    for arguments in [
        &["--urdf", "arm.urdf", "--package-path", "cell"][..],
        &["--urdf", "arm.urdf", "--package-path", "cell/arm"],
        &["--urdf", "slashes.urdf", "--package-path", "cell"],
        &["--urdf", "arm/urdf/arm.urdf"],
    ] {
        let data = data(&page(&folder, &[&["plan.mcap"], arguments].concat()));
        let links = data["robot"]["look"]["links"].as_array().unwrap();
        let counts: Vec<_> = links.iter().map(|link| link.as_array().unwrap().len()).collect();
        assert_eq!(counts, [0, 0, 0, 0, 1, 0, 0, 0]);
        let surface = &links[4][0];
        assert_eq!(surface["paint"], Value::from(vec![255, 0, 0]));
        // Creases on all edges: three corners for each of four triangles.
        assert_eq!(bytes(&surface["positions"]).len(), 12 * 6);
        let longest = surface["size_m"].as_array().unwrap()[0].as_f64().unwrap();
        assert!((longest - 0.06).abs() < 1e-9, "{longest}");
    }
}

#[test]
fn a_urdf_without_its_meshes_is_refused() {
    let folder = plan("appendix-b.json");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let refused = |urdf: &str, more: &[&str], why: &str| {
        write("arm.urdf", urdf);
        let arguments = [&["report", "plan.mcap", "--urdf", "arm.urdf"], more].concat();
        iiwasim(&folder, &arguments).code(2).stderr(contains(why));
    };
    let robot = Robot::default();
    refused(&urdf_with(&robot, "package://arm/wedge.obj"), &[], "--package-path");
    let more = ["--package-path", "."];
    refused(&urdf_with(&robot, "package://arm/wedge.obj"), &more, "unknown package arm");
    refused(&urdf_with(&robot, "wedge.obj"), &["--package-path", "nowhere"], "no such folder");
    refused(&urdf_with(&robot, "wedge.obj"), &[], "no such file");
    write("wedge.obj", "v 0 0 0\n");
    refused(&urdf_with(&robot, "wedge.obj"), &[], "no triangles");
    refused(&robot.to_urdf(), &[], "names no meshes");
    write("wedge.obj", WEDGE);
    refused(&urdf_with(&Robot::lbr_iiwa_14_r820(), "wedge.obj"), &[], "axis of joint 2");
    iiwasim(&folder, &["plan", fixture("appendix-b.json").to_str().unwrap(), "--urdf", "arm.urdf"])
        .code(2)
        .stderr(contains("needs --scene"));
    // The URDF is not overwritten.
    iiwasim(&folder, &["report", "plan.mcap", "--urdf", "arm.urdf", "-o", "arm.urdf"]).code(2);
}

/// The clearance is that of the convex hull of the mesh.
#[test]
fn clearances_are_those_of_meshes() {
    let folder = plan("appendix-b.json");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    // Far longer than the built-in shapes.
    write("wedge.obj", &WEDGE.replace("v 60 0 0", "v 400 0 0").replace("v 0 0 20", "v 0 0 400"));
    write("arm.urdf", &urdf_with(&Robot::default(), "wedge.obj"));
    let program = fixture("appendix-b.json");
    let cage = fixture("cage.json");
    let base = [
        "plan",
        program.to_str().unwrap(),
        "--no-output",
        "--json",
        "--scene",
        cage.to_str().unwrap(),
    ];
    let distance = |more: &[&str]| {
        let assert = iiwasim(&folder, &[&base[..], more].concat());
        let figures: Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
        figures["clearance"]["distance_mm"].as_f64().unwrap_or_else(|| panic!("{figures}"))
    };
    let (plain, meshed) = (distance(&[]), distance(&["--urdf", "arm.urdf"]));
    assert!(meshed < plain - 1.0, "{meshed} {plain}");
}
