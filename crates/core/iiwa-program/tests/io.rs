//! Inputs and outputs: reading and writing JSON, and rejected programs.

// Test helpers may panic.
#![allow(clippy::unwrap_used)]

use iiwa_program::{
    Blend, Fault, IoEntry, IoKind, IoValue, MAX_IO_NAME, Motion, MotionIndex, MotionList,
    MotionType, Program, ProgramError, Ptp,
};
use serde_json::{Value, json};

const FIRST: &str =
    r#"{ "type": "ptp", "joints_deg": [10, 0, 0, 0, 0, 0, 0], "blend": { "fraction": 0.2 } }"#;
const NEXT: &str = r#"{ "type": "ptp", "joints_deg": [20, 0, 0, 9, 0, 0, 0] }"#;
const SET: &str = r#"{ "type": "set", "io": "Gripper.Close", "value": true }"#;
const WAIT: &str =
    r#"{ "type": "wait_for", "io": "Gripper.Closed", "value": true, "seconds": 0.4 }"#;

fn text(motions: &[&str]) -> String {
    let motions = motions.join(",\n");
    format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": [0, 0, 0, 0, 0, 0, 0] }}, "motions": [
{motions} ] }}"#
    )
}

fn refused(motions: &[&str]) -> String {
    let text = text(motions);
    let error = Program::from_json(&text).unwrap_err();
    format!("{} | {}", error.message(), &text[error.place().span.clone()])
}

#[test]
fn inputs_and_outputs_read_back() {
    let labelled = r#"{ "type": "set", "io": "Lamp.Colour", "value": -3, "overlap_motions": 2,
        "name": "lamp", "comment": "amber", "group": "pick",
        "source": { "file": "Pick.java", "line": 12 } }"#;
    let overlapping = r#"{ "type": "wait_for", "io": "Belt.Speed", "value": 0.5, "seconds": 1,
        "overlap": true }"#;
    let program =
        Program::from_json(&text(&[NEXT, SET, WAIT, FIRST, NEXT, labelled, overlapping])).unwrap();
    assert_eq!(
        program.motions[1],
        Motion::Io(IoEntry::set("Gripper.Close", IoValue::Boolean(true)))
    );
    assert_eq!(
        program.motions[2],
        Motion::Io(IoEntry::wait_for("Gripper.Closed", IoValue::Boolean(true), 0.4))
    );
    let lamp = program.motions[5].io().unwrap();
    let expected = (IoValue::Analog(-3.0), IoKind::Set, 2);
    assert_eq!((lamp.value, lamp.kind, lamp.overlap), expected);
    assert_eq!(program.sources.label(MotionIndex::new(5)).unwrap().group.as_deref(), Some("pick"));
    assert_eq!(
        program.motions.iter().map(Motion::wait_s).collect::<Vec<_>>(),
        [None, Some(0.0), Some(0.4), None, None, Some(0.0), Some(1.0)]
    );
    let overlaps = program.overlapping_waits();
    let overlaps: Vec<_> =
        overlaps.iter().map(|wait| (wait.motion.index(), wait.since.index())).collect();
    assert_eq!(overlaps, [(5, 3), (6, 4)]);
    for (index, name) in [(1, "set"), (2, "wait_for")] {
        let motion_type = program.motions[index].motion_type();
        assert_eq!(motion_type.name(), name);
        assert_eq!(MotionType::from_name(name), Some(motion_type));
        assert!(!motion_type.moves() && !motion_type.is_cartesian());
    }

    let json = program.to_json();
    assert_eq!(Program::from_json(&json).unwrap(), program);
    let written: Value = serde_json::from_str(&json).unwrap();
    let set = json!({ "type": "set", "io": "Gripper.Close", "value": true });
    assert_eq!(written["motions"][1], set);
    assert_eq!(written["motions"][6]["overlap"], true);
    let list = MotionList::from(program);
    let json = serde_json::to_string(&list).unwrap();
    assert_eq!(MotionList::from_json(&json).unwrap(), list);
}

#[test]
fn numbers_keep_their_kind() {
    for (value, expected) in [
        ("false", IoValue::Boolean(false)),
        ("7", IoValue::Digital(7)),
        ("7.0", IoValue::Analog(7.0)),
        ("-7", IoValue::Analog(-7.0)),
        ("1e-9", IoValue::Analog(1e-9)),
    ] {
        let set = SET.replace("true", value);
        let program = Program::from_json(&text(&[&set])).unwrap();
        assert_eq!(program.motions[0].io().unwrap().value, expected, "{value}");
        assert_eq!(Program::from_json(&program.to_json()).unwrap(), program, "{value}");
    }
}

#[test]
fn wrong_names_and_values_are_refused_with_their_place() {
    let long = SET.replace("Gripper.Close", &"x".repeat(MAX_IO_NAME + 1));
    for (motion, expected) in [
        (SET.replace("Gripper.Close", ""), "motion 1: `io` is empty; give the name of an input or"),
        (SET.replace("Gripper.Close", " G.C"), "motion 1: `io` begins or ends with a space"),
        (SET.replace("Gripper.Close", "G\\u0007"), "motion 1: `io` contains the control character"),
        (long, "motion 1: `io` has 201 characters; at most 200 are allowed"),
        (SET.replace("\"Gripper.Close\"", "7"), "motion 1: expected a string, found `7`"),
        (
            SET.replace("true", "\"on\""),
            "motion 1: expected true, false or a number, found string \"on\"",
        ),
        (SET.replace("true", "null"), "motion 1: expected true, false or a number, found null"),
        (SET.replace("true", "1e999"), "motion 1: the number is too large"),
        (SET.replace(", \"value\": true", ""), "motion 1: the key `value` is missing"),
        (SET.replace("\"io\": \"Gripper.Close\", ", ""), "motion 1: the key `io` is missing"),
        (WAIT.replace(", \"seconds\": 0.4", ""), "motion 1: the key `seconds` is missing"),
        (WAIT.replace("0.4", "-0.4"), "motion 1: a wait of -0.4 s; it must be from 0 to 86400 s"),
        (SET.replace("\"value\"", "\"values\""), "did you mean `value`?"),
        (WAIT.replace("\"seconds\"", "\"second\""), "did you mean `seconds`?"),
        (SET.replace("\"set\"", "\"Set\""), "did you mean `set`?"),
        (SET.replace("\"set\"", "\"setDO\""), "did you mean `set`?"),
        (WAIT.replace("wait_for", "waitDI"), "did you mean `wait_for`?"),
        (SET.replace("true", "true, \"seconds\": 1"), "unknown key `seconds`"),
    ] {
        let found = refused(&[&motion]);
        assert!(found.contains(expected), "{motion}: {found}");
    }
    assert!(refused(&[&SET.replace("true", "\"on\"")]).ends_with("| \"on\""));
    assert!(refused(&[&SET.replace("Gripper.Close", "")]).ends_with("| \"\""));
    let nan = Program::from_deg([0.0; 7])
        .motion(Motion::Io(IoEntry::set("A.B", IoValue::Analog(f64::NAN))))
        .build();
    let fault = nan.check_numbers().unwrap_err();
    assert_eq!(fault.to_string(), "motion 1: `value` is NaN; give true, false or a number");
}

#[test]
fn all_errors_are_reported_at_once() {
    let wrong = [SET.replace("true", "\"on\""), WAIT.replace("0.4", "-1"), SET.replace("io", "oi")];
    let text = text(&[&wrong[0], &wrong[1], SET, &wrong[2]]);
    let first = Program::from_json(&text).unwrap_err();
    let errors = Program::all_errors(&text, first);
    let motions: Vec<_> = errors.iter().filter_map(ProgramError::motion).collect();
    assert_eq!(motions, [0, 1, 3].map(MotionIndex::new));
}

#[test]
fn the_robot_is_at_rest_unless_the_entry_overlaps_a_motion() {
    let found = refused(&[FIRST, SET, NEXT]);
    assert!(found.starts_with("motion 1 is followed by `set`, for which the arm stops"), "{found}");
    assert!(found.contains("or give `set` the key \"overlap\": true"), "{found}");
    assert!(refused(&[FIRST, WAIT, NEXT]).contains("followed by `wait_for`"));
    let overlapping = SET.replace("true", "true, \"overlap\": true");
    let program = Program::from_json(&text(&[FIRST, &overlapping, NEXT])).unwrap();
    assert_eq!(program.blend_into(MotionIndex::new(2)), Some(MotionIndex::new(0)));
    // An entry at rest stops the robot.
    let found = refused(&[NEXT, SET, &overlapping]);
    assert!(found.starts_with("motion 3 overlaps a motion, but no motion precedes it"), "{found}");
    assert!(found.ends_with("| true"), "{found}");
    let both = SET.replace("true", "true, \"overlap\": true, \"overlap_motions\": 2");
    assert!(refused(&[FIRST, &both, NEXT]).contains("give either `overlap` or `overlap_motions`"));

    let blended = Ptp::to([0.1; 7]).blend(Blend::Fraction(0.2));
    let program = Program::from_deg([0.0; 7])
        .motion(Motion::Ptp(blended))
        .motion(Motion::Io(IoEntry::set("A.B", IoValue::Digital(1))))
        .build();
    let fault = program.check_numbers().unwrap_err();
    assert_eq!(fault, Fault::BlendBeforeIo { motion: MotionIndex::new(0), next: "set" });
}

#[test]
fn the_schema_describes_both_entries() {
    let schema = Program::schema();
    let definitions = &schema["$defs"];
    assert_eq!(definitions["Set"]["properties"]["value"]["type"], json!(["boolean", "number"]));
    assert_eq!(definitions["Set"]["properties"]["io"]["maxLength"], MAX_IO_NAME);
    assert_eq!(definitions["WaitFor"]["required"], json!(["type", "io", "value", "seconds"]));
}
