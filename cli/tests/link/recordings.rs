//! Runs whose recordings could not be written are rejected before the robot moves.

use std::fs;

use predicates::{prelude::PredicateBooleanExt, str::contains};
use tempfile::tempdir;

use crate::run::{files, iiwasim};

/// Address without a drive.
const NOBODY: &str = "127.0.0.1:1";

const NO_DRIVE: &str = "no drive answers";

fn program(waits: usize) -> String {
    let motions = [r#"{ "type": "ptp", "joints_deg": [10, 30, 0, -60, 0, 90, 0] }"#]
        .into_iter()
        .chain([r#"{ "type": "wait", "seconds": 86400 }"#].repeat(waits));
    format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": [0, 30, 0, -60, 0, 90, 0] }},
            "motions": [{}] }}"#,
        motions.collect::<Vec<_>>().join(", ")
    )
}

#[test]
fn a_run_without_a_recording_is_refused_before_the_drive_is_asked() {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("short.json"), program(0)).unwrap();
    fs::write(folder.path().join("weeks.json"), program(20)).unwrap();
    fs::write(folder.path().join("kept.mcap"), "before").unwrap();
    fs::create_dir(folder.path().join("folder")).unwrap();
    let before = files(&folder);
    let run = |options: &[&str]| {
        let command = ["run", "--drive", NOBODY, "--stream", NOBODY];
        let done = iiwasim(&folder, &[&command[..], options].concat());
        assert_eq!(files(&folder), before, "{options:?}");
        done
    };
    let refusals: [(&[&str], i32, &str); 4] = [
        (&["--epoch", "2037-12-31T23:59:59Z", "weeks.json"], 1, "past the year 2038"),
        (&["-o", "kept.mcap", "short.json"], 2, "kept.mcap exists"),
        (&["-o", "none/a.mcap", "short.json"], 1, "no such folder: none"),
        (&["-o", "folder", "--overwrite", "short.json"], 1, "cannot write"),
    ];
    for (options, code, why) in refusals {
        run(options).code(code).stderr(contains(why).and(contains(NO_DRIVE).not()));
    }
    assert_eq!(fs::read(folder.path().join("kept.mcap")).unwrap(), b"before");
    // The same programs are accepted if they can be recorded, or are not recorded.
    run(&["weeks.json"]).code(1).stderr(contains(NO_DRIVE));
    run(&["-o", "kept.mcap", "--overwrite", "short.json"]).code(1).stderr(contains(NO_DRIVE));
}
