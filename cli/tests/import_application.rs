//! `iiwasim import` and `iiwasim plan` of applications, as processes.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::{fs, path::PathBuf};

use crate::run::{files, iiwasim};
use iiwa_program::Program;
use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

fn fixture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../fixtures/sunrise").join(name)
}

/// Runs `command` on one of the fixture projects.
fn run_on(
    folder: &TempDir,
    command: &str,
    name: &str,
    options: &[&str],
) -> assert_cmd::assert::Assert {
    let project = fixture(name);
    let project = project.to_str().unwrap();
    iiwasim(folder, &[&[command, project], options].concat())
}

fn wave(class: &str, angle: &str) -> String {
    format!(
        "import static com.kuka.roboticsAPI.motionModel.BasicMotions.*;\n\
         public class {class} extends RoboticsAPIApplication {{\n\
         @Inject private LBR lbr;\n\
         public void run() {{\nlbr.move(ptp({angle}, 0, 0, 0, 0, 0, 0));\n}}\n}}\n"
    )
}

#[test]
fn the_only_application_becomes_a_program_of_its_name() {
    let folder = tempdir().unwrap();
    run_on(&folder, "import", "joints", &[]).success().stdout(contains("Program of "));
    let [file] = <[String; 1]>::try_from(files(&folder)).unwrap();
    let program =
        Program::from_json(&fs::read_to_string(folder.path().join(&file)).unwrap()).unwrap();
    let stated = fs::read_to_string(fixture("joints").join("expected.json")).unwrap();
    assert_eq!(program.sources, Program::from_json(&stated).unwrap().sources);
    // The program may have been edited.
    run_on(&folder, "import", "joints", &[]).code(2).stderr(contains("--overwrite"));
    run_on(&folder, "import", "joints", &["--overwrite"]).success();
    iiwasim(&folder, &["plan", &file, "--no-output"]).success().stdout(contains(".java:"));
}

#[test]
fn an_application_is_planned_at_once() {
    let folder = tempdir().unwrap();
    let planned =
        run_on(&folder, "plan", "async", &["--application", "Handover", "--json"]).success();
    let figures: Value = serde_json::from_slice(&planned.get_output().stdout).unwrap();
    assert_eq!(figures["motions"][0]["source"]["file"], "src/application/Handover.java");
    assert_eq!(files(&folder), ["Handover.mcap"]);
}

#[test]
fn several_applications_are_listed() {
    let folder = tempdir().unwrap();
    let sources = folder.path().join("project/src");
    fs::create_dir_all(&sources).unwrap();
    fs::write(sources.join("Left.java"), wave("Left", "0.5")).unwrap();
    fs::write(sources.join("Right.java"), wave("Right", "Math.random()")).unwrap();
    iiwasim(&folder, &["import", "project"])
        .code(2)
        .stdout(
            contains("Left").and(contains("Right cannot be planned ahead")).and(contains("random")),
        )
        .stderr(contains("name one with --application"));
    iiwasim(&folder, &["import", "project", "--application", "Middle"])
        .code(2)
        .stderr(contains("no application `Middle`").and(contains("Left, Right")));
    assert_eq!(files(&folder), ["project"]);
    iiwasim(&folder, &["plan", "project"]).code(2).stderr(contains("--application"));
    iiwasim(&folder, &["import", "project", "--application", "Left", "-o", "left.json"]).success();
    assert_eq!(files(&folder), ["left.json", "project"]);
}

#[test]
fn refusals_state_place_and_reason_and_write_nothing() {
    let folder = tempdir().unwrap();
    for (name, place, reason) in [
        ("refused/smart-servo", "src/application/Follow.java:21", "SmartServo"),
        ("refused/missing-frame", "src/application/Fetch.java:17", "/Table/Pick"),
    ] {
        run_on(&folder, "import", name, &[]).code(2).stderr(contains(place).and(contains(reason)));
        let shown = run_on(&folder, "import", name, &["--json", "--no-output"]).code(2);
        let report: Value = serde_json::from_slice(&shown.get_output().stdout).unwrap();
        assert!(report["refused"]["text"].as_str().unwrap().contains(reason));
    }
    assert!(files(&folder).is_empty());
}

#[test]
fn answers_come_from_a_file_or_from_options() {
    let folder = tempdir().unwrap();
    let all = run_on(&folder, "import", "dialogs", &["--json", "--no-output"]).success();
    let report: Value = serde_json::from_slice(&all.get_output().stdout).unwrap();
    let dialog = |report: &Value| {
        let mut questions = report["questions"].as_array().unwrap().iter();
        questions.find(|question| question["kind"] == "dialog").cloned().unwrap()
    };
    let question = dialog(&report);
    assert_eq!(question["asked"], "Which part is fetched?");
    assert_eq!((&question["answer"], &question["is_given"]), (&"1".into(), &true.into()));
    let other = ["--answer", "Which part=0", "--json", "--no-output"];
    let other = run_on(&folder, "import", "dialogs", &other).success();
    let other: Value = serde_json::from_slice(&other.get_output().stdout).unwrap();
    assert_eq!(dialog(&other)["answer"], "0");
    for (option, value, reason) in [
        ("--answer", "Which part", "a name, = and a value"),
        ("--answer", "Which part=left", "number of a button"),
        ("--answers", "none.toml", "cannot read none.toml"),
        ("--time", "Fetch.java:3=-1", "a number of seconds from 0"),
        ("--tool", "Pen=0,0", "x, y, z in mm"),
        ("--start-deg", "0,0,0,-130,0,0,0", "A4"),
    ] {
        run_on(&folder, "import", "dialogs", &[option, value]).code(2).stderr(contains(reason));
    }
    fs::write(folder.path().join("wrong.toml"), "[answer]\n\"Which\" = 1\n").unwrap();
    run_on(&folder, "import", "dialogs", &["--answers", "wrong.toml"])
        .code(2)
        .stderr(contains("wrong.toml, line 1"));
}

#[test]
fn frames_of_a_project_with_applications_are_had_too() {
    let folder = tempdir().unwrap();
    run_on(&folder, "import", "frames", &["--frames"]).success();
    assert_eq!(files(&folder), ["frames.json"]);
}

#[test]
fn robot_and_flange_are_shown_and_asked_for() {
    let folder = tempdir().unwrap();
    run_on(&folder, "import", "dialogs", &["--no-output"])
        .success()
        .stdout(contains("Robot lbr_iiwa_7_r800, flange 152 mm\n"))
        .stdout(contains("--flange-mm 152"));
    let given = ["--robot", "lbr_iiwa_14_r820", "--flange-mm", "126", "--no-output"];
    run_on(&folder, "import", "dialogs", &given)
        .success()
        .stdout(contains("Robot lbr_iiwa_14_r820, flange 126 mm\n"))
        .stdout(contains("--flange-mm").not());
    run_on(&folder, "import", "dialogs", &["--flange-mm", "0"]).code(2);
    run_on(&folder, "import", "../sunrise-cases/start-unknown", &[])
        .code(2)
        .stderr(contains("the start is not given").and(contains("--start-deg")));
}

#[test]
fn a_profile_comes_along_with_the_program() {
    let folder = tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let profile = "{ \"version\": 1, \"lengths_mm\": { \"flange\": 140 } }\n";
    for name in ["robots", "programs"] {
        fs::create_dir(path(name)).unwrap();
    }
    fs::write(path("robots/cell.json"), profile).unwrap();
    let robot = path("robots/cell.json").display().to_string();
    let target = ["--robot", &robot, "-o", "programs/wave.json"];
    run_on(&folder, "import", "dialogs", &target).success();
    assert_eq!(fs::read_to_string(path("programs/cell.json")).unwrap(), profile);
    let program: Value =
        serde_json::from_str(&fs::read_to_string(path("programs/wave.json")).unwrap()).unwrap();
    assert_eq!(program["robot"], "cell.json");
    assert!(program.get("flange_mm").is_none());
    // Another profile with this name is kept.
    fs::write(path("programs/cell.json"), "{ \"version\": 1 }\n").unwrap();
    let again = ["--robot", &robot, "-o", "programs/again.json"];
    run_on(&folder, "import", "dialogs", &again).code(2).stderr(contains("cell.json exists"));
    assert!(!path("programs/again.json").exists());
}

#[test]
fn durations_and_tools_that_the_project_lacks_are_given() {
    let folder = tempdir().unwrap();
    let hold = ["--time", "Lean.java:21=2.5", "--json", "--no-output"];
    let held = run_on(&folder, "import", "../sunrise-cases/hold-until-ended", &hold).success();
    let report: Value = serde_json::from_slice(&held.get_output().stdout).unwrap();
    assert_eq!(report["motions"][1]["type"], "wait");
    assert_eq!(report["questions"][0]["kind"], "time");
    let without = run_on(&folder, "import", "../sunrise-cases/hold-until-ended", &["--no-output"]);
    without.success().stdout(contains("--time \"src/application/Lean.java:21=0\""));
    run_on(&folder, "import", "../sunrise-cases/tool-missing", &["--no-output"])
        .code(2)
        .stderr(contains("no template `Pen`").and(contains("--tool")));
    let tool = ["--tool", "Pen=0,0,120", "--tool", "Pen/Side=50,0,100,0,90,0", "--no-output"];
    run_on(&folder, "import", "../sunrise-cases/tool-missing", &tool).success();
}

#[test]
fn a_data_file_to_fill_in_lists_all_that_is_missing() {
    let folder = tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    run_on(&folder, "import", "../sunrise-cases/no-data-file", &[])
        .code(2)
        .stderr(contains("--write-data"));
    run_on(&folder, "import", "../sunrise-cases/no-data-file", &["--write-data", "data.xml"])
        .success()
        .stdout(contains("- the template `Pen`\n- the frame `/Start`\n- the frame `/End`\n"));
    // Once completed, the file is the data file of the project.
    let mut text = fs::read_to_string(path("data.xml")).unwrap();
    for (frame, x) in [("Start", "500.0"), ("End", "550.0")] {
        let place = r#"<transformation a="0.0" b="0.0" c="0.0" x="0.0" y="0.0" z="0.0"/>"#;
        let (before, after) = text.split_once(&format!("<frame name=\"{frame}\">")).unwrap();
        let filled = place
            .replace("b=\"0.0\"", "b=\"3.141592653589793\"")
            .replace("x=\"0.0\"", &format!("x=\"{x}\""))
            .replace("z=\"0.0\"", "z=\"300.0\"");
        let after = after.replacen(place, &filled, 1);
        text = format!("{before}<frame name=\"{frame}\">{after}");
    }
    let project = path("project");
    fs::create_dir_all(project.join("src/application")).unwrap();
    let java = "src/application/Probe.java";
    fs::copy(fixture("../sunrise-cases/no-data-file").join(java), project.join(java)).unwrap();
    fs::write(project.join("RoboticsAPI.data.xml"), text).unwrap();
    let start = ["import", "project", "--start-deg", "0,30,0,-60,0,90,0", "--no-output"];
    iiwasim(&folder, &start).success().stdout(contains("lin"));
    // Other files are not overwritten.
    run_on(&folder, "import", "../sunrise-cases/no-data-file", &["--write-data", "data.xml"])
        .code(2)
        .stderr(contains("data.xml exists"));
    run_on(&folder, "import", "joints", &["--write-data", "none.xml"]).code(2);
    assert!(!path("none.xml").exists());
}

#[test]
fn questions_without_an_answer_are_named_with_their_option() {
    let folder = tempdir().unwrap();
    let case = "../sunrise-cases/break-condition-decides";
    let place = "src/application/Probe.java:27";
    run_on(&folder, "import", case, &[])
        .code(2)
        .stderr(contains(format!("give --fired \"{place}=true\" or \"{place}=false\"")));
    run_on(&folder, "import", case, &["--fired", "Probe.java:27=perhaps"])
        .code(2)
        .stderr(contains("true or false"));
    run_on(&folder, "import", case, &["--fired", "Probe.java:27=true"])
        .success()
        .stdout(contains(place));
}
