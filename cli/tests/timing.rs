//! Options of `--timing`.

use std::fs;

use predicates::str::contains;
use tempfile::tempdir;

use crate::helpers::{figures, fixture, plan};
use crate::run::iiwasim;

/// Recorded PTP motions take 4 % longer than jerk-limited plans, short ones more.
#[test]
fn ptp_motions_can_start_as_in_sunrise() {
    let folder = tempdir().unwrap();
    let program = fixture("waits-and-stops.json");
    let cycle_time = |timing: &str| {
        let options = ["--no-output", "--json", "--timing", timing];
        figures(plan(&folder, &program, &options))["cycle_time_s"].as_f64().unwrap()
    };
    let [sunrise, jerk] = ["sunrise", "jerk"].map(cycle_time);
    assert!(sunrise > 1.01 * jerk && sunrise < 1.2 * jerk, "{sunrise} {jerk}");
    let options = ["--no-output", "--timing", "sunrise"];
    let said = "PTP motions from rest to rest (1 of 6 motions): timing as recorded under Sunrise";
    plan(&folder, &program, &options).success().stdout(contains(said));
    // There are no recordings of an iiwa 14: its ramps are listed as an assumption.
    let options = ["--no-output", "--timing", "sunrise", "--robot", "lbr_iiwa_14_r820"];
    plan(&folder, &program, &options).success().stdout(contains("ramps: the LBR iiwa 7's"));
}

#[test]
fn timing_assumptions_are_reported() {
    let folder = tempdir().unwrap();
    let line = r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] }, "motions": [
        { "type": "ptp", "joints_deg": [90, 0, 0, 0, 0, 0, 0] } ] }"#;
    fs::write(folder.path().join("line.json"), line).unwrap();
    let short = line.replace("90, 0", "1, 0").replace("] } ]", "], \"blocking\": true } ]");
    fs::write(folder.path().join("short.json"), short).unwrap();
    let appendix = fixture("appendix-b.json").display().to_string();
    for (program, expected) in [
        ("line.json", "No assumptions about the controller"),
        ("short.json", "Assumption for motion 1: PTP without a cruise"),
        (
            "short.json",
            "Assumption for motion 1: standstill after motions that the program waits for: 93 ms",
        ),
        (&appendix, "Assumption for 3 motions, the first is 2: blends"),
    ] {
        iiwasim(&folder, &["plan", program, "--no-output", "--assumptions"])
            .success()
            .stdout(contains(expected));
    }
    iiwasim(&folder, &["plan", "short.json", "--no-output", "--json"])
        .success()
        .stdout(contains("\"rests_on\":[{\"what\":\"PTP without a cruise"));
}
