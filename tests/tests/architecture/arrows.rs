//! Which crate may use which.

use std::collections::BTreeMap;

use crate::tests::architecture::offenders::forbid;
use crate::tests::architecture::sources::members;

/// Each library and what it may depend on. Data flows one way; whoever draws an arrow here draws it in the
/// README, too.
const ALLOWED: [(&str, &[&str]); 26] = [
    ("iiwa-json", &[]),
    ("iiwa-kin", &["iiwa-json"]),
    ("iiwa-program", &["iiwa-json", "iiwa-kin"]),
    ("iiwa-path", &["iiwa-json", "iiwa-kin", "iiwa-program"]),
    ("iiwa-solver", &["iiwa-json", "iiwa-kin", "iiwa-program", "iiwa-path"]),
    ("iiwa-traj", &["iiwa-json", "iiwa-kin", "iiwa-program", "iiwa-path", "iiwa-solver"]),
    (
        "iiwa-plan",
        &["iiwa-files", "iiwa-json", "iiwa-kin", "iiwa-program", "iiwa-path", "iiwa-traj"],
    ),
    ("iiwa-scene", &["iiwa-json", "iiwa-kin", "iiwa-program", "iiwa-path", "iiwa-traj"]),
    ("iiwa-java", &[]),
    ("iiwa-sunrise", &["iiwa-java", "iiwa-json", "iiwa-kin", "iiwa-program"]),
    ("iiwa-application", &["iiwa-java", "iiwa-json", "iiwa-kin", "iiwa-program", "iiwa-sunrise"]),
    ("iiwa-log", &["iiwa-json", "iiwa-kin", "iiwa-program", "iiwa-path", "iiwa-traj", "iiwa-plan"]),
    (
        "iiwa-eval",
        &[
            "iiwa-json",
            "iiwa-kin",
            "iiwa-program",
            "iiwa-path",
            "iiwa-traj",
            "iiwa-plan",
            "iiwa-scene",
            "iiwa-log",
        ],
    ),
    (
        "iiwa-view",
        &[
            "iiwa-json",
            "iiwa-kin",
            "iiwa-program",
            "iiwa-path",
            "iiwa-traj",
            "iiwa-plan",
            "iiwa-scene",
            "iiwa-sunrise",
            "iiwa-log",
            "iiwa-eval",
        ],
    ),
    ("iiwa-foxglove", &["iiwa-kin", "iiwa-link", "iiwa-log"]),
    ("iiwa-files", &[]),
    (
        "iiwa-twin",
        &[
            "iiwa-files",
            "iiwa-json",
            "iiwa-kin",
            "iiwa-program",
            "iiwa-path",
            "iiwa-traj",
            "iiwa-plan",
            "iiwa-scene",
            "iiwa-link",
            "iiwa-log",
            "iiwa-view",
            "iiwa-foxglove",
        ],
    ),
    ("iiwa-fri", &["iiwa-kin"]),
    ("iiwa-link", &["iiwa-json", "iiwa-kin", "iiwa-program"]),
    ("iiwa-bridge", &["iiwa-json", "iiwa-kin", "iiwa-link"]),
    ("iiwa-opcua", &["iiwa-json", "iiwa-kin", "iiwa-link", "iiwa-bridge"]),
    (
        "iiwa-ros2",
        &[
            "iiwa-json",
            "iiwa-kin",
            "iiwa-program",
            "iiwa-path",
            "iiwa-traj",
            "iiwa-link",
            "iiwa-log",
            "iiwa-bridge",
        ],
    ),
    (
        "iiwa-drive",
        &[
            "iiwa-json",
            "iiwa-kin",
            "iiwa-program",
            "iiwa-path",
            "iiwa-traj",
            "iiwa-fri",
            "iiwa-link",
        ],
    ),
    (
        "iiwa-cabinet",
        &["iiwa-kin", "iiwa-program", "iiwa-path", "iiwa-traj", "iiwa-fri", "iiwa-link"],
    ),
    (
        "iiwa-c",
        &[
            "iiwa-files",
            "iiwa-json",
            "iiwa-kin",
            "iiwa-program",
            "iiwa-path",
            "iiwa-traj",
            "iiwa-plan",
        ],
    ),
    (
        "iiwa",
        &[
            "iiwa-json",
            "iiwa-kin",
            "iiwa-program",
            "iiwa-path",
            "iiwa-solver",
            "iiwa-traj",
            "iiwa-plan",
            "iiwa-scene",
            "iiwa-sunrise",
            "iiwa-application",
            "iiwa-log",
            "iiwa-eval",
            "iiwa-view",
            "iiwa-foxglove",
            "iiwa-bridge",
            "iiwa-fri",
            "iiwa-link",
            "iiwa-drive",
            "iiwa-cabinet",
        ],
    ),
];

/// Crates for command lines, which libraries leave to those who write one.
const COMMAND_LINE: [&str; 2] = ["annotate-snippets", "clap"];

#[test]
fn libraries_depend_only_on_those_below_them() {
    let members = members();
    let ours: Vec<&str> = members.iter().map(|member| member.name.as_str()).collect();
    let mut wrong = BTreeMap::new();
    for library in members.iter().filter(|member| member.is_library()) {
        let Some((_, allowed)) = ALLOWED.iter().find(|(name, _)| *name == library.name) else {
            wrong.insert(
                library.name.clone(),
                "a library that ALLOWED in arrows.rs does not list".to_owned(),
            );
            continue;
        };
        for dependency in library.dependencies.iter().filter(|name| ours.contains(&name.as_str())) {
            if !allowed.contains(&dependency.as_str()) {
                wrong.insert(
                    format!("{} -> {dependency}", library.name),
                    format!("{} may depend on {}", library.name, allowed.join(", ")),
                );
            }
        }
    }
    forbid(
        "arrow",
        &wrong,
        "Move the code to where both can reach it, or pass in what is needed as an argument.",
    );
}

#[test]
fn nothing_depends_on_the_command() {
    let wrong = members()
        .iter()
        .filter(|member| member.dependencies.iter().any(|name| name == "iiwasim"))
        .map(|member| (member.name.clone(), "depends on iiwasim".to_owned()))
        .collect();
    forbid("command", &wrong, "Move what it needs into a library.");
}

#[test]
fn libraries_know_no_command_line() {
    let mut wrong = BTreeMap::new();
    for library in members().iter().filter(|member| member.is_library()) {
        for name in library.dependencies.iter().filter(|name| COMMAND_LINE.contains(&name.as_str()))
        {
            wrong.insert(format!("{} -> {name}", library.name), "for commands only".to_owned());
        }
    }
    forbid("command line", &wrong, "Parse arguments and draw errors in cli.");
}
