//! `iiwasim plan` as a process: files, exit codes, messages.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::{
    fs,
    path::Path,
    process::{Command, Stdio},
    time::{Duration, Instant},
};

use assert_cmd::cargo::cargo_bin_cmd;
use iiwa_log::Recording;
use predicates::{
    prelude::PredicateBooleanExt,
    str::{contains, is_empty, starts_with},
};
use tempfile::{TempDir, tempdir};

use crate::helpers::{START, figures, fixture, long_program, plan, program};
use crate::run::{files, iiwasim};

#[test]
fn writes_a_file_and_a_table() {
    let folder = tempdir().unwrap();
    plan(&folder, &fixture("appendix-b.json"), &[])
        .success()
        .stdout(contains("Cycle time 8.92").and(contains("A6 velocity")))
        .stderr(starts_with("Warning: motion 1: its blend of 200 mm is shortened to 178.5 mm: "));
    assert_eq!(files(&folder), ["appendix-b.mcap"]);
}

/// A file for another ROS package has the same joint positions.
#[test]
fn names_are_those_of_a_ros_package() {
    let folder = tempdir().unwrap();
    let program = fixture("waits-and-stops.json");
    let names = ["--ros-names", "lbr_fri_ros2_stack", "--ros-prefix"];
    for (file, options) in [
        ("usual.mcap", &[][..]),
        ("stated.mcap", &["--ros-names", "iiwa_stack", "--ros-prefix", "iiwa"]),
        ("left.mcap", &[&names[..], &["left"]].concat()),
        ("right.mcap", &[&names[..], &["right"]].concat()),
    ] {
        plan(&folder, &program, &[&["-o", file], options].concat()).success();
    }
    let read = |file: &str| Recording::from_bytes(&fs::read(folder.path().join(file)).unwrap());
    let [usual, left, right] =
        ["usual.mcap", "left.mcap", "right.mcap"].map(|file| read(file).unwrap());
    assert!(
        fs::read(folder.path().join("usual.mcap")).unwrap()
            == fs::read(folder.path().join("stated.mcap")).unwrap()
    );
    for (other, link) in [(&left, "left_link_0"), (&right, "right_link_0")] {
        assert_eq!(*other.tcp_poses[0].frame_id, *link);
        let urdf = other.robot_description.as_deref().unwrap();
        assert!(urdf.contains(link) && !urdf.contains("iiwa_link"), "{urdf}");
        assert_eq!(other.joint_states, usual.joint_states);
        assert_eq!(other.trajectory, usual.trajectory);
        assert_eq!(other.motions, usual.motions);
    }
    iiwasim(&folder, &["compare", "usual.mcap", "left.mcap"])
        .success()
        .stdout(contains("off by 0.0000 s, 0.00 %"));
    iiwasim(&folder, &["report", "left.mcap", "right.mcap", "-o", "report.html"]).success();
    assert!(fs::metadata(folder.path().join("report.html")).unwrap().len() > 10_000);

    iiwasim(&folder, &[&["robot", "lbr_iiwa_7_r800", "--urdf"], &names[..], &["left"]].concat())
        .success()
        .stdout(left.robot_description.unwrap());
    for bad in ["", "2nd", "left-arm", &"a".repeat(51)] {
        plan(&folder, &program, &["--ros-prefix", bad])
            .code(2)
            .stderr(contains("1 to 50 letters (a to z, A to Z), digits and `_`, a letter first"));
    }
    plan(&folder, &program, &["--ros-names", "moveit"]).code(2).stderr(contains("iiwa_stack"));
}

#[test]
fn the_solver_can_be_watched() {
    let folder = tempdir().unwrap();
    let program = fixture("appendix-b.json");
    let watched = plan(&folder, &program, &["--no-output", "--trace"]).success();
    let unwatched = plan(&folder, &program, &["--no-output"]).success();
    let unwatched = unwatched.stderr(contains("cells").not());
    assert_eq!(watched.get_output().stdout, unwatched.get_output().stdout);
    let trace = String::from_utf8_lossy(&watched.get_output().stderr).into_owned();
    assert!(trace.starts_with("cells 0 to "), "{trace}");
    // The gap of the first solution falls to the value in its heading.
    let steps: Vec<_> =
        trace.lines().skip(2).take_while(|line| !line.starts_with("cells")).collect();
    let gap = |line: &str| line.split_whitespace().nth(2).unwrap().parse::<f64>().unwrap();
    let [first, .., last] = steps.as_slice() else { panic!("{trace}") };
    assert!(gap(first) > 0.1 && gap(last) < 1e-3, "{first}\n{last}");

    let timing = ["--no-output", "--trace", "--timing", "acceleration"];
    plan(&folder, &program, &timing).code(2).stderr(contains("--trace shows solver iterations"));
    let both = [program.to_str().unwrap(), "--trace"];
    plan(&folder, &program, &both).code(2).stderr(contains("plan that one alone"));
}

#[test]
fn figures_are_as_promised() {
    let folder = tempdir().unwrap();
    let program = fixture("waits-and-stops.json");
    let figures = figures(plan(&folder, &program, &["--json", "-o", "x.mcap"]));
    let number = |key: &str| figures[key].as_f64().unwrap();
    let sum = number("motion_time_s") + number("settle_time_s") + number("wait_time_s");
    assert!((number("cycle_time_s") - sum).abs() < 1e-12);
    assert_eq!((number("settle_time_s"), number("wait_time_s")), (0.4, 0.5));
    assert_eq!(figures["timing"], "sunrise");
    assert_eq!(figures["robot"], "lbr_iiwa_7_r800");
    assert_eq!(figures["samples"], 100);
    assert_eq!(figures["output"], "x.mcap");
    let motions = figures["motions"].as_array().unwrap();
    let indices: Vec<_> = motions.iter().map(|m| m["index"].as_u64().unwrap()).collect();
    assert_eq!(indices, [1, 2, 3, 4, 5, 6, 7, 8]);
    assert_eq!((&motions[2]["type"], &motions[2]["limited_by"]), (&"wait".into(), &().into()));
    // A wait has no active limit.
    assert_eq!(motions[2]["limits"], serde_json::json!([]));
    assert_eq!(motions[0]["limited_by"]["joint"], 1);
    assert_eq!(motions[0]["limited_by"]["kind"], "acceleration");
    let blends = figures["blends"].as_array().unwrap();
    let after: Vec<_> = blends.iter().map(|b| b["after_motion"].as_u64().unwrap()).collect();
    assert_eq!(after, [1, 4, 5]);
    for key in ["gamma_deg", "start_rad", "end_rad", "mid_rad", "mid_tcp_m", "start_s", "end_s"] {
        assert!(!blends[0][key].is_null(), "{key}");
    }
    assert!((blends[0]["gamma_deg"].as_f64().unwrap() - 90.0).abs() < 1e-9);
}

#[test]
fn the_same_program_gives_the_same_bytes() {
    let folder = tempdir().unwrap();
    for output in ["a.mcap", "b.mcap"] {
        plan(&folder, &fixture("ten-motions.json"), &["-o", output]).success();
    }
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert_eq!(read("a.mcap"), read("b.mcap"));
    plan(
        &folder,
        &fixture("ten-motions.json"),
        &["-o", "c.mcap", "--epoch", "2021-01-01T00:00:00Z"],
    )
    .success();
    assert_ne!(read("a.mcap"), read("c.mcap"));
}

#[test]
fn reads_standard_input() {
    let folder = tempdir().unwrap();
    cargo_bin_cmd!("iiwasim")
        .current_dir(&folder)
        .args(["plan", "-"])
        .write_stdin(fs::read(fixture("appendix-b.json")).unwrap())
        .assert()
        .success();
    assert_eq!(files(&folder), ["program.mcap"]);
}

#[test]
fn a_gate_that_is_not_met_exits_with_3() {
    let folder = tempdir().unwrap();
    let program = fixture("appendix-b.json");
    plan(&folder, &program, &["--no-output", "--max-cycle-time", "9"]).success();
    plan(&folder, &program, &["--no-output", "--json", "--max-cycle-time", "8.5"])
        .code(3)
        .stdout(contains("cycle_time_s"))
        .stderr(contains("8.927 s, more than 8.5 s"));
    assert!(files(&folder).is_empty());
}

#[test]
fn the_picture_in_the_docs_is_current() {
    let folder = tempdir().unwrap();
    plan(&folder, &fixture("appendix-b.json"), &["--no-output", "--picture", "b.svg"]).success();
    let drawn = fs::read_to_string(folder.path().join("b.svg")).unwrap();
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/appendix-b.svg");
    let (drawn, docs) = (numbers(&drawn), numbers(&fs::read_to_string(docs).unwrap()));
    // A pixel is four units; rounding differs between machines.
    let same = drawn.iter().zip(&docs).all(|(a, b)| (a - b).abs() <= 4.0);
    assert!(same && drawn.len() == docs.len(), "renew docs/appendix-b.svg");
}

/// Returns all numbers in a text.
fn numbers(text: &str) -> Vec<f64> {
    text.split(|c: char| !c.is_ascii_digit() && c != '.').filter_map(|n| n.parse().ok()).collect()
}

/// Runs an invalid program: exit code 2, all `words` in the message, and no files written.
fn rejects(program: &str, words: &[&str]) {
    let folder = tempdir().unwrap();
    let inputs = tempdir().unwrap();
    let input = inputs.path().join("program.json");
    fs::write(&input, program).unwrap();
    fs::write(folder.path().join("kept.mcap"), "as it was").unwrap();
    let assert = plan(&folder, &input, &["-o", "kept.mcap"]).code(2).stdout(is_empty());
    let message = String::from_utf8_lossy(&assert.get_output().stderr).replace("\n  │ ", " ");
    for word in words {
        assert!(message.contains(word), "`{word}` is missing in:\n{message}");
    }
    assert_eq!(files(&folder), ["kept.mcap"]);
    assert_eq!(fs::read_to_string(folder.path().join("kept.mcap")).unwrap(), "as it was");
}

#[test]
fn bad_programs_exit_with_2_and_leave_no_trace() {
    let ptp = |rest: &str| {
        program(&format!(r#"{{ "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 9]{rest} }}"#))
    };
    let joints = |list: &str| program(&format!(r#"{{ "type": "ptp", "joints_deg": [{list}] }}"#));
    let line = "line 5";
    rejects("motions: none", &["line 1, column 1"]);
    rejects(&ptp("")[..60], &["line 3", "ends too early"]);
    rejects(&ptp("").replace("motions", "moves"), &["line 4", "moves"]);
    rejects(&ptp(r#", "speed": 1"#), &[line, "motion 1", "speed"]);
    rejects(&ptp("").replace("ptp", "fly"), &[line, "motion 1", "fly", "ptp"]);
    rejects(&ptp("").replace("\"version\": 1", "\"version\": 2"), &["line 2", "version 2"]);
    rejects(
        &ptp("").replace("\"version\": 1", "\"version\": 1, \"robot\": \"r2d2\""),
        &["line 2", "r2d2", "lbr_iiwa_14_r820"],
    );
    rejects(&joints("1, 2, 3, 4, 5, 6"), &[line, "motion 1", "6", "seven"]);
    rejects(&joints("1, 2, 3, 4, 5, 6, 7, 8"), &[line, "motion 1", "8", "seven"]);
    rejects(&joints("NaN, 2, 3, 4, 5, 6, 7"), &[line]);
    rejects(&joints("1e400, 2, 3, 4, 5, 6, 7"), &[line]);
    rejects(&joints("0, 120.001, 0, 0, 0, 0, 0"), &[line, "joint A2", "120.001", "120"]);
    for bad in ["0", "-0.5", "1.001"] {
        rejects(&ptp(&format!(r#", "velocity_rel": {bad}"#)), &[line, "motion 1", "velocity_rel"]);
    }
    let blended = |blend: &str| {
        program(&format!(
            "{{ \"type\": \"ptp\", \"joints_deg\": [0, 0, 0, 0, 0, 0, 9], \"blend\": {blend} \
             }},\n    {{ \"type\": \"ptp\", \"joints_deg\": [0, 0, 0, 9, 0, 0, 9] }}"
        ))
    };
    rejects(&blended(r#"{ "fraction": 0.51 }"#), &[line, "motion 1", "0.51"]);
    rejects(&blended(r#"{ "cart_mm": -5 }"#), &[line, "motion 1", "-5"]);
    let wait = blended(r#"{ "fraction": 0.2 }"#).replace(
        r#"{ "type": "ptp", "joints_deg": [0, 0, 0, 9, 0, 0, 9] }"#,
        r#"{ "type": "wait", "seconds": 1 }"#,
    );
    rejects(&wait, &[line, "motion 1", "wait"]);
    rejects(&ptp("").replace(START, r#""robot": "lbr_iiwa_7_r800""#), &["start"]);
    rejects(&program(""), &["line 4", "no motions"]);
    rejects(&"[".repeat(1 << 20), &["line 1"]);
    // Nearly collinear and up to the limit, the blend exceeds it.
    let swing = program(
        "{ \"type\": \"ptp\", \"joints_deg\": [0, 119.99, 0, 0, 0, 0, 0], \
         \"blend\": { \"fraction\": 0.5 } },\n    \
         { \"type\": \"ptp\", \"joints_deg\": [160, 119.99, 0, 0, 0, 0, 0] }",
    )
    .replace("[0, 0, 0, 0, 0, 0, 0]", "[-160, 60, 0, 0, 0, 0, 0]");
    rejects(&swing, &[line, "motion 1", "joint A2", "blend"]);
}

#[test]
fn a_blend_at_the_end_is_a_warning() {
    let folder = tempdir().unwrap();
    let motion = |rest: &str| {
        program(&format!(r#"{{ "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 9]{rest} }}"#))
    };
    let blended = folder.path().join("blended.json");
    fs::write(&blended, motion(r#", "blend": { "fraction": 0.2 }"#)).unwrap();
    let assert = plan(&folder, &blended, &["--no-output", "--json"])
        .success()
        .stderr(contains("motion 1 is the last one").and(contains("blended.json").not()));
    let figures: serde_json::Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    assert_eq!(figures["warnings"].as_array().unwrap().len(), 1, "{figures}");
    let stopped = folder.path().join("stopped.json");
    fs::write(&stopped, motion("")).unwrap();
    let assert = plan(&folder, &stopped, &["--no-output", "--json"]).success().stderr(is_empty());
    let without: serde_json::Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    assert_eq!(without["cycle_time_s"], figures["cycle_time_s"]);
    assert!(without["warnings"].as_array().unwrap().is_empty());
}

#[test]
fn wrong_usage_exits_with_2() {
    let folder = tempdir().unwrap();
    iiwasim(&folder, &["plan"]).code(2).stderr(contains("PROGRAM.json"));
    iiwasim(&folder, &["plan", "missing.json"]).code(2).stderr(contains("missing.json"));
    iiwasim(&folder, &["plan", "x.json", "--samples", "0"]).code(2);
    iiwasim(&folder, &["plan", "x.json", "--no-output", "-o", "y"]).code(2);
    iiwasim(&folder, &["fk", "--joints-deg", "1,2,3"]).code(2).stderr(contains("3 numbers"));
    iiwasim(&folder, &["fk", "--joints-deg", "0,121,0,0,0,0,0"])
        .code(2)
        .stderr(contains("joint A2"));
    iiwasim(&folder, &["robot", "r2d2"]).code(2).stderr(contains("lbr_iiwa_7_r800"));
    fs::write(folder.path().join("latin.json"), b"{ \"robot\": \"\xe9\" }").unwrap();
    iiwasim(&folder, &["plan", "latin.json"]).code(2).stderr(contains("UTF-8"));
}

#[test]
fn an_output_that_cannot_be_written_exits_with_1() {
    let folder = tempdir().unwrap();
    let program = fixture("appendix-b.json");
    plan(&folder, &program, &["-o", "missing/x.mcap"]).code(1).stderr(contains("missing/x.mcap"));
    plan(&folder, &program, &["-o", "."]).code(1).stderr(contains("cannot write"));
    assert!(files(&folder).is_empty());
}

#[test]
fn inputs_are_not_overwritten() {
    let folder = tempdir().unwrap();
    let text = program(r#"{ "type": "ptp", "joints_deg": [10, 0, 0, 0, 0, 0, 0] }"#);
    fs::write(folder.path().join("a.mcap"), &text).unwrap();
    let input = Path::new("a.mcap");
    let replaced = "would be written over the";
    for (arguments, message) in [
        (&[][..], replaced),
        (&["-o", "./a.mcap"], replaced),
        (&["--no-output", "--picture", "a.mcap"], "pictures are written as .svg"),
    ] {
        plan(&folder, input, arguments).code(2).stderr(contains(message));
        assert_eq!(fs::read_to_string(folder.path().join("a.mcap")).unwrap(), text);
        assert_eq!(files(&folder), ["a.mcap"]);
    }
}

/// Plans a trajectory that may be overwritten.
fn old_trajectory(folder: &TempDir, name: &str) -> Vec<u8> {
    plan(folder, &fixture("appendix-b.json"), &["-o", name]).success();
    fs::read(folder.path().join(name)).unwrap()
}

#[test]
#[cfg(unix)]
fn links_stay_and_devices_are_not_replaced() {
    let folder = tempdir().unwrap();
    let appendix_b = fixture("appendix-b.json");
    let old = old_trajectory(&folder, "real.mcap");
    std::os::unix::fs::symlink("real.mcap", folder.path().join("link.mcap")).unwrap();
    let ten_motions = fixture("ten-motions.json");
    plan(&folder, &ten_motions, &["-o", "link.mcap"]).success();
    assert!(fs::symlink_metadata(folder.path().join("link.mcap")).unwrap().is_symlink());
    assert!(fs::read(folder.path().join("real.mcap")).unwrap() != old);
    plan(&folder, &appendix_b, &["-o", "/dev/null"]).code(1).stderr(contains("not a file"));
    plan(&folder, &appendix_b, &["-o", "none/a.mcap"]).code(1).stderr(contains(".part").not());
    assert_eq!(files(&folder), ["link.mcap", "real.mcap"]);
}

#[test]
fn a_picture_that_cannot_be_drawn_leaves_nothing() {
    let folder = tempdir().unwrap();
    plan(&folder, &fixture("appendix-b.json"), &["--picture", "none/a.svg"]).code(1);
    assert!(files(&folder).is_empty());
}

#[test]
fn control_characters_are_spelled_out() {
    let folder = tempdir().unwrap();
    let text = program(r#"{ "type": "\u001b]0;x\u0007" }"#);
    fs::write(folder.path().join("a.json"), text).unwrap();
    let assert = plan(&folder, Path::new("a.json"), &[]).code(2);
    let said = &assert.get_output().stderr;
    assert!(!said.contains(&0x1b) && !said.contains(&7), "{}", String::from_utf8_lossy(said));
    // Run-time failures, and the name of the input, are printed the same way.
    let good = fixture("appendix-b.json");
    let folder_name = "\u{1b}[2J\u{9b}31m gone";
    let missing = Path::new(folder_name).join("a.json");
    let failures = [
        plan(&folder, &good, &["-o", &format!("{folder_name}/a.mcap")]).code(1),
        plan(&folder, &missing, &[]).code(2),
    ];
    for failure in failures {
        let text = String::from_utf8_lossy(&failure.get_output().stderr).into_owned();
        let is_control = |c: char| c.is_control() && c != '\n';
        assert!(text.contains("[2J") && !text.contains(is_control), "{text:?}");
    }
}

#[test]
fn limits_of_a_urdf_that_differ_exit_with_3() {
    let folder = tempdir().unwrap();
    let urdf = iiwasim(&folder, &["robot", "lbr_iiwa_7_r800", "--urdf"]).success();
    let urdf = String::from_utf8(urdf.get_output().stdout.clone()).unwrap();
    fs::write(folder.path().join("same.urdf"), &urdf).unwrap();
    let check = |file| iiwasim(&folder, &["robot", "lbr_iiwa_7_r800", "--check", file]);
    check("same.urdf").success();
    let other = urdf.replace("effort=\"176\"", "effort=\"100\"");
    assert_ne!(other, urdf);
    fs::write(folder.path().join("other.urdf"), &other).unwrap();
    check("other.urdf").code(3).stdout(contains("effort is 100 Nm in the URDF and 176 Nm"));
}

#[test]
fn a_full_disk_exits_with_1_and_keeps_the_old_file() {
    let folder = tempdir().unwrap();
    let old = old_trajectory(&folder, "kept.mcap");
    let output = Command::new("sh")
        .current_dir(&folder)
        .arg("-c")
        .arg(r#"trap "" XFSZ; ulimit -f 16; exec "$0" plan "$1" -o kept.mcap"#)
        .arg(assert_cmd::cargo::cargo_bin!("iiwasim"))
        .arg(fixture("ten-motions.json"))
        .output()
        .unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("kept.mcap"), "{message}");
    assert_eq!(files(&folder), ["kept.mcap"]);
    assert!(fs::read(folder.path().join("kept.mcap")).unwrap() == old);
}

#[cfg(unix)]
#[test]
fn an_interrupt_exits_with_1_and_keeps_the_old_file() {
    let folder = tempdir().unwrap();
    let inputs = tempdir().unwrap();
    let input = inputs.path().join("long.json");
    // Stops throughout: many sections, between which an interrupt is noticed.
    let program = long_program(20_000).replace(r#", "blend": { "fraction": 0.25 }"#, "");
    fs::write(&input, program).unwrap();
    let old = old_trajectory(&folder, "kept.mcap");
    let mut child = Command::new(assert_cmd::cargo::cargo_bin!("iiwasim"))
        .current_dir(&folder)
        .arg("plan")
        .arg(&input)
        .args(["-o", "kept.mcap"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let started = Instant::now();
    while files(&folder).len() < 2 && started.elapsed() < Duration::from_mins(1) {
        std::thread::sleep(Duration::from_millis(2));
    }
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    assert_eq!(child.wait().unwrap().code(), Some(1));
    assert_eq!(files(&folder), ["kept.mcap"]);
    assert!(fs::read(folder.path().join("kept.mcap")).unwrap() == old);
}

#[test]
fn other_commands_answer() {
    let folder = tempdir().unwrap();
    let fk = iiwasim(&folder, &["fk", "--json", "--joints-rad", "0,0.5,0,-1,0,0.7,0"]);
    let fk = figures(fk);
    assert!((fk["position_m"][0].as_f64().unwrap() - 0.713_659_663).abs() < 1e-9);
    assert!((fk["position_m"][2].as_f64().unwrap() - 0.629_875_736).abs() < 1e-9);
    assert_eq!(fk["robot"], "lbr_iiwa_7_r800");
    let schema = figures(iiwasim(&folder, &["schema"]));
    assert_eq!(schema["title"], "iiwasim motion program");
    iiwasim(&folder, &["robot"]).success().stdout(contains("lbr_iiwa_14_r820"));
    iiwasim(&folder, &["robot", "lbr_iiwa_14_r820"])
        .success()
        .stdout(contains("acceleration assumed"));
}

#[test]
fn a_profile_is_found_beside_the_program() {
    let folder = tempdir().unwrap();
    let programs = tempdir().unwrap();
    let profile =
        r#"{ "version": 1, "name": "slow", "velocity_limit_deg_s": [9, 9, 9, 9, 9, 9, 9] }"#;
    fs::write(programs.path().join("slow.json"), profile).unwrap();
    let text = fs::read_to_string(fixture("appendix-b.json")).unwrap();
    let input = programs.path().join("program.json");
    fs::write(&input, text.replace("lbr_iiwa_7_r800", "slow.json")).unwrap();
    let slow = figures(plan(&folder, &input, &["--json", "--no-output"]));
    assert_eq!(slow["robot"], "slow");
    assert!(slow["cycle_time_s"].as_f64().unwrap() > 60.0);
    let own_figures =
        figures(plan(&folder, &input, &["--json", "--no-output", "--robot", "lbr_iiwa_7_r800"]));
    assert!(own_figures["cycle_time_s"].as_f64().unwrap() < 9.0);
    fs::write(programs.path().join("slow.json"), profile.replace("9, 9]", "9]")).unwrap();
    plan(&folder, &input, &[]).code(2).stderr(contains("slow.json").and(contains("line 1")));
}

#[test]
fn a_program_is_planned_for_the_robot_that_it_names() {
    let folder = tempdir().unwrap();
    let text = fs::read_to_string(fixture("appendix-b.json")).unwrap();
    let input = folder.path().join("heavy.json");
    fs::write(&input, text.replace("lbr_iiwa_7_r800", "lbr_iiwa_14_r820")).unwrap();
    let named = figures(plan(&folder, &input, &["--json", "--no-output"]));
    assert_eq!(named["robot"], "lbr_iiwa_14_r820");
    let given = ["--json", "--no-output", "--robot", "lbr_iiwa_14_r820"];
    let mut given = figures(plan(&folder, &fixture("appendix-b.json"), &given));
    given["program"] = named["program"].clone();
    assert_eq!(given, named);
    let other = figures(plan(&folder, &fixture("appendix-b.json"), &["--json", "--no-output"]));
    assert_ne!(named["cycle_time_s"], other["cycle_time_s"]);
}

#[test]
fn assumed_limits_are_named() {
    let folder = tempdir().unwrap();
    let assert =
        plan(&folder, &fixture("appendix-b.json"), &["--no-output", "--robot", "lbr_iiwa_14_r820"]);
    assert.success().stdout(contains("Assumed").and(contains("acceleration")));
}

/// Half a turn at a millionth of the speed takes weeks: 154 bytes, and 131 GB of samples.
const WEEKS: &str =
    r#"{ "type": "ptp", "joints_deg": [160, 0, 0, 0, 0, 0, 0], "velocity_rel": 1e-6 }"#;

#[test]
fn a_file_that_fills_the_disk_is_not_begun() {
    let folder = tempdir().unwrap();
    let inputs = tempdir().unwrap();
    let input = inputs.path().join("weeks.json");
    fs::write(&input, program(WEEKS)).unwrap();
    let too_large = contains("18 days").and(contains("131.3 GB")).and(contains("1.0 GB of"));
    plan(&folder, &input, &[]).code(2).stderr(too_large);
    plan(&folder, &input, &["--max-file-size", "10GB"]).code(2).stderr(contains("10.0 GB of"));
    plan(&folder, &input, &["--max-file-size", "much"]).code(2);
    assert_eq!(files(&folder), [""; 0]);
    // Without samples, or with few, the program is planned like any other, and can be drawn.
    let all = figures(plan(&folder, &input, &["--no-output", "--json", "--picture", "weeks.svg"]));
    assert!(all["cycle_time_s"].as_f64().unwrap() > 1.6e6);
    plan(&folder, &input, &["--rate", "0.1"]).success();
    assert_eq!(files(&folder), ["weeks.mcap", "weeks.svg"]);
    // Its curves have no more samples than those of a short program.
    fs::write(&input, program(&WEEKS.replace("1e-6", "1e-3"))).unwrap();
    plan(&folder, &input, &["--rate", "5", "-o", "hours.mcap"]).success();
    iiwasim(&folder, &["report", "hours.mcap"]).success();
    assert!(fs::metadata(folder.path().join("hours.html")).unwrap().len() < 10_000_000);
    fs::write(&input, program(WEEKS)).unwrap();
    // The size limit applies to any file.
    let small = ["--max-file-size", "100 kB", "-o", "small.mcap"];
    plan(&folder, &fixture("appendix-b.json"), &small).code(2).stderr(contains("takes 9 s"));
    // The size limit also applies to many programs.
    let good = fixture("appendix-b.json");
    let both = ["plan", input.to_str().unwrap(), good.to_str().unwrap(), "-o", "many"];
    iiwasim(&folder, &both).code(3).stderr(contains("18 days").and(contains("1 of 2 programs")));
    assert_eq!(fs::read_dir(folder.path().join("many")).unwrap().count(), 1);
}

#[test]
fn stamps_increase_past_a_wait_of_no_time() {
    let folder = tempdir().unwrap();
    let inputs = tempdir().unwrap();
    let input = inputs.path().join("none.json");
    let none = r#"{ "type": "wait", "seconds": 0 }"#;
    let turn = r#"{ "type": "ptp", "joints_deg": [10, 0, 0, 0, 0, 0, 0] }"#;
    let half = r#"{ "type": "wait", "seconds": 0.5 }"#;
    fs::write(&input, program(&[none, turn, none, half, none].join(", "))).unwrap();
    let figures = figures(plan(&folder, &input, &["--json"]));
    let motions = figures["motions"].as_array().unwrap();
    let indices: Vec<_> = motions.iter().map(|motion| motion["index"].as_u64().unwrap()).collect();
    assert_eq!(indices, [2, 4]);
    for motion in motions {
        assert!(motion["start_s"].as_f64() < motion["end_s"].as_f64(), "{motion}");
    }
    let bytes = fs::read(folder.path().join("none.mcap")).unwrap();
    let recording = iiwa_log::Recording::from_bytes(&bytes).unwrap();
    let starts: Vec<_> = recording.motions.iter().map(|motion| motion.t_s).collect();
    assert_eq!(starts.len(), 3, "the turn, its settling, and one wait");
    assert!(starts.windows(2).all(|pair| pair[0] < pair[1]), "{starts:?}");
    let states: Vec<_> = recording.joint_states.iter().map(|state| state.t_s).collect();
    assert!(states.windows(2).all(|pair| pair[0] < pair[1]));
}

#[test]
fn a_program_does_not_show_other_files() {
    let folder = tempdir().unwrap();
    let inside = folder.path().join("programs");
    fs::create_dir_all(inside.join("profiles")).unwrap();
    let secret = "root:secret:0:0\n";
    for path in ["secret", "secret.json", "programs/secret.txt", "programs/secret.json"] {
        fs::write(folder.path().join(path), secret).unwrap();
    }
    let outside = folder.path().join("secret.json");
    let outside = outside.to_str().unwrap();
    let mut names = vec!["/etc/passwd", outside, "../secret.json", "secret.txt", "secret.json"];
    names.extend(["profiles/../../secret.json", "none.json", "profiles"]);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(outside, inside.join("link.json")).unwrap();
        names.push("link.json");
    }
    for name in names {
        let robot = format!("\"version\": 1, \"robot\": \"{name}\",");
        let text =
            program(r#"{ "type": "wait", "seconds": 1 }"#).replace("\"version\": 1,", &robot);
        fs::write(inside.join("p.json"), text).unwrap();
        let assert = iiwasim(&folder, &["plan", "programs/p.json", "--no-output"]).code(2);
        assert.stderr(contains("secret:").not().and(contains("root:").not()));
    }
    // A file given explicitly is shown.
    iiwasim(&folder, &["robot", "secret.json"]).code(2).stderr(contains("root:secret"));
}

#[test]
fn leftovers_of_a_kill_go_and_files_in_use_stay() {
    let folder = tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for name in [".iiwasim-left.part", ".iiwasim-used.part", ".other.part"] {
        fs::write(path(name), "half").unwrap();
    }
    let used = fs::File::open(path(".iiwasim-used.part")).unwrap();
    used.lock().unwrap();
    plan(&folder, &fixture("appendix-b.json"), &[]).success();
    assert_eq!(files(&folder), [".iiwasim-used.part", ".other.part", "appendix-b.mcap"]);
    drop(used);
    plan(&folder, &fixture("appendix-b.json"), &[]).success();
    assert_eq!(files(&folder), [".other.part", "appendix-b.mcap"]);
}
