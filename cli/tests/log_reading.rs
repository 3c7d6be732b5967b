//! `--unit` and `--positions` of the commands that read logs.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::{fmt::Write as _, fs};

use iiwa_log::JointLog;
use predicates::str::contains;
use tempfile::{TempDir, tempdir};

use crate::helpers::fixture;
use crate::run::iiwasim;

/// Returns a folder with `plan.mcap`, its program, and logs in degrees as a `DataRecorder` writes
/// them: `both.log`, whose measured positions differ by 1 deg, and `measured.log` without commanded
/// ones.
fn logs() -> TempDir {
    let folder = tempdir().unwrap();
    let program = fixture("waits-and-stops.json");
    let program = program.to_str().unwrap();
    iiwasim(&folder, &["plan", program, "-o", "plan.mcap", "--rate", "500"]).success();
    fs::copy(program, folder.path().join("program.json")).unwrap();
    let plan = JointLog::read(&*fs::read(folder.path().join("plan.mcap")).unwrap()).unwrap();
    let names = |signal: &str| {
        let name = |j: usize| format!(" {signal}_LBR_iiwa_7_R800_1[{j}]");
        [0, 1, 2, 3, 4, 5, 6].map(name).concat()
    };
    let time = "% ZeitInSec ZeitInNanoSec";
    let mut both = format!("{time}{}{}\n", names("axisQMsr"), names("axisQCmdT1m"));
    let mut measured = format!("{time}{}\n", names("axisQMsr"));
    for (i, q_rad) in plan.q_rad.iter().enumerate() {
        let row = |off_deg: f64| q_rad.map(|q| format!(" {}", q.to_degrees() + off_deg)).concat();
        let time = format!("{} {}", 100 + i / 500, 2_000_000 * (i % 500));
        writeln!(both, "{time}{}{}", row(1.0), row(0.0)).unwrap();
        writeln!(measured, "{time}{}", row(1.0)).unwrap();
    }
    fs::write(folder.path().join("both.log"), both).unwrap();
    fs::write(folder.path().join("measured.log"), measured).unwrap();
    folder
}

#[test]
fn positions_are_those_that_were_asked_for() {
    let folder = logs();
    let off_rad = |arguments: &[&str]| {
        let arguments =
            [&["compare", "plan.mcap", "both.log", "--json", "--unit", "deg"], arguments].concat();
        let output = iiwasim(&folder, &arguments).success();
        let figures: serde_json::Value =
            serde_json::from_slice(&output.get_output().stdout).unwrap();
        figures["joint_deviation"]["max_rad"].as_f64().unwrap()
    };
    assert!(off_rad(&[]) > 0.01);
    assert!(off_rad(&["--positions", "measured"]) > 0.01);
    assert!(off_rad(&["--positions", "commanded"]) < 1e-6);
    for command in [
        &["compare", "plan.mcap", "measured.log"][..],
        &["report", "measured.log"],
        &["identify", "measured.log", "--program", "program.json", "--no-output"],
    ] {
        let asked = [command, &["--positions", "commanded", "--unit", "deg"]].concat();
        iiwasim(&folder, &asked)
            .code(2)
            .stderr(contains("measured.log: line 1: no commanded positions"));
    }
}

#[test]
fn units_are_those_that_were_stated() {
    let folder = logs();
    for command in [
        &["compare", "plan.mcap", "both.log"][..],
        &["report", "both.log"],
        &["identify", "both.log", "--program", "program.json", "--no-output"],
    ] {
        iiwasim(&folder, &[command, &["--unit", "deg"]].concat()).success();
        iiwasim(&folder, &[command, &["--unit", "rad"]].concat())
            .code(2)
            .stderr(contains("both.log: line"));
        iiwasim(&folder, &[command, &["--unit", "grad"]].concat())
            .code(2)
            .stderr(contains("[possible values: deg, rad]"));
    }
}
