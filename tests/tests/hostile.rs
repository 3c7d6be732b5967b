//! Programs in `fixtures/hostile` on which planners have failed. Each is planned with both time
//! parameterisations and judged at every instant, with [`iiwasim_tests::tolerances`]. Known
//! failures are listed: the list may only become shorter.

// Test helpers may panic.
#![allow(clippy::unwrap_used)]

use std::{collections::BTreeSet, fs};

use iiwa_program::Program;
use iiwasim_tests::{fixture, plan_check::PlanCheck};

/// Known failures of each program.
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
        let reported = [refusals, failures].concat();
        let known =
            KNOWN.iter().find(|(known, _)| *known == name).map_or(&[][..], |(_, defects)| defects);
        for defect in reported.iter().filter(|defect| !known.contains(&defect.as_str())) {
            wrong.push(format!("{name}: new: {defect}"));
        }
        for defect in known.iter().filter(|defect| reported.iter().all(|entry| entry != *defect)) {
            wrong.push(format!("{name}: mended, take it off the list: {defect}"));
        }
        names.insert(name);
    }
    let listed = KNOWN.iter().map(|(name, _)| name);
    wrong.extend(
        listed.filter(|name| !names.contains(**name)).map(|name| format!("{name}: no such file")),
    );
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
