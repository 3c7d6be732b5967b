//! Accepted and rejected programs. `tests/peers` checks that the JSON Schema agrees.

use iiwa_program::{Program, Workcell};

use crate::documents::{
    Documents, fixtures, frame_programs, joint_programs, load_programs, repeat_programs,
    with_schema_key,
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

/// The orientation of an auxiliary position without one has no effect.
#[test]
fn an_auxiliary_position_needs_no_orientation() {
    let read = |aux: &str, keys: &str| {
        let frame =
            r#"{ "x_mm": 600, "y_mm": 0, "z_mm": 300, "a_deg": 0, "b_deg": 180, "c_deg": 0 }"#;
        Program::from_json(&format!(
            r#"{{ "version": 1, "start": {{ "joints_deg": [0, 30, 0, -60, 0, 90, 0] }},
                  "motions": [{{ "type": "circ", "aux": {aux}, "frame": {frame}{keys} }}] }}"#
        ))
    };
    let point = r#"{ "x_mm": 600, "y_mm": 40, "z_mm": 300 }"#;
    let frame = r#"{ "x_mm": 600, "y_mm": 40, "z_mm": 300, "a_deg": 0, "b_deg": 0, "c_deg": 0 }"#;
    let program = read(point, "").unwrap();
    let ignored = read(frame, r#", "aux_orientation": "ignore""#).unwrap();
    assert_eq!(program, ignored);
    assert_eq!(read(point, r#", "aux_orientation": "ignore""#).unwrap(), ignored);
    assert_ne!(read(frame, "").unwrap(), ignored);
    assert_eq!(Program::from_json(&program.to_json()).unwrap(), program);
    let error = read(point, r#", "aux_orientation": "interpolate""#).unwrap_err().to_string();
    assert!(error.contains("`interpolate`, which needs `a_deg`"), "{error}");
}

#[test]
fn a_byte_order_mark_is_skipped() {
    let marked = |text: &str| format!("\u{feff}{text}");
    let text = crate::documents::PROGRAM;
    let cell = marked(crate::documents::CELL);
    let program = Program::from_json_with(&marked(text), |_| Ok(cell.clone())).unwrap();
    assert_eq!(program, Program::from_json_with(text, |_| Ok(cell.clone())).unwrap());
    let plain = Workcell::from_json(crate::documents::CELL).unwrap();
    assert_eq!(Workcell::from_json(&cell).unwrap(), plain);
    let merged = Program::merged_json(&marked(text), &cell).unwrap();
    assert_eq!(Program::from_json(&merged).unwrap(), program);
    // Places are those that an editor shows.
    let error = Program::from_json(&marked("{ \"version\": 1, \"x\": 1 }")).unwrap_err();
    assert_eq!((error.place().line, error.place().column), (1, 17));
}

#[test]
fn refuses_programs_with_wrong_loads() {
    assert_read(load_programs());
    assert_read(repeat_programs());
}
