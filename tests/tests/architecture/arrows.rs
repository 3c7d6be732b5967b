//! Allowed dependencies between crates.

use std::collections::{BTreeMap, BTreeSet};

use crate::tests::architecture::offenders::forbid;
use crate::tests::architecture::sources::{members, root, text};

/// Returns the arrows in ARCHITECTURE.md, each from a crate to one that uses it. `tests/arrows.py`
/// draws the dependencies of Cargo: adding a dependency requires renewing the drawing, which shows
/// its consequences.
fn drawn() -> BTreeMap<String, Vec<String>> {
    let text = text(&root().join("ARCHITECTURE.md"));
    let mut arrows = BTreeMap::<_, Vec<_>>::new();
    for line in text.lines() {
        if let Some((used, user)) = line.trim().split_once(" --> ") {
            arrows.entry(user.to_owned()).or_default().push(used.to_owned());
        }
    }
    arrows
}

/// Returns all crates from which arrows lead to a crate.
fn below(arrows: &BTreeMap<String, Vec<String>>, name: &str) -> BTreeSet<String> {
    let mut result = BTreeSet::new();
    let mut open = vec![name];
    while let Some(name) = open.pop() {
        for used in arrows.get(name).into_iter().flatten() {
            if result.insert(used.clone()) {
                open.push(used);
            }
        }
    }
    result
}

/// Crates for command lines, which libraries must not use.
const COMMAND_LINE: [&str; 2] = ["annotate-snippets", "clap"];

#[test]
fn libraries_depend_only_on_those_below_them() {
    let arrows = drawn();
    let mut wrong = BTreeMap::new();
    // The facade re-exports all of them.
    for library in members().iter().filter(|member| member.is_library() && member.name != "iiwa") {
        let short = |name: &str| name.strip_prefix("iiwa-").map(str::to_owned);
        let below = below(&arrows, &short(&library.name).unwrap_or_default());
        for dependency in library.dependencies.iter().filter_map(|name| short(name)) {
            if !below.contains(&dependency) {
                wrong.insert(
                    format!("iiwa-{dependency} --> {}", library.name),
                    "ARCHITECTURE.md draws no such arrow".to_owned(),
                );
            }
        }
    }
    forbid(
        "arrow",
        &wrong,
        "Move the code to where both can reach it, or draw the arrow: tests/arrows.py --renew.",
    );
}

#[test]
fn no_arrow_goes_back() {
    let arrows = drawn();
    let wrong = arrows
        .keys()
        .filter(|name| below(&arrows, name).contains(*name))
        .map(|name| (name.clone(), "leads back to itself".to_owned()))
        .collect();
    forbid("circle", &wrong, "Data flows one way.");
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
