//! Accepted and rejected programs. `tests/peers` checks that the JSON Schema agrees.

use iiwa_program::{Program, Workcell};

use crate::documents::{
    Documents, fixtures, frame_programs, joint_programs, load_programs, with_schema_key,
};

#[test]
fn takes_all_fixtures() {
    for program in fixtures() {
        Program::from_json(&program.to_string()).unwrap();
    }
}

/// Editors bind a schema to a file by this key.
#[test]
fn files_may_name_their_schema() {
    let [program, cell] = with_schema_key().map(|file| file.to_string());
    Program::from_json(&program).unwrap();
    assert!(Workcell::from_json(&cell).unwrap().is_empty());
}

fn assert_read(documents: Documents) {
    for good in documents.odd.iter().chain([&documents.good]) {
        let read = Program::from_json(&good.to_string());
        assert!(read.is_ok(), "{read:?}: {good}");
    }
    for bad in documents.bad {
        assert!(Program::from_json(&bad.to_string()).is_err(), "the reader takes {bad}");
    }
}

#[test]
fn refuses_programs_with_wrong_joints() {
    assert_read(joint_programs());
}

#[test]
fn refuses_programs_with_wrong_frames() {
    assert_read(frame_programs());
}

#[test]
fn refuses_programs_with_wrong_loads() {
    assert_read(load_programs());
}
