//! `iiwasim plan` with many programs: folders, partial failures, rejected input.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::{
    fs,
    path::Path,
    process::{Command, Stdio},
    time::{Duration, Instant},
};

use assert_cmd::{assert::Assert, cargo::cargo_bin};
use predicates::{
    prelude::PredicateBooleanExt,
    str::{contains, is_empty, starts_with},
};
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use crate::helpers::{fixture, long_program, program};
use crate::run::{files, iiwasim};

/// Returns a program of one motion, whose duration increases with `deg`.
fn turn(deg: f64) -> String {
    program(&format!(r#"{{ "type": "ptp", "joints_deg": [{deg}, 0, 0, 0, 0, 0, 0] }}"#))
}

/// Returns a program for a robot.
fn turn_of(robot: &str) -> String {
    turn(30.0).replace("\"version\": 1", &format!("\"version\": 1, \"robot\": \"{robot}\""))
}

/// Creates a folder with files of these names and contents, including subfolders.
fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

/// Creates three programs of the repository in the folder `cell`.
fn cell() -> TempDir {
    let read = |name: &str| fs::read_to_string(fixture(name)).unwrap();
    folder(&[
        ("cell/waits-and-stops.json", &read("waits-and-stops.json")),
        ("cell/appendix-b.json", &read("appendix-b.json")),
        ("cell/ten-motions.json", &read("ten-motions.json")),
    ])
}

fn stdout(assert: &Assert) -> String {
    String::from_utf8(assert.get_output().stdout.clone()).unwrap()
}

/// Returns messages without their line breaks.
fn stderr(assert: &Assert) -> String {
    String::from_utf8_lossy(&assert.get_output().stderr).replace("\n  │ ", " ")
}

/// Returns the JSON lines on standard output.
fn lines(assert: &Assert) -> Vec<Value> {
    stdout(assert).lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Returns the words of the table rows.
fn rows(assert: &Assert) -> Vec<Vec<String>> {
    let text = stdout(assert);
    let rows = text.lines().skip(2).take_while(|line| !line.is_empty());
    rows.map(|row| row.split_whitespace().map(str::to_owned).collect()).collect()
}

/// Checks that a command is rejected: exit code 2, all `words` in the message, and no files
/// written.
fn rejects(folder: &TempDir, arguments: &[&str], words: &[&str]) {
    let before = files(folder);
    let assert = iiwasim(folder, arguments).code(2).stdout(is_empty());
    let message = stderr(&assert);
    for word in words {
        assert!(message.contains(word), "`{word}` is missing in:\n{message}");
    }
    assert_eq!(files(folder), before);
}

/// Start of the only warning about the programs of [`cell`].
const SHORTENED: &str = "Warning: cell/appendix-b.json: motion 1: its blend of 200 mm is shortened";

#[test]
fn a_folder_stands_for_its_programs_by_name() {
    let folder = cell();
    let assert = iiwasim(&folder, &["plan", "cell"]).success().stderr(starts_with(SHORTENED));
    assert_eq!(stderr(&assert).lines().count(), 1);
    let rows = rows(&assert);
    assert_eq!(rows.len(), 3);
    let row = [
        "cell/appendix-b.json",
        "4",
        "8.927",
        "8.877",
        "0.050",
        "A4",
        "velocity",
        "39.1",
        "planned",
    ];
    assert_eq!(rows[0], row);
    assert_eq!(rows[1][0], "cell/ten-motions.json");
    assert_eq!((rows[2][0].as_str(), rows[2][4].as_str()), ("cell/waits-and-stops.json", "0.900"));
    let text = stdout(&assert);
    assert!(text.contains("3 planned, 0 failed; cycle times together 21.980 s"), "{text}");
    let written = ["appendix-b.mcap", "cell", "ten-motions.mcap", "waits-and-stops.mcap"];
    assert_eq!(files(&folder), written);
}

#[test]
fn torques_are_a_gate_of_each_program() {
    let folder = cell();
    let percent = |row: &[String]| row.iter().rev().nth(1).unwrap().parse::<f64>().unwrap();
    let shares: Vec<f64> = rows(&iiwasim(&folder, &["plan", "cell", "--no-output"]).success())
        .iter()
        .map(|row| percent(row))
        .collect();
    let max = shares.iter().copied().fold(0.0, f64::max);
    let min = shares.iter().copied().fold(f64::MAX, f64::min);
    assert!(max > min + 2.0, "{shares:?}");
    let limit = format!("{}", 0.5 * (max + min));
    let over = shares.iter().filter(|share| **share > 0.5 * (max + min)).count();
    let gate = ["plan", "cell", "--no-output", "--max-torque-percent", &limit];
    let assert = iiwasim(&folder, &gate).code(3);
    assert_eq!(stdout(&assert).matches("overloaded").count(), over);
    let said = format!("{over} of 3 programs over {limit} % of a joint's torque");
    assert!(stderr(&assert).contains(&said), "{}", stderr(&assert));
    assert_eq!(stderr(&assert).matches("Gate not met: cell/").count(), over);
}

#[test]
fn a_folder_is_more_than_its_programs() {
    let profile =
        r#"{ "version": 1, "name": "slow", "velocity_limit_deg_s": [9, 9, 9, 9, 9, 9, 9] }"#;
    let folder = folder(&[
        ("cell/a.json", &turn_of("slow.json")),
        ("cell/slow.json", profile),
        ("cell/.hidden.json", "{"),
        ("cell/b.txt", "{"),
        ("cell/json", "{"),
        ("cell/in.json/c.json", "{"),
        ("cell/program.schema.json", &iiwa_program::Program::schema().to_string()),
        ("cell/walls.json", r#"{ "version": 1, "obstacles": [] }"#),
        // A fault does not make a profile or frames a program.
        (
            "cell/bad.json",
            r#"{ "version": 1, "base": "lbr_iiwa_7_r800", "name": "t",
                "lengths_mm": { "flange": 0 } }"#,
        ),
        ("cell/tables.json", r#"{ "version": 1, "bases": { "a": { "x": 1 } } }"#),
    ]);
    let assert = iiwasim(&folder, &["plan", "cell", "--no-output", "--json"]).success();
    let lines = lines(&assert);
    assert_eq!(lines.len(), 1);
    assert_eq!((&lines[0]["program"], &lines[0]["robot"]), (&"cell/a.json".into(), &"slow".into()));
    let notes = stderr(&assert);
    let notes: Vec<_> = notes.lines().collect();
    assert_eq!(notes.len(), 5, "{notes:?}");
    let bad = "Note: cell/bad.json is a robot profile, and is not planned, with a fault: \
               lengths_mm: flange";
    assert!(notes[0].starts_with(bad), "{}", notes[0]);
    for (note, name, kind) in [
        (notes[1], "program.schema", "JSON Schema"),
        (notes[2], "slow", "robot profile"),
        (notes[4], "walls", "scene"),
    ] {
        assert_eq!(note, format!("Note: cell/{name}.json is a {kind}, and is not planned"));
    }
    let tables = "Note: cell/tables.json is a file of tools, bases and frames, and is not planned, \
                  with a fault: unknown key `x`";
    assert!(notes[3].starts_with(tables), "{}", notes[3]);
}

#[test]
fn each_comes_out_as_it_does_alone() {
    let folder = cell();
    let names = ["ten-motions", "appendix-b", "waits-and-stops"];
    let given = names.map(|name| format!("cell/{name}.json"));
    let [a, b, c] = given.each_ref().map(String::as_str);
    let options = ["--rate", "100", "--blend-shape", "alpha", "--json"];
    let together = |extra: &[&str]| {
        let arguments = [&["plan", a, b, c][..], &options[..], extra].concat();
        stdout(&iiwasim(&folder, &arguments).success())
    };
    let text = together(&["-o", "many/of/them"]);
    for ((name, program), line) in names.iter().zip(&given).zip(text.lines()) {
        let file = format!("many/of/them/{name}.mcap");
        let many = fs::read(folder.path().join(&file)).unwrap();
        let alone = [&["plan", program, "-o", &file], &options[..]].concat();
        let alone = stdout(&iiwasim(&folder, &alone).success());
        assert_eq!(line, alone.trim_end());
        assert!(line.starts_with(&format!("{{\"program\":\"{program}\",")));
        assert!(many == fs::read(folder.path().join(&file)).unwrap(), "{name}");
    }
    assert_eq!(text.lines().count(), 3);
    assert_eq!(together(&["-o", "many/of/them", "--jobs", "1"]), text);
    assert_eq!(together(&["-o", "many/of/them", "--jobs", "1024"]), text);
}

#[test]
fn a_bad_program_does_not_stop_the_others() {
    let folder = folder(&[
        ("cell/a.json", &turn(10.0)),
        ("cell/bad.json", &turn(171.0)),
        ("cell/empty.json", ""),
        ("cell/good.json", &turn(20.0)),
        ("cell/r2d2.json", &turn_of("r2d2")),
        ("cell/text.json", "no program"),
        ("cell/profiled.json", &turn_of("profiles/broken.json")),
        ("cell/profiles/broken.json", "{"),
    ]);
    fs::write(folder.path().join("cell/latin.json"), b"{ \"robot\": \"\xe9\" }").unwrap();
    let arguments = ["plan", "cell", "missing.json", "-o", "out"];
    let assert = iiwasim(&folder, &arguments).code(3);
    let message = stderr(&assert);
    for words in [
        "cell/bad.json, line 5, column 37: motion 1: joint A1 is at 171 deg; its range is -170 to \
         170 deg",
        "cell/empty.json, line 1, column 1",
        "cell/latin.json is not text in UTF-8",
        "cell/profiled.json: cell/profiles/broken.json, line 1",
        "cell/r2d2.json, line 2",
        "cell/text.json, line 1",
        "cannot read missing.json",
        "7 of 9 programs failed",
    ] {
        assert!(message.contains(words), "`{words}` is missing in:\n{message}");
    }
    let results: Vec<_> = rows(&assert)
        .into_iter()
        .map(|row| (row[0].trim_start_matches("cell/").to_owned(), row.last().unwrap().clone()))
        .collect();
    let expected = [
        ("a.json", "planned"),
        ("bad.json", "failed"),
        ("empty.json", "failed"),
        ("good.json", "planned"),
        ("latin.json", "failed"),
        ("profiled.json", "failed"),
        ("r2d2.json", "failed"),
        ("text.json", "failed"),
        ("missing.json", "failed"),
    ];
    assert_eq!(results, expected.map(|(name, result)| (name.to_owned(), result.to_owned())));
    assert!(stdout(&assert).contains("2 planned, 7 failed"));
    let written = fs::read_dir(folder.path().join("out")).unwrap();
    assert_eq!(written.count(), 2);

    let assert = iiwasim(&folder, &[&arguments[..], &["--json"]].concat()).code(3);
    let lines = lines(&assert);
    assert_eq!(lines.len(), 9);
    assert_eq!(lines[0]["output"], "out/a.mcap");
    let refusal = r#"{"program":"cell/latin.json","error":"cell/latin.json is not text in UTF-8","#;
    assert!(stdout(&assert).lines().nth(4).unwrap().starts_with(refusal));
    let unread = json!([{ "message": "cell/latin.json is not text in UTF-8" }]);
    assert_eq!(lines[4]["errors"], unread);
    let place = json!({ "file": "cell/profiles/broken.json", "line": 1, "column": 2,
        "message": "the text ends too early" });
    assert_eq!(lines[5]["errors"], json!([place]));
    assert_eq!(stderr(&assert), message);
}

/// Three errors of one program, two of them unknown keys of the program.
#[test]
fn all_errors_of_a_program_are_in_json() {
    let wrong = turn(10.0).replacen('{', "{ \"speed\": 1, \"robt\": \"r\",", 1);
    let wrong = wrong.replace("\"ptp\"", "\"movej\"");
    let folder = folder(&[("old/a.json", &turn(10.0)), ("new/a.json", &wrong)]);
    for command in ["plan new --no-output --json", "diff old new --json"] {
        let words: Vec<_> = command.split(' ').collect();
        let line = lines(&iiwasim(&folder, &words).code(3)).remove(0);
        let first = line["error"].as_str().unwrap();
        assert!(first.contains("a.json, line 1, column 3: unknown key `speed`"), "{first}");
        assert!(first.ends_with("; and 2 more errors"), "{first}");
        let errors = line["errors"].as_array().unwrap();
        let messages: Vec<_> = errors.iter().map(|it| it["message"].as_str().unwrap()).collect();
        assert_eq!(
            messages[1..],
            [
                "unknown key `robt`; did you mean `robot`?",
                "motion 1: unknown type `movej`; did you mean `ptp`?",
            ]
        );
        for error in errors {
            assert!(error["file"].as_str().unwrap().ends_with("a.json"), "{error}");
            assert!(error["line"].is_u64() && error["column"].is_u64(), "{error}");
        }
    }
}

/// One program alone prints the objects that it prints in a folder, with its gates.
#[test]
fn one_program_prints_the_object_of_a_folder() {
    let wrong = turn(10.0).replacen('{', "{ \"speed\": 1, \"robt\": \"r\",", 1);
    let folder =
        folder(&[("good/a.json", &turn(10.0)), ("bad/a.json", &wrong), ("bad/b.json", "")]);
    let options =
        ["--no-output", "--json", "--max-cycle-time", "0.1", "--max-torque-percent", "90"];
    let plan = |path: &str, code: i32| {
        let assert = iiwasim(&folder, &[&["plan", path], &options[..]].concat()).code(code);
        (lines(&assert), stderr(&assert))
    };
    let (good, errors) = plan("good/a.json", 3);
    assert!(errors.contains("Gate not met: the program takes"), "{errors}");
    assert_eq!(good, plan("good", 3).0);
    let gates = &good[0]["gates"];
    assert_eq!(gates["max_cycle_time_s"]["limit"], 0.1);
    assert_eq!(gates["max_cycle_time_s"]["value"], good[0]["cycle_time_s"]);
    assert_eq!(gates["max_cycle_time_s"]["met"], false);
    assert_eq!(gates["max_torque_percent"]["met"], true);
    assert!(gates["min_clearance_mm"].is_null(), "{gates}");
    let all = plan("bad", 3).0;
    for (name, object) in ["bad/a.json", "bad/b.json"].into_iter().zip(all) {
        let (one, errors) = plan(name, 2);
        assert_eq!(one, [object]);
        assert!(errors.contains(name), "{errors}");
    }
    let (missing, _) = plan("missing.json", 2);
    assert!(missing[0]["error"].as_str().unwrap().starts_with("cannot read missing.json"));
}

#[test]
fn if_all_fail_the_exit_code_is_3_too() {
    let folder = folder(&[("a.json", ""), ("b.json", "{}")]);
    let assert = iiwasim(&folder, &["plan", "."]).code(3).stderr(contains("2 of 2 programs"));
    assert!(stdout(&assert).contains("0 planned, 2 failed; cycle times together 0.000 s"));
    assert_eq!(files(&folder), ["a.json", "b.json"]);
}

#[test]
fn the_gate_is_for_each_program() {
    let folder = cell();
    let limit = ["plan", "cell", "missing.json", "--no-output", "--max-cycle-time"];
    let assert = iiwasim(&folder, &[&limit[..], &["8"]].concat()).code(3);
    let message = stderr(&assert);
    assert!(message.contains("cell/appendix-b.json takes 8.927 s, more than 8 s"), "{message}");
    assert!(!message.contains("cell/ten-motions.json"), "{message}");
    assert!(message.contains("1 of 4 programs failed, 1 of 4 programs over 8 s"), "{message}");
    let rows = rows(&assert);
    assert_eq!(rows[0][8..], ["too", "long"]);
    assert_eq!(rows[1][8..], ["planned"]);
    let assert = iiwasim(&folder, &["plan", "cell", "--no-output", "--max-cycle-time", "9"]);
    let assert = assert.success().stderr(starts_with(SHORTENED));
    assert_eq!(stderr(&assert).lines().count(), 1);
}

#[test]
fn wrong_usage_is_refused_before_anything_is_planned() {
    let good = turn(10.0);
    let folder = folder(&[
        ("a.json", &good),
        ("b.json", &good),
        ("c.mcap", &good),
        ("cell/a.json", &good),
        ("none/readme.txt", ""),
    ]);
    rejects(&folder, &["plan", "none"], &["none", "no programs"]);
    rejects(&folder, &["plan", "a.json", "none"], &["none", "no programs"]);
    rejects(&folder, &["plan", "-", "a.json"], &["standard input", "alone"]);
    rejects(&folder, &["plan", "a.json", "b.json", "a.json"], &["a.json is given twice"]);
    rejects(&folder, &["plan", "x.json", "x.json"], &["x.json is given twice"]);
    rejects(&folder, &["plan", "cell", "cell/a.json"], &["cell/a.json is given twice"]);
    let same = ["a.json and cell/../a.json", "the same file"];
    rejects(&folder, &["plan", "a.json", "cell/../a.json", "--no-output"], &same);
    let both = ["a.json and cell/a.json", "both be written to a.mcap"];
    rejects(&folder, &["plan", "a.json", "cell"], &both);
    rejects(&folder, &["plan", "b.json", "c.mcap"], &["of c.mcap", "over c.mcap", "--output"]);
    rejects(&folder, &["plan", "a.json", "b.json", "-o", "c.mcap"], &["c.mcap", "not a folder"]);
    rejects(&folder, &["plan", "cell", "--picture", "p.svg"], &["--picture", "one program"]);
    rejects(&folder, &["plan", "a.json", "b.json", "--robot", "r2d2"], &["r2d2"]);
    rejects(
        &folder,
        &["plan", "a.json", "b.json", "--jobs", "0"],
        &["--jobs", "the range is 1 to 1024"],
    );
    rejects(&folder, &["plan", "a.json", "b.json", "--no-output", "-o", "out"], &["--output"]);
    // Without output files, there are no collisions.
    iiwasim(&folder, &["plan", "a.json", "cell", "--no-output"]).success();
    iiwasim(&folder, &["plan", "b.json", "c.mcap", "-o", "out"]).success();
    assert_eq!(fs::read_to_string(folder.path().join("c.mcap")).unwrap(), good);
}

#[test]
fn a_folder_that_cannot_be_made_exits_with_1() {
    let folder = folder(&[("a.json", &turn(10.0)), ("b.json", &turn(10.0))]);
    iiwasim(&folder, &["plan", ".", "-o", "a.json/out"])
        .code(1)
        .stdout(is_empty())
        .stderr(contains("cannot make the folder a.json/out"));
    assert_eq!(files(&folder), ["a.json", "b.json"]);
}

#[cfg(unix)]
#[test]
fn links_are_followed() {
    use std::os::unix::fs::symlink;

    let folder = folder(&[("cell/a.json", &turn(10.0)), ("cell/b.json", &turn(20.0))]);
    let path = |name: &str| folder.path().join(name);
    symlink("a.json", path("cell/link.json")).unwrap();
    symlink("nowhere", path("cell/lost.json")).unwrap();
    symlink("cell", path("linked")).unwrap();
    let assert = iiwasim(&folder, &["plan", "linked", "-o", "out"]).code(3);
    assert!(stderr(&assert).contains("cannot read linked/lost.json"));
    assert!(stdout(&assert).contains("3 planned, 1 failed"));
    let same = ["cell/a.json and linked/a.json", "the same file"];
    rejects(&folder, &["plan", "cell/a.json", "linked/a.json", "--no-output"], &same);

    // A link from an output to an input, and two links to the same file.
    fs::remove_file(path("out/a.mcap")).unwrap();
    symlink("../cell/b.json", path("out/a.mcap")).unwrap();
    let over = ["of cell/a.json", "over cell/b.json"];
    rejects(&folder, &["plan", "cell", "-o", "out"], &over);
    fs::remove_file(path("out/a.mcap")).unwrap();
    symlink("b.mcap", path("out/a.mcap")).unwrap();
    rejects(&folder, &["plan", "cell", "-o", "out"], &["cell/a.json and cell/b.json", "both"]);
    assert_eq!(fs::read_to_string(path("cell/b.json")).unwrap(), turn(20.0));
}

#[cfg(unix)]
#[test]
fn a_folder_that_cannot_be_read_is_refused() {
    use std::os::unix::fs::PermissionsExt;

    let folder = folder(&[("a.json", &turn(10.0)), ("shut/b.json", &turn(10.0))]);
    let shut = folder.path().join("shut");
    let permit = |mode| fs::set_permissions(&shut, fs::Permissions::from_mode(mode)).unwrap();
    permit(0o000);
    // Some users may read everything.
    if fs::read_dir(&shut).is_err() {
        rejects(&folder, &["plan", "a.json", "shut"], &["cannot read the folder shut"]);
    }
    permit(0o755);
}

#[cfg(unix)]
#[test]
fn names_need_not_be_text() {
    use std::{ffi::OsStr, os::unix::ffi::OsStrExt};

    let folder = folder(&[("cell/a.json", &turn(10.0)), ("cell/\u{1b}]0;x\u{7}.json", "{}")]);
    let name = OsStr::from_bytes(b"cell/\xff.json");
    fs::write(folder.path().join(name), turn(20.0)).unwrap();
    let assert = iiwasim(&folder, &["plan", "cell", "-o", "out", "--max-cycle-time", "0"]).code(3);
    assert!(folder.path().join("out").join(OsStr::from_bytes(b"\xff.mcap")).is_file());
    let output = assert.get_output();
    for said in [&output.stdout, &output.stderr] {
        let obeyed = said.contains(&0x1b) || said.contains(&7);
        assert!(!obeyed, "{}", String::from_utf8_lossy(said));
    }
}

#[test]
fn a_full_disk_leaves_no_half_of_a_file() {
    let folder = cell();
    fs::write(folder.path().join("cell/short.json"), turn(0.0)).unwrap();
    let output = Command::new("sh")
        .current_dir(&folder)
        .arg("-c")
        .arg(r#"trap "" XFSZ; ulimit -f 128; exec "$0" plan cell -o out"#)
        .arg(cargo_bin!("iiwasim"))
        .output()
        .unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{message}");
    assert!(message.contains("cell/ten-motions.json: cannot write"), "{message}");
    assert_eq!(names_in(&folder.path().join("out")), ["short.mcap"], "{message}");
}

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_whole_files_only() {
    // Stops throughout: many sections, between which an interrupt is noticed.
    let long = long_program(20_000).replace(r#", "blend": { "fraction": 0.25 }"#, "");
    let folder = folder(&[
        ("cell/a.json", &turn(10.0)),
        ("cell/b.json", &long),
        ("cell/c.json", &long),
        ("cell/d.json", &long),
    ]);
    let out = folder.path().join("out");
    let mut child = Command::new(cargo_bin!("iiwasim"))
        .current_dir(&folder)
        .args(["plan", "cell", "-o", "out", "--jobs", "2"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let started = Instant::now();
    let both_are_at_work = || {
        let names = names_in(&out);
        names.len() == 3 && names.contains(&"a.mcap".to_owned())
    };
    while !both_are_at_work() && started.elapsed() < Duration::from_mins(1) {
        std::thread::sleep(Duration::from_millis(2));
    }
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    assert_eq!(child.wait().unwrap().code(), Some(1));
    let output = child.wait_with_output().unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stderr), "Error: interrupted\n");
    assert!(output.stdout.is_empty());
    assert_eq!(names_in(&out), ["a.mcap"]);
}

/// Returns the names in a folder that may not exist yet.
fn names_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten();
    let mut names: Vec<_> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn assumed_limits_are_named_once() {
    let folder = cell();
    let assert = iiwasim(&folder, &["plan", "cell", "--no-output", "--robot", "lbr_iiwa_14_r820"]);
    let text = stdout(&assert.success());
    assert_eq!(text.matches("Assumed, not from a source, of lbr_iiwa_14_r820").count(), 3);
}

#[test]
fn help_shows_the_form_for_many() {
    let folder = tempdir().unwrap();
    iiwasim(&folder, &["plan", "--help"]).success().stdout(
        contains("iiwasim plan FOLDER")
            .and(contains("--jobs"))
            .and(contains("some programs of several failed")),
    );
}
