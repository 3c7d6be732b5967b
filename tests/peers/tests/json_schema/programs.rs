//! Programs, and files of tools, bases and frames.

#[path = "../../../../crates/core/iiwa-program/tests/documents.rs"]
mod documents;

use iiwa_program::{Program, Workcell};
use serde_json::Value;

use super::{assert_fits, validator};
use documents::{
    CELL, Documents, PROGRAM, bad_cells, fixtures, frame_programs, joint_programs, load_programs,
    repeat_programs, with_schema_key,
};

fn value(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn takes_all_fixtures() {
    let schema = validator(&Program::schema());
    for program in fixtures() {
        assert_fits(&schema, &program);
    }
}

#[test]
fn files_may_name_their_schema() {
    let [program, cell] = with_schema_key();
    assert_fits(&validator(&Program::schema()), &program);
    assert_fits(&validator(&Workcell::schema()), &cell);
}

fn assert_agrees(documents: Documents) {
    let schema = validator(&Program::schema());
    for good in documents.odd.iter().chain([&documents.good]) {
        assert_fits(&schema, good);
    }
    for bad in documents.bad {
        assert!(!schema.is_valid(&bad), "the schema takes {bad}");
    }
}

#[test]
fn refuses_programs_with_wrong_joints() {
    assert_agrees(joint_programs());
}

#[test]
fn refuses_programs_with_wrong_frames() {
    assert_agrees(frame_programs());
}

#[test]
fn refuses_programs_with_wrong_loads() {
    assert_agrees(load_programs());
    assert_agrees(repeat_programs());
}

#[test]
fn files_of_frames_agree() {
    let [program, frames] = [Program::schema(), Workcell::schema()].map(|it| validator(&it));
    assert_fits(&program, &value(PROGRAM));
    assert!(!program.is_valid(&value(&PROGRAM.replace("\"cell.json\"", "7"))));
    assert_fits(&frames, &value(CELL));
    assert_fits(&frames, &value(&Workcell::from_json(CELL).unwrap().to_json()));
    for bad in bad_cells() {
        assert!(!frames.is_valid(&bad), "the schema takes {bad}");
    }
}

/// A program with a wait after two motions.
fn with_wait(wait: &str, more: &str) -> String {
    format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": [0, 0, 0, 0, 0, 0, 0] }}, "motions": [
            {{ "type": "ptp", "joints_deg": [10, 0, 0, 0, 0, 0, 0],
               "blend": {{ "fraction": 0.2 }} }},
            {{ "type": "ptp", "joints_deg": [15, 0, 0, 0, 0, 0, 0],
               "blend": {{ "fraction": 0.2 }} }},
            {{ "type": "wait", "seconds": 0.5, {wait} }},
            {{ "type": "ptp", "joints_deg": [20, 0, 0, 9, 0, 0, 0]{more} ] }}"#
    )
}

#[test]
fn waits_and_sources_fit_when_they_are_written() {
    let text = with_wait(
        r#""overlap_motions": 2, "source": { "file": "A.java", "line": 7 }"#,
        r#", "source": { "file": "A.java", "line": 1 } },
           { "type": "wait", "seconds": 0.25, "overlap": true },
           { "type": "load", "load": null, "source": { "file": "B.java", "line": 8 } },
           { "type": "lin_rel", "offset": { "z_mm": 5 },
             "source": { "file": "A.java", "line": 9 } }"#,
    );
    let program = Program::from_json(&text).unwrap();
    assert_eq!(program.sources.iter().count(), 4);
    assert_fits(&validator(&Program::schema()), &value(&program.to_json()));
}

#[test]
fn bounds_of_names_and_comments_agree() {
    let schema = validator(&Program::schema());
    let long = "ö".repeat(201);
    let texts = ["", "a name", "ö", "a\\nb", "a\\rb", "a\\tb", "a\\u0000b", "a\\u0085b", &long];
    for key in ["name", "comment", "group"] {
        for text in texts {
            let program = with_wait(&format!(r#""overlap": true, "{key}": "{text}""#), " }");
            let is_valid = schema.is_valid(&value(&program));
            assert_eq!(Program::from_json(&program).is_ok(), is_valid, "{key}: {text:?}");
        }
        let number = with_wait(&format!(r#""overlap": true, "{key}": 7"#), " }");
        assert!(!schema.is_valid(&value(&number)) && Program::from_json(&number).is_err());
    }
}

#[test]
fn a_wait_has_one_of_both_keys() {
    let schema = validator(&Program::schema());
    let both = value(&with_wait(r#""overlap": true, "overlap_motions": 2"#, " }"));
    assert!(!schema.is_valid(&both));
    assert_fits(&schema, &value(&with_wait(r#""overlap_motions": 2"#, " }")));
}
