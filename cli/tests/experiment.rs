//! `iiwasim experiment` as a process: files, exit codes, messages.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::{fs, path::Path};

use iiwa_kin::Robot;
use iiwa_log::JointLog;
use iiwa_program::Program;
use predicates::{prelude::PredicateBooleanExt, str::contains};
use tempfile::{TempDir, tempdir};

use crate::run::{files, iiwasim};

fn listed(folder: &TempDir, path: &str) -> Vec<String> {
    let names = fs::read_dir(folder.path().join(path)).unwrap();
    let mut names: Vec<_> =
        names.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn text(folder: &TempDir, path: &str) -> String {
    fs::read_to_string(folder.path().join(path)).unwrap()
}

/// Returns the number in a column of the first report row that begins with `row`.
fn number(report: &str, row: &str, column: usize) -> f64 {
    let line = report.lines().find(|line| line.starts_with(&format!("| {row}"))).unwrap();
    let cell = line.split('|').nth(column + 1).unwrap().trim();
    cell.split(' ').next().unwrap().parse().unwrap()
}

#[test]
fn zone_velocity_writes_the_reported_files() {
    let folder = tempdir().unwrap();
    iiwasim(&folder, &["experiment", "zone-velocity", "--simulate"])
        .success()
        .stdout("1 program on a virtual robot; report in experiment-zone-velocity/report.md\n")
        .stderr(contains("B in experiment-zone-velocity; --no-recordings"));
    assert_eq!(files(&folder), ["experiment-zone-velocity"]);
    let expected = ["figure-29.svg", "programs", "recordings", "report.md"];
    assert_eq!(listed(&folder, "experiment-zone-velocity"), expected);
    let recordings = "experiment-zone-velocity/recordings";
    assert_eq!(listed(&folder, recordings), ["appendix-b.csv", "appendix-b.mcap"]);

    // Both recordings are equal, and contain the program beside them.
    let read = |name: &str| {
        let file = fs::File::open(folder.path().join(recordings).join(name)).unwrap();
        JointLog::read(file).unwrap()
    };
    let (csv, mcap) = (read("appendix-b.csv"), read("appendix-b.mcap"));
    assert_eq!(csv.q_rad, mcap.q_rad);
    assert!(csv.t_s.iter().zip(&mcap.t_s).all(|(a, b)| (a - b).abs() < 1e-8));
    let program = text(&folder, "experiment-zone-velocity/programs/appendix-b.json");
    assert_eq!(mcap.program.as_deref(), Some(program.trim_end()));
    assert_eq!(Program::from_json(&program).unwrap().motions.len(), 4);

    let report = text(&folder, "experiment-zone-velocity/report.md");
    assert!(report.contains("not on a real one") && report.contains("](figure-29.svg)"));
    assert!(report.contains("in 3 of 3 blends"), "{report}");
    let svg = text(&folder, "experiment-zone-velocity/figure-29.svg");
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
}

#[test]
fn limits_are_those_of_the_virtual_robot() {
    let folder = tempdir().unwrap();
    let profile =
        r#"{ "version": 1, "acceleration_limit_deg_s2": [400, 490, 500, 650, 700, 900, 900] }"#;
    fs::write(folder.path().join("weak.json"), profile).unwrap();
    let options = ["--count", "2", "--virtual-robot", "weak.json", "--noise", "0", "-o", "out"];
    iiwasim(&folder, &[&["experiment", "limits", "--simulate"], &options[..]].concat()).success();
    let report = text(&folder, "out/report.md");
    assert!((number(&report, "mean", 1) - 400.0).abs() < 0.5, "{report}");
    assert!((number(&report, "mean", 2) - 490.0).abs() < 0.5);
    assert!(report.contains("It is `weak.json`, while the model is lbr_iiwa_7_r800"));
    assert!(listed(&folder, "out").contains(&"figure-28.svg".to_owned()));
    let programs = ["pose-01.json", "pose-02.json", "wide.json"];
    assert_eq!(listed(&folder, "out/programs"), programs);
}

#[test]
fn blends_distinguish_the_shapes() {
    let folder = tempdir().unwrap();
    let command = ["experiment", "blends", "--simulate", "--no-recordings", "-o", "out"];
    iiwasim(&folder, &command).success();
    let figures = [15, 16, 17, 18, 20, 21].map(|number| format!("figure-{number}.svg"));
    let mut expected = figures.to_vec();
    expected.push("report.md".to_owned());
    assert_eq!(listed(&folder, "out"), expected);
    let report = text(&folder, "out/report.md");
    for shape in ["Eq. 13", "Eq. 26", "Eq. 32"] {
        assert!(number(&report, shape, 2) > 100.0 * number(&report, "Eq. 39", 2), "{report}");
    }
}

#[test]
fn settling_measures_the_settling_time_of_the_robot() {
    let folder = tempdir().unwrap();
    let command = ["experiment", "settle", "--simulate", "--count", "20", "-o", "out"];
    iiwasim(&folder, &command).success();
    let report = text(&folder, "out/report.md");
    assert!((number(&report, "on a virtual robot", 1) - 0.05).abs() < 0.001, "{report}");
    assert_eq!(number(&report, "on a virtual robot", 3), 19.0);
}

/// Larsen 2019, section 5.1.2: with acceleration limits only, calculated times are too short, the
/// more so the faster, shorter and less blended the motions are; jerk limits explain the
/// difference.
#[test]
fn cycle_times_err_as_the_thesis_says() {
    let folder = tempdir().unwrap();
    let command = ["experiment", "cycle-time", "--simulate", "--count", "1", "--no-recordings"];
    iiwasim(&folder, &[&command[..], &["-o", "out"]].concat()).success();
    let report = text(&folder, "out/report.md");
    let section = |title: &str| report.split(&format!("### {title}")).nth(1).unwrap();
    let error = |title: &str, row: &str| number(section(title), row, 3);
    assert!(error("Fig. 23", "0.1 ").abs() < 0.1);
    assert!(error("Fig. 23", "1 ") < 5.0 * error("Fig. 23", "0.1 "));
    assert!(error("Fig. 24", "0 ") < 3.0 * error("Fig. 24", "0.5 "));
    assert!(error("Fig. 25", "25 ") < 10.0 * error("Fig. 25", "200 "));
    assert!(error("Path length at full speed", "25 ") < -15.0);
    let by_jerk = report.split(" by acceleration and ").nth(1).unwrap();
    let by_jerk: f64 = by_jerk.split(' ').next().unwrap().parse().unwrap();
    assert!(by_jerk < 0.1, "{by_jerk}");
}

/// A robot whose blends of TCP paths differ from the model's is recognised and identified.
#[test]
fn blends_of_the_tcp_are_those_of_the_virtual_robot() {
    let folder = tempdir().unwrap();
    let kappa = [-2.0, 0.01, 0.0001];
    let profile = Robot::default().with_tcp_blend_kappa(kappa).to_profile();
    fs::write(folder.path().join("other.json"), profile).unwrap();
    let options = ["--virtual-robot", "other.json", "--rate", "250", "-o", "out"];
    let command = [&["experiment", "tcp-blends", "--simulate"], &options[..]].concat();
    iiwasim(&folder, &command).success();
    let files =
        ["figure-tcp-kappa.svg", "figure-tcp-paths.svg", "programs", "recordings", "report.md"];
    assert_eq!(listed(&folder, "out"), files);
    let report = text(&folder, "out/report.md");
    assert!(report.starts_with("# An experiment with TCP paths"), "{report}");
    assert!(!report.contains("Not used"), "{report}");
    for row in ["way before the target", "way behind the target"] {
        assert!((number(&report, row, 1) - 1.0).abs() < 0.01, "{report}");
    }
    assert!(number(&report, "difference of both sides", 1).abs() < 0.02);
    assert_eq!(number(&report, "blends between joint space", 1), 8.0);
    assert!(number(&report, "blends between joint space", 2) < 0.1);

    let identify = ["identify", "out/recordings/tcp-blends.mcap", "-o", "mine.json", "--json"];
    let output = iiwasim(&folder, &identify).success();
    let figures: serde_json::Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    assert_eq!(figures["kappa"], serde_json::Value::Null);
    let blends = figures["tcp"]["blends"].as_array().unwrap().len();
    assert_eq!(figures["tcp"]["kappa"]["count"].as_u64(), Some(blends as u64));
    let mine = Robot::from_profile(&text(&folder, "mine.json")).unwrap();
    for gamma in [20.0, 90.0, 160.0] {
        let expected = kappa[0] + gamma * (kappa[1] + gamma * kappa[2]);
        assert!((mine.tcp_kappa(gamma) - expected).abs() < 0.02, "{gamma}");
    }
    assert_eq!(mine.blend_kappa(), Robot::default().blend_kappa());
    let printed = ["identify", "out/recordings/tcp-blends.mcap", "--no-output"];
    iiwasim(&folder, &printed).success().stdout(
        contains("kappa of TCP blends = -2.0")
            .and(contains("They begin and end at equal ways: confirmed"))
            .and(contains("8 blends between joint space and a TCP path, at most away")),
    );
}

/// The page in the documentation is the output of the command in its first lines.
#[test]
fn the_committed_page_is_current() {
    let folder = tempdir().unwrap();
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let page = fs::read_to_string(docs.join("evaluation.md")).unwrap();
    let command = page.lines().find_map(|line| line.strip_prefix("iiwasim ")).unwrap();
    iiwasim(&folder, &command.split(' ').collect::<Vec<_>>()).success();
    assert_alike(&text(&folder, "docs/evaluation.md"), &page, command);
    let mut names: Vec<_> = fs::read_dir(docs.join("evaluation"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(listed(&folder, "docs/evaluation"), names);
    for name in names {
        let committed = fs::read_to_string(docs.join("evaluation").join(&name)).unwrap();
        assert_alike(&text(&folder, &format!("docs/evaluation/{name}")), &committed, command);
    }
}

/// Checks that all words are equal, and all numbers except one in 50: numbers differ by rounding on
/// other processors, and curves may then have a point more or less.
fn assert_alike(made: &str, committed: &str, command: &str) {
    let split = |text: &str| -> (Vec<String>, Vec<String>) {
        let parts = text.split(|c: char| c.is_whitespace() || ",\"|".contains(c));
        let parts = parts.filter(|part| !part.is_empty()).map(str::to_owned);
        parts.partition(|part| part.contains(|c: char| c.is_ascii_digit()))
    };
    let (mut numbers, words) = split(made);
    let (expected_numbers, expected_words) = split(committed);
    assert_eq!(words, expected_words, "make it anew: iiwasim {command}");
    let allowed = expected_numbers.len() / 50;
    let mut missing = Vec::new();
    for number in expected_numbers {
        match numbers.iter().position(|made| *made == number) {
            Some(place) => drop(numbers.remove(place)),
            None => missing.push(number),
        }
    }
    assert!(
        numbers.len().max(missing.len()) <= allowed,
        "make it anew: iiwasim {command}; {missing:?} became {numbers:?}"
    );
}

#[test]
fn infeasible_experiments_are_reported() {
    let folder = tempdir().unwrap();
    let experiment =
        |options: &[&str]| iiwasim(&folder, &[&["experiment", "zone-velocity"], options].concat());
    experiment(&[]).code(2).stderr(contains("--simulate").and(contains("--drive")));
    experiment(&["--drive", "127.0.0.1:1"]).code(2).stderr(contains("--move-to-start"));
    experiment(&["--simulate", "--drive", "127.0.0.1:1"])
        .code(2)
        .stderr(contains("cannot be used"));
    experiment(&["--simulate", "--virtual-robot", "none.json"])
        .code(2)
        .stderr(contains("no robot is called `none.json`"));
    fs::write(folder.path().join("bad.json"), "{\n  \"version\": 1,\n  \"speed\": 2\n}").unwrap();
    experiment(&["--simulate", "--virtual-robot", "bad.json"])
        .code(2)
        .stderr(contains("bad.json, line 3").and(contains("speed")));
    experiment(&["--simulate", "-o", "bad.json"]).code(2).stderr(contains("is a file"));
    experiment(&["--simulate", "-o", "out", "--report", "other/report.md"])
        .code(2)
        .stderr(contains("neither in the folder out nor above it"));

    // Robot recordings never overwrite files; those of virtual robots do.
    fs::create_dir(folder.path().join("full")).unwrap();
    fs::write(folder.path().join("full/notes.txt"), "mine").unwrap();
    experiment(&["--drive", "127.0.0.1:1", "--move-to-start", "-o", "full"])
        .code(2)
        .stderr(contains("full is not empty"));
    experiment(&["--simulate", "-o", "full"]).success();
    experiment(&["--simulate", "-o", "full"]).success();
    assert_eq!(text(&folder, "full/notes.txt"), "mine");
}

#[test]
fn without_a_drive_nothing_is_written() {
    let folder = tempdir().unwrap();
    iiwasim(&folder, &["experiment", "zone-velocity", "--drive", "127.0.0.1:1", "--move-to-start"])
        .code(1)
        .stderr(
            contains("cannot ask for the position of the robot")
                .and(contains("A2   -27.2 and   63.6")),
        );
    assert!(files(&folder).is_empty());
}

/// The recordings of motions with a load identify it, in the report and with `identify`.
#[test]
fn swings_with_a_load_identify_planner_and_load() {
    for (planner, result) in [
        ("none", "the planner does not take the load into account"),
        ("factor", "accelerations fall alike in all poses, by 2.0"),
        ("torque", "the planner keeps torques within 100.0"),
    ] {
        let folder = tempdir().unwrap();
        let args = ["experiment", "load", "--simulate", "--load-planner", planner, "-o", "e"];
        iiwasim(&folder, &args)
            .success()
            .stdout("2 programs on a virtual robot; report in e/report.md\n");
        let report = text(&folder, "e/report.md").replace('\n', " ");
        assert!(report.contains(&format!("**Result: {result}")), "{report}");
        let expected = ["load-0-kg.csv", "load-0-kg.mcap", "load-7-kg.csv", "load-7-kg.mcap"];
        assert_eq!(listed(&folder, "e/recordings"), expected);
        if planner == "none" {
            let recordings = ["e/recordings/load-0-kg.mcap", "e/recordings/load-7-kg.mcap"];
            let args = ["identify", recordings[0], recordings[1], "--no-output", "--json"];
            let output = iiwasim(&folder, &args).success().get_output().stdout.clone();
            let figures: serde_json::Value = serde_json::from_slice(&output).unwrap();
            let [none, some] = [0, 1].map(|i| figures["torques"]["loads"][i].clone());
            assert!(none["mass_kg"]["value"].as_f64().unwrap().abs() < 0.01, "{none}");
            assert!(none["load"].is_null() && none["stated"].is_null(), "{none}");
            assert_eq!(some["stated"]["mass_kg"], 7.0);
            assert!((some["mass_kg"]["value"].as_f64().unwrap() - 7.0).abs() < 0.02, "{some}");
            // A2 and A4 alone do not turn the load about an axis that reveals y.
            assert!((some["center_mm"][2]["value"].as_f64().unwrap() - 60.0).abs() < 3.0, "{some}");
        }
    }
}
