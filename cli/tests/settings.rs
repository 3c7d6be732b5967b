//! Default option values from a file and the environment; shell completions and manual pages.

use std::fs;

use crate::helpers::{fixture, long_program, program};
use crate::run::{files, iiwasim};
use assert_cmd::cargo::cargo_bin_cmd;
use predicates::{prelude::PredicateBooleanExt, str::contains};
use tempfile::tempdir;

/// One motion, for a program without a robot.
const MOTION: &str = r#"{ "type": "ptp", "joints_deg": [30, 0, 0, -60, 0, 0, 0] }"#;

#[test]
fn the_robot_of_programs_that_name_none_is_a_setting() {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("a.json"), program(MOTION)).unwrap();
    let plan = || iiwasim(&folder, &["plan", "a.json", "--no-output"]).success();
    plan().stdout(contains("lbr_iiwa_7_r800"));
    fs::write(folder.path().join("iiwasim.toml"), "robot = \"lbr_iiwa_14_r820\"\n").unwrap();
    plan().stdout(contains("lbr_iiwa_14_r820"));
    iiwasim(&folder, &["fk", "--joints-deg", "0,0,0,0,0,0,0", "--json"])
        .success()
        .stdout(contains("lbr_iiwa_14_r820"));
    // The robot of the program, the option and the environment have priority.
    let named = program(MOTION).replace("1,", "1,\n  \"robot\": \"lbr_iiwa_7_r800\",");
    fs::write(folder.path().join("b.json"), named).unwrap();
    iiwasim(&folder, &["plan", "b.json", "--no-output"]).success().stdout(contains("7_r800"));
    iiwasim(&folder, &["plan", "a.json", "--no-output", "--robot", "lbr_iiwa_7_r800"])
        .success()
        .stdout(contains("lbr_iiwa_7_r800"));
    for (variable, value, robot) in [
        ("IIWASIM_ROBOT", "lbr_iiwa_7_r800", "lbr_iiwa_7_r800"),
        ("IIWASIM_CONFIG", "", "lbr_iiwa_7_r800"),
        ("IIWASIM_ROBOT", "", "lbr_iiwa_14_r820"),
    ] {
        cargo_bin_cmd!("iiwasim")
            .current_dir(&folder)
            .args(["plan", "a.json", "--no-output"])
            .env(variable, value)
            .assert()
            .success()
            .stdout(contains(robot));
    }
}

#[test]
fn paths_of_settings_are_relative_to_their_file() {
    let folder = tempdir().unwrap();
    let below = folder.path().join("programs");
    fs::create_dir(&below).unwrap();
    fs::copy(fixture("cage.json"), folder.path().join("cage.json")).unwrap();
    fs::copy(fixture("ten-motions.json"), below.join("a.json")).unwrap();
    fs::write(folder.path().join("iiwasim.toml"), "scene = \"cage.json\"\n").unwrap();
    let plan = |gate: &str| {
        cargo_bin_cmd!("iiwasim")
            .current_dir(&below)
            .args(["plan", "a.json", "--no-output", "--min-clearance", gate])
            .assert()
    };
    plan("50").success().stdout(contains("Clearance 79.1 mm"));
    plan("100").code(3);
}

/// Tests the names of joints and links in files and URDFs.
#[test]
fn names_for_ros_are_settings() {
    let folder = tempdir().unwrap();
    let text = "ros_names = \"lbr_fri_ros2_stack\"\nros_prefix = \"left\"\n";
    fs::write(folder.path().join("iiwasim.toml"), text).unwrap();
    let urdf = ["robot", "lbr_iiwa_7_r800", "--urdf"];
    iiwasim(&folder, &urdf).success().stdout(contains("\"left_A1\""));
    let usual = [&urdf[..], &["--ros-names", "iiwa_stack"]].concat();
    iiwasim(&folder, &usual).success().stdout(contains("\"left_joint_1\""));
    cargo_bin_cmd!("iiwasim")
        .current_dir(&folder)
        .args(urdf)
        .env("IIWASIM_ROS_NAMES", "iiwa_stack")
        .env("IIWASIM_ROS_PREFIX", "right")
        .assert()
        .success()
        .stdout(contains("\"right_joint_1\"").and(contains("left").not()));
    // Commands without such names ignore the setting.
    iiwasim(&folder, &["robot", "lbr_iiwa_7_r800"]).success();
    cargo_bin_cmd!("iiwasim")
        .current_dir(&folder)
        .args(urdf)
        .env("IIWASIM_ROS_PREFIX", "2nd")
        .assert()
        .code(2)
        .stderr(contains("a letter first"));
}

#[test]
fn settings_that_are_wrong_are_refused_with_their_place() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("iiwasim.toml");
    for (text, reasons) in [
        ("robot = 7\n", ["iiwasim.toml, line 1, column 9", "string"]),
        ("drive = \"a:1\"\nrobots = \"x\"\n", ["iiwasim.toml, line 2, column 1", "robots"]),
        ("key = \"a.key\"\n", ["iiwasim.toml", "belong together"]),
        ("ros_names = \"moveit\"\n", ["iiwasim.toml, line 1, column 13", "`iiwa_stack`"]),
        ("ros_prefix = \"2nd\"\n", ["iiwasim.toml, line 1, column 14", "1 to 50 letters"]),
    ] {
        fs::write(&file, text).unwrap();
        let assert = iiwasim(&folder, &["robot"]).code(2);
        let stderr = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        for reason in reasons {
            assert!(stderr.contains(reason), "no {reason:?} in {stderr}");
        }
        // Help works nevertheless.
        iiwasim(&folder, &["--help"]).success().stdout(contains("iiwasim.toml"));
    }
}

#[test]
fn shells_and_manuals_know_all_commands() {
    let folder = tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        iiwasim(&folder, &["completions", shell])
            .success()
            .stdout(contains("identify").and(contains("max-cycle-time")));
    }
    iiwasim(&folder, &["man", "man1"]).success();
    let pages = fs::read_dir(folder.path().join("man1")).unwrap();
    let pages: Vec<_> =
        pages.map(|page| page.unwrap().file_name().into_string().unwrap()).collect();
    let twin = ["iiwasim-twin.1"].into_iter().filter(|_| cfg!(feature = "live"));
    for page in ["iiwasim.1", "iiwasim-plan.1"].into_iter().chain(twin) {
        assert!(pages.iter().any(|name| name == page), "{page} in {pages:?}");
    }
    let has_keys = cfg!(feature = "live");
    let version = iiwasim(&folder, &["--version"]).success().get_output().stdout.clone();
    assert_eq!(String::from_utf8_lossy(&version).contains("CURVE"), has_keys);
}

#[test]
fn help_lists_common_commands_first() {
    let folder = tempdir().unwrap();
    let assert = iiwasim(&folder, &["plan", "--help"]).success();
    let help = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    let position = |word: &str| help.find(word).unwrap_or_else(|| panic!("no {word} in {help}"));
    assert!(position("--output") < position("--max-cycle-time"));
    assert!(position("--max-cycle-time") < position("Methods of calculation"));
    assert!(position("Methods of calculation") < position("--blend-search"));
}

#[test]
fn generated_files_are_replaced() {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("a.json"), program(MOTION)).unwrap();
    for _ in 0..2 {
        iiwasim(&folder, &["plan", "a.json"]).success();
    }
    iiwasim(&folder, &["plan", "a.json", "-o", "missing/a.mcap"])
        .code(1)
        .stderr(contains("no such folder: missing"));
    iiwasim(&folder, &["plan", "a.json", "--max-cycle-time", "-1"])
        .code(2)
        .stderr(contains("it cannot be negative").and(contains("to pass").not()));
    iiwasim(&folder, &["plan", "a.json", "--min-clearance", "5"])
        .code(2)
        .stderr(contains("--scene"));
    assert_eq!(files(&folder), ["a.json", "a.mcap"]);
}

#[test]
fn tables_fit_a_terminal() {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("long.json"), long_program(40)).unwrap();
    let fixtures = ["ten-motions.json", "pick-and-place.json", "appendix-b.json"];
    let programs = fixtures.map(|name| fixture(name).display().to_string());
    for program in programs.iter().map(String::as_str).chain(["long.json"]) {
        let table = |columns: &str| {
            let mut command = cargo_bin_cmd!("iiwasim");
            command.current_dir(&folder).env("COLUMNS", columns);
            let assert = command.args(["plan", program, "--no-output"]).assert().success();
            let text = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
            text.split("\n\n").next().unwrap().to_owned()
        };
        for line in table("80").lines() {
            assert!(line.chars().count() <= 80, "{line}");
            assert_eq!(line, line.trim_end());
        }
        // In a pipe, no cell is wrapped: below the header, there is a line per motion.
        let piped = table("");
        assert_eq!(piped, table("1000"));
        let is_row = |line: &str| line[..6].trim().parse::<usize>().is_ok();
        assert!(piped.lines().skip(2).all(is_row), "{piped}");
    }
}
