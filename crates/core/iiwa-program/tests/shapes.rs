//! Shapes of payloads in programs.

// Test helpers may panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iiwa_program::{Fault, FlangeLoad, Load, LoadShape, Motion, MotionIndex, MotionList, Program};

const SHAPES: &str = r#"[
    { "type": "box", "center_mm": [0, 0, 130], "size_mm": [200, 60, 40], "rpy_deg": [0, 0, 45] },
    { "type": "cylinder", "center_mm": [0, 0, 60], "radius_mm": 20, "length_mm": 120 },
    { "type": "sphere", "center_mm": [10, 0, 60], "radius_mm": 25.5 },
    { "type": "mesh", "file": "parts/blank.STL", "origin_mm": [0, 0, 5], "scale": 1000 } ]"#;

fn program(motions: &str) -> String {
    format!(
        r#"{{ "version": 1,
  "tools": {{ "gripper": {{ "tcp": {{ "z_mm": 120 }}, "load": {{ "mass_kg": 1,
    "shapes": [{{ "type": "sphere", "center_mm": [0, 0, 40], "radius_mm": 30 }}] }} }},
    "pen": {{ "tcp": {{ "z_mm": 10 }}, "load": {{ "mass_kg": 0.1 }} }} }},
  "tool": "gripper", "start": {{ "joints_deg": [0, 30, 0, -60, 0, 90, 0] }},
  "motions": [{motions}] }}"#
    )
}

fn pick(shapes: &str) -> String {
    format!(r#"{{ "type": "load", "load": {{ "mass_kg": 2, "shapes": {shapes} }} }}"#)
}

const PTP: &str = r#"{ "type": "ptp", "joints_deg": [0, 50, 0, -60, 0, 90, 0] }"#;

#[test]
fn shapes_read_back() {
    let read = Program::from_json(&program(&pick(SHAPES))).unwrap();
    let Motion::Load(Some(payload)) = &read.motions[0] else { panic!("{:?}", read.motions[0]) };
    let [cuboid, _, _, mesh] = payload.shapes.as_slice() else { panic!("{payload:?}") };
    let expected = LoadShape::Box {
        center_mm: [0.0, 0.0, 130.0],
        size_mm: [200.0, 60.0, 40.0],
        rpy_deg: [0.0, 0.0, 45.0],
    };
    assert_eq!(*cuboid, expected);
    let expected = LoadShape::Mesh {
        file: "parts/blank.STL".into(),
        origin_mm: [0.0, 0.0, 5.0],
        rpy_deg: [0.0; 3],
        scale: 1000.0,
    };
    assert_eq!(*mesh, expected);
    assert_eq!(Program::from_json(&read.to_json()).unwrap(), read);
    let list = MotionList::from(read);
    let text = serde_json::to_string(&list).unwrap();
    assert_eq!(MotionList::from_json(&text).unwrap(), list);
}

/// Lists for robot programs, which refuse unknown keys: the load remains.
#[test]
fn lists_for_robot_programs_have_no_shapes() {
    let block =
        format!(r#"{{ "type": "repeat", "count": 2, "motions": [{}, {PTP}] }}"#, pick(SHAPES));
    let named = block.replace("\"type\": \"ptp\"", "\"type\": \"ptp\", \"name\": \"there\"");
    let list = MotionList::from(Program::from_json(&program(&named)).unwrap());
    let loads = list.clone().starting_at([0.0; 7]).loads();
    let bare = list.for_robot_program();
    let text = serde_json::to_string(&bare).unwrap();
    assert!(!["shapes", "name", "repeat"].iter().any(|key| text.contains(key)), "{text}");
    assert_eq!(bare.motions.len(), 4);
    assert_eq!(bare.starting_at([0.0; 7]).loads(), loads);
}

#[test]
fn invalid_shapes_are_refused_with_their_place() {
    for (from, to, message, span) in [
        (
            "\"radius_mm\": 25.5",
            "\"radius_mm\": 0",
            "shape 3 of the load: radius_mm is 0; it must",
            "0",
        ),
        ("[200, 60, 40]", "[200, 60, 0]", "shape 1 of the load: number 3 of size_mm is 0", "["),
        (
            ", \"radius_mm\": 25.5",
            "",
            "shape 3 of the load: the key `radius_mm` of a sphere",
            "\"s",
        ),
        (
            "\"radius_mm\": 25.5",
            "\"length_mm\": 25.5",
            "`length_mm` is not a key of a sphere",
            "25",
        ),
        ("\"sphere\"", "\"ball\"", "`ball`", "\"ball\""),
        ("\"size_mm\"", "\"sizes_mm\"", "unknown key `sizes_mm`", "\"sizes_mm\""),
        ("[0, 0, 130]", "null", "found null", "null"),
        ("[0, 0, 45]", "[0, 0, 450]", "number 3 of rpy_deg is 450; it must be from -360", "["),
        ("blank.STL", "blank.step", "a mesh is a file *.stl or *.obj", "\"parts"),
        ("\"scale\": 1000", "\"scale\": 0", "scale is 0; it must be from 0.000001", "0"),
    ] {
        let text = program(&pick(&SHAPES.replacen(from, to, 1)));
        let error = Program::from_json(&text).unwrap_err();
        assert!(error.message().starts_with("motion 1: "), "{error}");
        assert!(error.message().contains(message), "{error}");
        assert!(text[error.place().span.clone()].starts_with(span), "{error}");
        let all = Program::all_errors(&text, error.clone());
        assert_eq!((all.len(), all[0].to_string()), (1, error.to_string()));
    }
    let text = program(&pick(SHAPES).replace("\"mass_kg\": 2", "\"mass_kg\": 0"));
    let error = Program::from_json(&text).unwrap_err();
    assert!(
        error.message().contains("a load without mass has no shapes: state its mass"),
        "{error}"
    );
    let text = program(PTP).replace("\"radius_mm\": 30", "\"radius_mm\": -3");
    let error = Program::from_json(&text).unwrap_err();
    assert!(error.message().contains("`gripper`: shape 1 of the load: radius_mm is -3"), "{error}");
    let sphere = LoadShape::Sphere { center_mm: [f64::NAN; 3], radius_mm: 1.0 };
    let payload =
        FlangeLoad { load: Load { mass_kg: 1.0, ..Load::default() }, shapes: vec![sphere] };
    let program = Program::from_deg([0.0; 7]).motion(Motion::Load(Some(payload))).build();
    let fault = program.check_numbers().unwrap_err();
    assert!(matches!(fault, Fault::Shape { .. }) && !fault.is_of_the_arm(), "{fault}");
    assert_eq!(fault.motion(), Some(MotionIndex::new(0)));
}

#[test]
fn a_workpiece_is_carried_until_the_next_change() {
    let pen = r#"{ "type": "lin_rel", "offset": { "z_mm": -5 }, "tool": "pen" }"#;
    let gone = r#"{ "type": "load", "load": null }"#;
    let bare = r#"{ "type": "load", "load": { "mass_kg": 3 } }"#;
    let wait = r#"{ "type": "wait", "seconds": 1 }"#;
    let motions = [PTP, &pick(SHAPES), wait, PTP, pen, wait, gone, PTP, &pick(SHAPES), bare];
    let program = Program::from_json(&program(&motions.join(", "))).unwrap();
    let shapes = program.carried_shapes();
    let counts = shapes.iter().map(|it| [it.tool.shapes.len(), it.workpiece.shapes.len()]);
    let expected = [[1, 0], [1, 4], [1, 4], [1, 4], [0, 4], [0, 4], [1, 0], [1, 0], [1, 4], [1, 0]];
    assert_eq!(counts.collect::<Vec<_>>(), expected);
    assert_eq!((shapes[3].workpiece.motion, shapes[3].tool.tool), (Some(1), Some("gripper")));
}
