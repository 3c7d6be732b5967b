//! Options of `--timing`.

use predicates::str::contains;
use tempfile::tempdir;

use crate::helpers::{figures, fixture, plan};

/// Recorded PTP motions take 4 % longer than plans under limits of jerk.
#[test]
fn ptp_motions_can_start_as_in_sunrise() {
    let folder = tempdir().unwrap();
    let program = fixture("waits-and-stops.json");
    let cycle_time = |timing: &str| {
        let options = ["--no-output", "--json", "--timing", timing];
        figures(plan(&folder, &program, &options))["cycle_time_s"].as_f64().unwrap()
    };
    let [sunrise, jerk] = ["sunrise", "jerk"].map(cycle_time);
    assert!(sunrise > 1.01 * jerk && sunrise < 1.1 * jerk, "{sunrise} {jerk}");
    let options = ["--no-output", "--timing", "sunrise"];
    let said = "PTP motions from rest to rest as Sunrise plans them";
    plan(&folder, &program, &options).success().stdout(contains(said));
    // There are no recordings of an iiwa 14: its ramps are listed as an assumption.
    let options = ["--no-output", "--timing", "sunrise", "--robot", "lbr_iiwa_14_r820"];
    plan(&folder, &program, &options).success().stdout(contains("ramps: the LBR iiwa 7's"));
}
