//! A plan keeps the robot that it was made for: its page and its comparison use that robot's
//! limits, not those of the built-in robot with the same name.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::{fs, iter};

use iiwa_kin::Robot;
use iiwa_log::{JointLog, PlanRecord};
use predicates::str::contains;
use serde_json::Value;
use tempfile::{TempDir, tempdir};

use crate::helpers::program;
use crate::run::iiwasim;

/// Profile in which joint 1 has a larger range than in the built-in robot (170 deg), and half of
/// its speed (98 deg/s).
const PROFILE: &str = r#"{ "version": 1,
    "position_limit_deg": [178, 120, 170, 120, 170, 120, 175],
    "velocity_limit_deg_s": [49, 98, 100, 130, 140, 180, 180] }"#;

/// Returns a folder with a plan for `profile`, and the same motion as a table.
fn plan(profile: &str) -> TempDir {
    let folder = tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("robot.json"), profile).unwrap();
    let motion = r#"{ "type": "ptp", "joints_deg": [175, 0, 0, -60, 0, 90, 0] }"#;
    fs::write(path("program.json"), program(motion)).unwrap();
    iiwasim(&folder, &["plan", "program.json", "--robot", "robot.json", "-o", "plan.mcap"])
        .success();
    let log = JointLog::read(fs::File::open(path("plan.mcap")).unwrap()).unwrap();
    log.write_csv(fs::File::create(path("real.csv")).unwrap()).unwrap();
    // The profile must come from the plan.
    fs::remove_file(path("robot.json")).unwrap();
    folder
}

/// Returns the data of the page.
fn page(folder: &TempDir, files: &[&str]) -> Value {
    let arguments: Vec<_> =
        iter::once("report").chain(files.iter().copied()).chain(["-o", "page.html"]).collect();
    iiwasim(folder, &arguments).success();
    let html = fs::read_to_string(folder.path().join("page.html")).unwrap();
    let (_, rest) = html.split_once(r#"<script id="data" type="application/json">"#).unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn a_profile_without_a_name_is_not_taken_for_the_built_in_robot() {
    let folder = plan(PROFILE);
    let file = fs::File::open(folder.path().join("plan.mcap")).unwrap();
    let record = PlanRecord::read(file).unwrap();
    let robot = Robot::from_profile(PROFILE).unwrap();
    assert_eq!(record.robot().unwrap(), Some(robot.clone()));
    assert_eq!(robot.name(), Robot::default().name());

    for files in [&["plan.mcap"][..], &["plan.mcap", "real.csv"]] {
        let data = page(&folder, files);
        let [velocity, position] =
            ["velocity_rad_s", "upper_rad"].map(|key| data["robot"][key][0].as_f64().unwrap());
        assert_eq!(velocity, robot.limits().velocity_rad_s[0]);
        assert_eq!(position, robot.limits().upper_rad[0]);
        assert_eq!(data["notes"].as_array().unwrap().len(), 0, "{}", data["notes"]);
        assert_eq!(data["compared"].is_null(), files.len() == 1);
    }
    iiwasim(&folder, &["compare", "plan.mcap", "real.csv"])
        .success()
        .stdout(contains("off by 0.0000 s"));
    // The built-in robot has a smaller range.
    let built_in = ["--robot", Robot::default().name()].map(str::to_owned);
    let arguments = ["compare", "plan.mcap", "real.csv", &built_in[0], &built_in[1]];
    iiwasim(&folder, &arguments).code(2).stderr(contains("joint A1"));
}

#[test]
fn a_named_profile_is_known_from_the_plan() {
    let folder = plan(&PROFILE.replacen('{', r#"{ "name": "slow robot","#, 1));
    let data = page(&folder, &["plan.mcap"]);
    assert_eq!(data["robot"]["name"], "slow robot");
    iiwasim(&folder, &["compare", "plan.mcap", "real.csv"]).success();
}
