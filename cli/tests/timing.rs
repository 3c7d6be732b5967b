//! What motions are timed by.

use std::path::Path;

use assert_cmd::{assert::Assert, cargo::cargo_bin_cmd};
use predicates::str::contains;
use tempfile::{TempDir, tempdir};

use crate::helpers::fixture;

fn plan(folder: &TempDir, program: &Path, arguments: &[&str]) -> Assert {
    cargo_bin_cmd!("iiwasim").current_dir(folder).arg("plan").arg(program).args(arguments).assert()
}

/// Recordings of the robot are 4 % longer than what limits of jerk allow.
#[test]
fn ptp_motions_can_start_as_in_sunrise() {
    let folder = tempdir().unwrap();
    let program = fixture("waits-and-stops.json");
    let cycle_time = |timing: &str| {
        let options = ["--no-output", "--json", "--timing", timing];
        let output = plan(&folder, &program, &options).success().get_output().stdout.clone();
        let figures: serde_json::Value = serde_json::from_slice(&output).unwrap();
        figures["cycle_time_s"].as_f64().unwrap()
    };
    let [sunrise, jerk] = ["sunrise", "jerk"].map(cycle_time);
    assert!(sunrise > 1.01 * jerk && sunrise < 1.1 * jerk, "{sunrise} {jerk}");
    let options = ["--no-output", "--timing", "sunrise"];
    let said = "PTP motions from rest to rest as Sunrise plans them";
    plan(&folder, &program, &options).success().stdout(contains(said));
    // On an arm that nobody has recorded, the law is an assumption.
    let options = ["--no-output", "--timing", "sunrise", "--robot", "lbr_iiwa_14_r820"];
    plan(&folder, &program, &options).success().stdout(contains("ramps: the LBR iiwa 7's"));
}
