//! Torques in the output of `iiwasim plan`, as a gate, and as limits.

use std::{
    fs,
    path::{Path, PathBuf},
};

use predicates::{
    prelude::PredicateBooleanExt,
    str::{contains, is_empty},
};
use tempfile::tempdir;

use crate::helpers::{figures, plan};
use crate::run::{files, iiwasim};

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures").join(name)
}

/// Returns a program that lifts a load with the outstretched arm.
fn lifting(mass_kg: f64) -> String {
    format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": [0, 90, 0, 0, 0, 0, 0] }},
        "motions": [
            {{ "type": "load", "load": {{ "mass_kg": {mass_kg}, "center_mm": [0, 0, 100] }} }},
            {{ "type": "ptp", "joints_deg": [0, 60, 0, 0, 0, 0, 0] }} ] }}"#
    )
}

#[test]
fn torques_are_reported_and_are_a_gate() {
    let folder = tempdir().unwrap();
    let json = |options: &[&str]| {
        let assert = plan(&folder, &fixture("appendix-b.json"), options);
        serde_json::from_slice::<serde_json::Value>(&assert.get_output().stdout).unwrap()
    };
    let figures = json(&["--no-output", "--json"]);
    let motions = figures["motions"].as_array().unwrap();
    let percents = motions.iter().flat_map(|it| it["torque"]["peak_percent"].as_array().unwrap());
    let max = percents.map(|it| it.as_f64().unwrap()).fold(0.0, f64::max);
    assert!((20.0..100.0).contains(&max), "{max}");
    let warnings = figures["warnings"].as_array().unwrap();
    assert!(warnings.iter().all(|it| !it.as_str().unwrap().contains("Nm")), "{warnings:?}");
    assert!(figures["power"]["peak_w"].as_f64().unwrap() > 10.0);
    let shown = format!(" at {max:.0} % of its limit (");
    let below = format!("{}", max.floor());
    plan(&folder, &fixture("appendix-b.json"), &["--no-output", "--max-torque-percent", &below])
        .code(3)
        .stdout(contains(shown).and(contains("Joints (link side): ")))
        .stderr(contains(format!("needs {max:.1} % of A")).and(contains("Gate not met")));
    let above = format!("{}", max.ceil());
    plan(&folder, &fixture("appendix-b.json"), &["--no-output", "--max-torque-percent", &above])
        .success();

    let heavy = folder.path().join("heavy.json");
    fs::write(&heavy, lifting(9.0)).unwrap();
    plan(&folder, &heavy, &["--no-output"])
        .success()
        .stderr(contains("Warning: motion 2: A2 needs 1").and(contains("Nm of 176) at ")));
    fs::write(&heavy, lifting(12.0)).unwrap();
    plan(&folder, &heavy, &["--no-output", "--json"])
        .success()
        .stdout(contains("motion 2: A2 cannot hold the arm and its payload"))
        .stderr(contains("holding takes 189 Nm of its 176"));
}

#[test]
fn torques_are_limited_on_request() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("lift.json");
    fs::write(&file, lifting(9.0)).unwrap();
    let cycle_time_s = |options: &[&str]| {
        let all = figures(plan(&folder, &file, &[&["--no-output", "--json"], options].concat()));
        (all["cycle_time_s"].as_f64().unwrap(), all)
    };
    for timing in ["jerk", "acceleration"] {
        let timing = ["--timing", timing];
        let (free_s, free) = cycle_time_s(&timing);
        assert_eq!(free["limit_torque_percent"], serde_json::Value::Null);
        // The value after an equals sign, as the next argument, or omitted.
        let mut slower = [0.0; 3];
        for (slower, limit) in slower.iter_mut().zip([
            &["--limit-torque=100"][..],
            &["--limit-torque", "100"],
            &["--limit-torque"],
        ]) {
            let all;
            (*slower, all) = cycle_time_s(&[&timing, limit].concat());
            assert_eq!(all["limit_torque_percent"], 100.0);
            assert_eq!(all["motions"][0]["limited_by"]["kind"], "torque", "{all}");
            assert_eq!(all["motions"][0]["limited_by"]["joint"], 2, "{all}");
            let peak_percent = all["motions"][0]["torque"]["peak_percent"][1].as_f64().unwrap();
            assert!((98.0..=101.0).contains(&peak_percent), "{peak_percent}");
            let [rated] = &all["warnings"].as_array().unwrap()[..] else { panic!("{all}") };
            assert!(rated.as_str().unwrap().contains("rated payload of 7 kg"), "{rated}");
        }
        assert!(slower[0] > free_s && slower == [slower[0]; 3], "{free_s} {slower:?}");
    }
    let before = ["plan", "--limit-torque", "lift.json", "--no-output"];
    iiwasim(&folder, &before).success().stdout(
        contains("A2 torque")
            .and(contains("; limits: velocity, acceleration, jerk, torque (100 %)")),
    );
    plan(&folder, &file, &["--limit-torque=0"])
        .code(2)
        .stderr(contains("the range is 1 to 1000 %"));

    // The option has priority over the program.
    let keyed =
        lifting(9.0).replace("\"version\": 1,", "\"version\": 1, \"limit_torque_percent\": 110,");
    fs::write(&file, keyed).unwrap();
    assert_eq!(cycle_time_s(&[]).1["limit_torque_percent"], 110.0);
    assert_eq!(cycle_time_s(&["--limit-torque"]).1["limit_torque_percent"], 100.0);
}

#[test]
fn a_load_that_cannot_be_held_is_refused_where_it_is() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("heavy.json");
    fs::write(&file, lifting(12.0)).unwrap();
    plan(&folder, &file, &["--limit-torque"]).code(2).stdout(is_empty()).stderr(
        contains("heavy.json, line 3")
            .and(contains(
                "motion 1: A2 cannot hold the arm with its load there: standstill requires 189.",
            ))
            .and(contains("the limit is 176.0 Nm")),
    );
    assert_eq!(files(&folder), ["heavy.json"]);
    // Of several programs, the others are planned.
    let light = fixture("appendix-b.json");
    let both = ["plan", "heavy.json", light.to_str().unwrap(), "--limit-torque", "--no-output"];
    iiwasim(&folder, &both).code(3).stderr(contains("A2 cannot hold"));
}
