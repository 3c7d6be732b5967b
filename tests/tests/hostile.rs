//! Programs in `fixtures/hostile` on which planners have failed. Each is planned with either timing and judged
//! at every instant, by the bars of [`iiwasim_tests::bars`]. What is known to be wrong is listed: the list can only
//! become shorter.

// Helpers of tests may fail.
#![allow(clippy::unwrap_used)]

use std::{collections::BTreeSet, fs};

use iiwa_program::Program;
use iiwasim_tests::{fixture, plan_check::PlanCheck};

/// What is wrong with each program, as far as it is known.
const KNOWN: [(&str, &[&str]); 0] = [];

#[test]
fn hostile_programs_fail_only_as_is_known() {
    let mut names = BTreeSet::new();
    let mut wrong = Vec::new();
    for entry in fs::read_dir(fixture("hostile")).unwrap() {
        let file = entry.unwrap().path();
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        let program = Program::from_json(&fs::read_to_string(&file).unwrap()).unwrap();
        let PlanCheck { refusals, failures, .. } = PlanCheck::of(&program);
        let found = [refusals, failures].concat();
        let known =
            KNOWN.iter().find(|(known, _)| *known == name).map_or(&[][..], |(_, what)| what);
        for what in found.iter().filter(|what| !known.contains(&what.as_str())) {
            wrong.push(format!("{name}: new: {what}"));
        }
        for what in known.iter().filter(|what| found.iter().all(|found| found != *what)) {
            wrong.push(format!("{name}: mended, take it off the list: {what}"));
        }
        names.insert(name);
    }
    let listed = KNOWN.iter().map(|(name, _)| name);
    wrong.extend(
        listed.filter(|name| !names.contains(**name)).map(|name| format!("{name}: no such file")),
    );
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
