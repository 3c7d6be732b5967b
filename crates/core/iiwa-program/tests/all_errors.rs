//! All errors of a program at once.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_kin::Robot;
use iiwa_program::{Fault, MAX_ERRORS, MotionIndex, Program, ProgramError};
use serde_json::{Value, json};

use crate::documents::fixtures;

fn all_errors(text: &str) -> Vec<ProgramError> {
    Program::all_errors(text, Program::from_json(text).unwrap_err())
}

fn motions_of(errors: &[ProgramError]) -> Vec<usize> {
    errors.iter().filter_map(ProgramError::motion).map(MotionIndex::index).collect()
}

/// Motions of which each has exactly one error, syntactic or by its numbers.
fn wrong_motions() -> Vec<Value> {
    vec![
        json!({ "type": "fly" }),
        json!({ "joints_deg": [0, 0, 0, 0, 0, 0, 0] }),
        json!({ "type": "ptp", "joints_deg": [0, 0, 0] }),
        json!({ "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 0], "velocity_rel": 1.5 }),
        json!({ "type": "wait", "seconds": -1 }),
        json!({ "type": "lin", "frame": { "x_mm": 1 } }),
        json!(7),
    ]
}

/// Number of motions of an entry, written out.
fn length(entry: &Value) -> usize {
    let Some(count) = entry.get("count").and_then(Value::as_u64) else { return 1 };
    let motions = entry["motions"].as_array().unwrap().iter();
    usize::try_from(count).unwrap() * motions.map(length).sum::<usize>()
}

/// Each wrong motion between the motions of a valid program is reported, at its place, and nothing
/// else is.
#[test]
fn each_wrong_motion_is_reported() {
    let mut random = fastrand::Rng::with_seed(7);
    let mut programs = 0;
    for mut program in fixtures() {
        let Some(list) = program["motions"].as_array_mut() else { continue };
        programs += 1;
        let mut expected = Vec::new();
        for wrong in wrong_motions() {
            list.insert(random.usize(0..=list.len()), wrong);
        }
        let mut index = 0;
        for entry in list.iter() {
            if wrong_motions().contains(entry) {
                expected.push(index);
            }
            index += length(entry);
        }
        // A wrong motion next to a blend changes nothing for it; a wait does, as without the error.
        let text = serde_json::to_string_pretty(&program).unwrap();
        let errors = all_errors(&text);
        let by_blend = |error: &&ProgramError| {
            matches!(
                error,
                ProgramError::Fault {
                    fault: Fault::BlendBeforeWait { .. } | Fault::NothingToOverlap { .. },
                    ..
                }
            )
        };
        let others: Vec<_> = errors.iter().filter(|error| !by_blend(error)).cloned().collect();
        assert_eq!(motions_of(&others), expected, "{errors:#?}");
        let places: Vec<_> = errors.iter().map(|error| error.place().span.start).collect();
        assert!(places.is_sorted());
    }
    assert!(programs > 5);
}

#[test]
fn each_part_of_a_program_has_its_error() {
    let text = r#"{
  "version": 1,
  "tools": { "gripper": { "tcp": { "z": 120 } }, "pen": { "tcp": { "z_mm": 90 } } },
  "bases": { "table": { "x": 500 } },
  "frames": { "pick": { "x_mm": 400 }, "place": { "x_mm": "400" } },
  "start": { "joints_deg": [0, 0, 0] },
  "motions": [{ "type": "wait", "seconds": 1 }, { "type": "MoveJ" }]
}"#;
    let errors = all_errors(text);
    let lines: Vec<_> = errors.iter().map(|error| error.place().line).collect();
    assert_eq!(lines, [3, 4, 5, 5, 6, 7], "{errors:#?}");
    let message = errors[5].message();
    assert_eq!(message, "motion 2: unknown type `MoveJ`; did you mean `ptp`?");
    let message = errors[0].message();
    assert_eq!(message, "unknown key `z`; did you mean `z_mm`?");
}

#[test]
fn each_unknown_key_of_the_program_has_its_error() {
    let text = r#"{
  "versions": 1, "version": 1,
  "a \"quoted\" kéy" : { "versions": 1 },
  "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
  "frame": {},
  "motions": [{ "type": "movej" }]
}"#;
    let errors = all_errors(text);
    let messages: Vec<_> = errors.iter().map(ProgramError::message).collect();
    assert_eq!(messages[0], "unknown key `versions`; did you mean `version`?");
    assert!(messages[1].starts_with("unknown key `a \"quoted\" kéy`, expected one of"));
    assert_eq!(messages[2], "unknown key `frame`; did you mean `frames`?");
    assert_eq!(messages.len(), 4, "{messages:#?}");
    let places = errors.iter().map(|error| (error.place().line, error.place().column));
    assert_eq!(places.take(3).collect::<Vec<_>>(), [(2, 3), (3, 3), (5, 3)]);
}

/// The type of one part does not hide the errors of the others.
#[test]
fn a_part_of_another_type_hides_no_errors() {
    let text = r#"{ "version": 1, "tools": [], "bases": { "table": { "x": 500 } },
  "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
  "motions": [{ "type": "movej" }] }"#;
    let lines: Vec<_> = all_errors(text).iter().map(|error| error.place().line).collect();
    assert_eq!(lines, [1, 1, 3]);
}

/// The place of each error is found by reading the text again: the number is bounded.
#[test]
fn the_number_of_errors_is_bounded() {
    for motion in [r#"{ "type": "movej" }"#, r#"{ "type": "wait", "seconds": -1 }"#] {
        let motions = vec![motion; 100_000].join(",\n");
        let text = format!(
            r#"{{ "version": 1, "start": {{ "joints_deg": [0, 0, 0, 0, 0, 0, 0] }},
"motions": [{motions}] }}"#
        );
        let errors = all_errors(&text);
        assert_eq!(motions_of(&errors), (0..MAX_ERRORS).collect::<Vec<_>>());
    }
}

#[test]
fn text_that_is_not_json_has_one_error() {
    let comment = "{ \"version\": 1, // mine\n \"motions\": [{}] }";
    let errors = all_errors(comment);
    assert_eq!(errors.len(), 1);
    assert!(errors[0].message().starts_with("comments are not part of JSON"), "{errors:?}");
    let version = r#"{ "version": 2, "motions": [{}, {}] }"#;
    assert!(matches!(all_errors(version).as_slice(), [ProgramError::Version { .. }]));
}

#[test]
fn slips_get_a_suggestion() {
    let motion = |motion: &str| {
        let start = r#""start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] }"#;
        format!(r#"{{ "version": 1, {start}, "motions": [{motion}] }}"#)
    };
    for (wrong, meant) in [
        (motion(r#"{ "type": "ptp", "joints": [0, 0, 0, 0, 0, 0, 0] }"#), "`joints_deg`"),
        (motion(r#"{ "type": "move_l" }"#), "`lin`"),
        (motion(r#"{ "type": "MoveC" }"#), "`circ`"),
        (motion(r#"{ "type": "sleep", "seconds": 1 }"#), "`wait`"),
        (motion(r#"{ "type": "lin", "frame": { "x": 1 } }"#), "`x_mm`"),
        (
            motion(r#"{ "type": "wait", "seconds": 1 }"#)
                .replace("\"start\"", r#""tools": { "pen": { "mass_kg": 2 } }, "start""#),
            "`load.mass_kg`",
        ),
    ] {
        let error = Program::from_json(&wrong).unwrap_err().message();
        assert!(error.ends_with(&format!("; did you mean {meant}?")), "{error}");
    }
}

/// An unknown name is placed where it is written, which is not always the motion.
#[test]
fn names_are_placed_where_they_are_written() {
    let robot = Robot::lbr_iiwa_7_r800();
    let frame = r#""x_mm": 500, "y_mm": 0, "z_mm": 300, "a_deg": 180, "b_deg": 0, "c_deg": 180"#;
    let text = format!(
        r#"{{
  "version": 1,
  "tool": "gripper",
  "frames": {{ "pick": {{ {frame},
    "base": "tray" }},
    "far": {{ "x_mm": 2500, "y_mm": 0, "z_mm": 300, "a_deg": 180, "b_deg": 0, "c_deg": 180 }} }},
  "bases": {{ "table": {{ "x_mm": 0,
    "base": "floor" }} }},
  "start": {{ "joints_deg": [0, 30, 0, -60, 0, 90, 0] }},
  "motions": [
    {{ "type": "lin", "frame": "pick", "tool": "flange" }},
    {{ "type": "lin", "frame": {{ {frame}, "base": "table" }}, "tool": "flange" }},
    {{ "type": "lin", "frame": {{ {frame} }} }},
    {{ "type": "lin", "frame": "far", "tool": "flange" }},
    {{ "type": "lin", "frame": "pikc", "tool": "flange" }},
    {{ "type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 190, 0] }},
    {{ "type": "spline", "tool": "flange", "segments": [
      {{ "type": "spl", "frame": {{ {frame}, "base": "nowhere" }} }} ] }},
    {{ "type": "lin_rel", "offset": {{ "z_mm": 1 }}, "tool": "pen" }}
  ]
}}"#
    );
    let program = Program::from_json(&text).unwrap();
    let faults = program.faults(&robot);
    let lines: Vec<_> = faults.iter().map(|fault| fault.place_in(&text).line).collect();
    assert_eq!(lines, [5, 8, 3, 14, 15, 16, 18, 19], "{faults:#?}");
}

/// Of two bases with the same unknown parent, the one in use is at fault.
#[test]
fn bases_are_followed_from_the_motion() {
    let frame = r#""x_mm": 500, "y_mm": 0, "z_mm": 300, "a_deg": 180, "b_deg": 0, "c_deg": 180"#;
    let text = format!(
        r#"{{ "version": 1, "bases": {{
    "a": {{ "x_mm": 1, "base": "gone" }},
    "b": {{ "x_mm": 1, "base": "gone" }},
    "c": {{ "x_mm": 1, "base": "b" }} }},
  "start": {{ "joints_deg": [0, 30, 0, -60, 0, 90, 0] }},
  "motions": [
    {{ "type": "lin", "base": "c", "frame": {{ {frame} }} }},
    {{ "type": "lin", "base": "a", "frame": {{ {frame} }} }} ] }}"#
    );
    let faults = Program::from_json(&text).unwrap().faults(&Robot::default());
    let lines: Vec<_> = faults.iter().map(|fault| fault.place_in(&text).line).collect();
    assert_eq!(lines, [3, 2], "{faults:#?}");
}

/// Texts of the program are quoted as they are.
#[test]
fn quoted_texts_get_no_names() {
    let text = r#"{ "version": 1, "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
  "motions": [{ "type": "lin", "frame": "motion 1", "name": "n" }] }"#;
    let program = Program::from_json(text).unwrap();
    let fault = program.faults(&Robot::default()).remove(0);
    let message = program.sources.in_message(&fault.to_string());
    assert!(message.starts_with("motion 1 \"n\": unknown frame `motion 1`"), "{message}");
}

/// A program without faults of this kind is one whose single motions are reachable.
#[test]
fn fixtures_have_no_faults() {
    let mut count = 0;
    for document in fixtures() {
        let Ok(program) = Program::from_json(&document.to_string()) else { continue };
        let robot = program.robot.as_deref().and_then(Robot::built_in).unwrap_or_default();
        assert_eq!(program.faults(&program.with_flange(robot)), []);
        count += 1;
    }
    assert!(count > 5);
}

/// All missing keys of a frame are in one error, at the frame.
#[test]
fn all_missing_keys_of_a_frame_are_named_at_once() {
    let program = |frames: &str, motion: &str| {
        let text = format!(
            "{{ \"version\": 1, \"start\": {{ \"joints_deg\": [0, 0, 0, 0, 0, 0, 0] }},\n\
             \"frames\": {{ {frames} }},\n\"motions\": [\n{motion} ] }}"
        );
        Program::from_json(&text).unwrap_err().to_string()
    };
    let position = r#"{ "x_mm": 1, "y_mm": 2, "z_mm": 3 }"#;
    let lin = |frame: &str| format!("{{ \"type\": \"lin\", \"frame\": {frame} }}");
    let angles = "`a_deg`, `b_deg` and `c_deg` are missing, at line";
    assert_eq!(program("", &lin(position)), format!("motion 1: {angles} 4, column 27"));
    assert_eq!(
        program(&format!("\"pick\": {position}"), &lin("\"pick\"")),
        format!("`pick`: {angles} 2, column 21")
    );
    assert_eq!(
        program("", &lin(r#"{ "y_mm": 2, "a_deg": 0, "b_rad": 0 }"#)),
        "motion 1: `x_mm`, `z_mm` and `c_deg` are missing, at line 4, column 27"
    );
    assert_eq!(
        program("", &lin(r#"{ "x_mm": 1, "y_mm": 2, "z_mm": 3, "a_deg": 0, "b_rad": 0 }"#)),
        "motion 1: `c_deg` is missing, at line 4, column 27"
    );
}

/// A name or a key that appears twice is reported with both places.
#[test]
fn both_places_of_a_repeated_name_are_named() {
    let frame = r#"{ "x_mm": 1, "y_mm": 2, "z_mm": 3, "a_deg": 0, "b_deg": 0, "c_deg": 0 }"#;
    let tool = r#"{ "tcp": { "z_mm": 1 } }"#;
    let wait = r#"{ "type": "wait", "seconds": 1 }"#;
    for (entries, expected) in [
        (
            format!("\"frames\": {{ \"a\": {frame},\n\"b\": {frame},\n  \"a\": {frame} }},"),
            "the name `a` appears twice, first at line 2, column 13, at line 4, column 3",
        ),
        (
            format!("\"tools\": {{\n\"t\": {tool},\n  \"t\": {tool} }},"),
            "the name `t` appears twice, first at line 3, column 1, at line 4, column 3",
        ),
        (
            format!("\"tools\": {{ \"t\": {tool} }},\n\"tools\": {{ \"u\": {tool} }},"),
            "the key `tools` appears twice, first at line 2, column 1, at line 3, column 1",
        ),
        (
            "\"bases\": { \"t\": { \"x_mm\": 1,\n\"x_mm\": 2 } },".to_owned(),
            "the key `x_mm` appears twice, first at line 2, column 19, at line 3, column 1",
        ),
    ] {
        let text = format!(
            "{{ \"version\": 1, \"start\": {{ \"joints_deg\": [0, 0, 0, 0, 0, 0, 0] }},\n\
             {entries}\n\"motions\": [{wait}] }}"
        );
        assert_eq!(Program::from_json(&text).unwrap_err().to_string(), expected);
    }
    let text = format!(
        "{{ \"version\": 1, \"start\": {{ \"joints_deg\": [0, 0, 0, 0, 0, 0, 0] }},\n\
         \"motions\": [{wait},\n{{ \"type\": \"wait\", \"seconds\": 1, \"seconds\": 2 }}] }}"
    );
    assert_eq!(
        Program::from_json(&text).unwrap_err().to_string(),
        "motion 2: the key `seconds` appears twice, first at line 3, column 19, \
         at line 3, column 33"
    );
}
