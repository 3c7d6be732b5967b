//! Optional features: their list, and reports of missing ones.

use predicates::{prelude::PredicateBooleanExt, str::contains};
use tempfile::tempdir;

use crate::{helpers::fixture, run::iiwasim};

/// Features, `true` if the tests are built with them, and their commands.
const FEATURES: [(&str, bool, &[&str]); 8] = [
    ("live", cfg!(feature = "live"), &["run", "experiment", "twin", "drive", "cabinet", "stop"]),
    ("sunrise", cfg!(feature = "sunrise"), &["import", "export"]),
    ("optimise", cfg!(feature = "optimise"), &["advise", "optimise", "order", "place"]),
    ("pictures", cfg!(feature = "pictures"), &[]),
    ("parquet", cfg!(feature = "parquet"), &[]),
    ("bridge", cfg!(feature = "bridge"), &["bridge", "replay", "history"]),
    ("ros2", cfg!(feature = "ros2"), &[]),
    ("opcua", cfg!(feature = "opcua"), &[]),
];

#[test]
fn the_version_lists_the_features() {
    let folder = tempdir().unwrap();
    let output = iiwasim(&folder, &["--version"]).success().get_output().stdout.clone();
    let text = String::from_utf8(output).unwrap();
    let (_, listed) = text.trim_end().split_once("features: ").unwrap();
    let expected: Vec<_> = FEATURES.iter().filter(|it| it.1).map(|it| it.0).collect();
    let expected = if expected.is_empty() { "none".to_owned() } else { expected.join(", ") };
    assert_eq!(listed, expected);
}

#[test]
fn commands_of_missing_features_state_the_feature() {
    let folder = tempdir().unwrap();
    for (feature, is_enabled, commands) in FEATURES {
        for command in commands {
            if is_enabled {
                iiwasim(&folder, &[command, "--help"]).success();
            } else {
                let how = format!("cargo install --locked --path cli --features {feature}");
                iiwasim(&folder, &[command, "--help"]).code(2).stderr(contains(&how));
                iiwasim(&folder, &["--help"]).success().stdout(contains(*command));
            }
        }
    }
    // Other unknown commands are reported as before.
    iiwasim(&folder, &["plann"]).code(2).stderr(contains("plan").and(contains("--features").not()));
}

#[test]
fn options_of_missing_features_state_the_feature() {
    let folder = tempdir().unwrap();
    let program = fixture("appendix-b.json").display().to_string();
    let png = ["plan", &program, "--no-output", "--picture", "a.png"];
    let pdf = ["plan", &program, "--no-output", "--picture", "a.pdf"];
    let parquet = ["plan", &program, "--no-output", "--parquet", "a.parquet"];
    let application = ["plan", ".", "--application", "App"];
    let options: [(bool, &str, &[&str]); 5] = [
        (cfg!(feature = "pictures"), "pictures", &png),
        (cfg!(feature = "pictures"), "pictures", &pdf),
        (cfg!(feature = "parquet"), "parquet", &parquet),
        (cfg!(feature = "sunrise"), "sunrise", &application),
        (cfg!(feature = "bridge"), "bridge", &["schema", "bridge"]),
    ];
    for (is_enabled, feature, arguments) in options {
        if !is_enabled {
            let how = format!("--features {feature}");
            iiwasim(&folder, arguments).code(2).stderr(contains(&how).and(contains("full")));
        }
    }
    assert_eq!(crate::run::files(&folder), [""; 0]);
}
