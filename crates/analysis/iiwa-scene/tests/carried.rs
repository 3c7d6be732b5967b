//! Shapes that a program carries at the flange.

// Test helpers may panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::{MotionIndex, Program};
use iiwa_scene::{ArmInScene, CarriedBodies, Form, IgnoredPair, Obstacle, Other, Scene};
use iiwa_traj::{Timing, Trajectory};

/// Arm stretched out upwards, which rotates about its vertical axis only.
const UP: &str = "[0, 0, 0, 0, 0, 0, 0]";

fn no_files(_: &str) -> Result<Vec<u8>, String> {
    Err("there are no files".to_owned())
}

fn planned(program: &Program) -> Trajectory {
    let path = JointPath::new(program, &Robot::default()).unwrap();
    Trajectory::plan(&path, Timing::default()).unwrap()
}

/// Program with a motion before a load change, one with the workpiece, and one after its release.
fn program(shapes: &str) -> Program {
    let ptp = |a7: i32| format!(r#"{{ "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, {a7}] }}"#);
    let text = format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": {UP} }}, "motions": [ {},
            {{ "type": "load", "load": {{ "mass_kg": 1, "shapes": {shapes} }} }}, {},
            {{ "type": "wait", "seconds": 0.5 }},
            {{ "type": "load", "load": {{ "mass_kg": 0 }} }}, {} ] }}"#,
        ptp(20),
        ptp(40),
        ptp(60)
    );
    Program::from_json(&text).unwrap()
}

fn ceiling(height_m: f64) -> Scene {
    let form = Form::Plane { point_m: [0.0, 0.0, height_m], normal: [0.0, 0.0, -1.0] };
    Scene::new(vec![Obstacle { name: "ceiling".to_owned(), form }]).unwrap()
}

/// A rod of 200 mm points upwards from the flange: the clearance from the ceiling is 200 mm smaller
/// while the arm carries it.
#[test]
fn a_workpiece_counts_between_pick_up_and_release() {
    let robot = Robot::default();
    let [_, _, flange_m] = robot.flange_position(&[0.0; 7]);
    let rod = r#"[{ "type": "cylinder", "center_mm": [0, 0, 100], "radius_mm": 10,
                    "length_mm": 200 }]"#;
    let program = program(rod);
    let carried = CarriedBodies::new(&program, no_files).unwrap();
    let arm = ArmInScene::new(&robot, &ceiling(flange_m + 0.3));
    let plan = planned(&program);
    let bare = arm.clearance_of(&plan).unwrap();
    let arm = arm.carrying(&carried);
    let loaded = arm.clearance_of(&plan).unwrap();
    assert_eq!((bare.clearance.link, loaded.clearance.link), (7, 9));
    assert!((loaded.clearance.distance_m - 0.1).abs() < 1e-9, "{loaded:?}");
    assert_eq!(loaded.motion.number(), 3);

    let each: Vec<_> = plan.sections().iter().flat_map(|it| arm.clearances(it)).collect();
    let distances = each.iter().map(|it| (it.motion.number(), it.clearance.distance_m));
    for (motion, distance_m) in distances {
        let expected_m = if (3..=4).contains(&motion) { 0.1 } else { bare.clearance.distance_m };
        assert!((distance_m - expected_m).abs() < 1e-9, "motion {motion}: {distance_m}");
    }
    let during = |number: usize| {
        let clearance = arm.clearance_during(MotionIndex::new(number - 1), &[0.0; 7]).unwrap();
        (clearance.link, (1e6 * clearance.distance_m).round())
    };
    assert_eq!((during(3), during(2)), ((9, 1e5), (9, 1e5)));
    assert_eq!((during(1).0, during(5).0), (7, 7));
    // Without a motion, nothing is carried.
    assert_eq!(arm.clearance(&[0.0; 7]).unwrap().link, 7);
    assert_eq!(arm.name_of(Other::Link(9)), "the workpiece");

    let ignored = vec![IgnoredPair { link: 9, obstacle: 0 }];
    let scene = ceiling(flange_m + 0.3).with_ignored(ignored).unwrap();
    let arm = ArmInScene::new(&robot, &scene).carrying(&carried);
    assert_eq!(arm.clearance_of(&plan).unwrap().clearance.link, 7);
}

/// The load of a tool adds the tool's shapes, also while it carries a workpiece.
#[test]
fn a_tool_keeps_its_shapes_with_a_workpiece() {
    let robot = Robot::default();
    let [_, _, flange_m] = robot.flange_position(&[0.0; 7]);
    let text = format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": {UP} }}, "tool": "gripper",
        "tools": {{ "gripper": {{ "tcp": {{ "z_mm": 150 }}, "load": {{ "mass_kg": 1, "shapes":
            [{{ "type": "box", "center_mm": [0, 0, 75], "size_mm": [40, 40, 150] }}] }} }} }},
        "motions": [ {{ "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 20] }},
            {{ "type": "load", "load": {{ "mass_kg": 2, "shapes":
                [{{ "type": "sphere", "center_mm": [0, 0, 60], "radius_mm": 50 }}] }} }},
            {{ "type": "ptp", "joints_deg": {UP} }} ] }}"#
    );
    let program = Program::from_json(&text).unwrap();
    let carried = CarriedBodies::new(&program, no_files).unwrap();
    assert_eq!(carried.bodies().len(), 2);
    let during = |number: usize| carried.during(MotionIndex::new(number - 1)).count();
    assert_eq!([1, 2, 3, 4].map(during), [1, 2, 2, 0]);
    let arm = ArmInScene::new(&robot, &ceiling(flange_m + 0.2)).carrying(&carried);
    for number in [1, 3] {
        let clearance = arm.clearance_during(MotionIndex::new(number - 1), &[0.0; 7]).unwrap();
        assert!((clearance.distance_m - 0.05).abs() < 1e-9 && clearance.link == 8, "{clearance:?}");
    }
    let drawn = serde_json::to_value(&carried).unwrap();
    assert_eq!(drawn["bodies"][1]["part"], 9);
    assert_eq!(carried.changes().map(MotionIndex::number).collect::<Vec<_>>(), [1, 2]);
}

/// A long workpiece can touch the base; the tool that holds it and the wrist do not count.
#[test]
fn a_workpiece_keeps_clear_of_the_arm() {
    let robot = Robot::default();
    let folded = [0.0, 0.5, 0.0, -1.9, 0.0, 1.6, 0.0];
    let rod = |length_mm: u32| {
        let center_mm = length_mm / 2;
        program(&format!(
            r#"[{{ "type": "cylinder", "center_mm": [0, 0, {center_mm}], "radius_mm": 10,
                   "length_mm": {length_mm} }}]"#
        ))
    };
    let empty = Scene::new(Vec::new()).unwrap();
    let arm = ArmInScene::new(&robot, &empty);
    let distance = |program: &Program| {
        let arm = arm.carrying(&CarriedBodies::new(program, no_files).unwrap());
        arm.self_clearance_during(MotionIndex::new(2), &folded).unwrap()
    };
    let bare = arm.self_clearance(&folded).unwrap();
    let [short, long] = [20, 400].map(|length_mm| distance(&rod(length_mm)));
    // The wrist, on which the arm carries the workpiece, does not count.
    assert!(short.distance_m > 0.05, "{short:?}");
    assert!(long.link == 9 && long.distance_m < bare.distance_m, "{long:?}, {bare:?}");
    let Other::Link(other) = long.other else { panic!("{long:?}") };
    assert!(other <= 5, "{long:?}");
}

/// Program with these entries, which starts stretched out upwards.
fn program_of(entries: &str) -> Program {
    let text = format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": {UP} }}, "motions": [ {entries} ] }}"#
    );
    Program::from_json(&text).unwrap()
}

const TURN: &str = r#"{ "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 20] }"#;
const BACK: &str = r#"{ "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 0] }"#;
const SET: &str = r#"{ "type": "set", "io": "gripper", "value": true }"#;
const RELEASE: &str = r#"{ "type": "load", "load": null }"#;
const ROD: &str = r#"{ "type": "load", "load": { "mass_kg": 1, "shapes": [{ "type": "cylinder",
    "center_mm": [0, 0, 100], "radius_mm": 10, "length_mm": 200 }] } }"#;

/// The rod counts at any rest, also without a motion before its release or the end of the program.
#[test]
fn load_changes_count_without_motions() {
    let robot = Robot::default();
    let [_, _, flange_m] = robot.flange_position(&[0.0; 7]);
    let arm = ArmInScene::new(&robot, &ceiling(flange_m + 0.3));
    for (entries, motion) in [
        ([TURN, BACK, ROD].join(","), 3),
        ([TURN, ROD, SET, RELEASE, BACK].join(","), 2),
        ([ROD, SET, RELEASE, TURN].join(","), 1),
        ([TURN, ROD, RELEASE].join(","), 2),
        // A motion to the same position.
        ([TURN, ROD, TURN, RELEASE, BACK].join(","), 3),
    ] {
        let program = program_of(&entries);
        let arm = arm.carrying(&CarriedBodies::new(&program, no_files).unwrap());
        let nearest = arm.clearance_of(&planned(&program)).unwrap();
        assert_eq!((nearest.clearance.link, nearest.motion.number()), (9, motion), "{entries}");
        assert!((nearest.clearance.distance_m - 0.1).abs() < 1e-9, "{nearest:?}");
    }
}

/// Rounds of a repeat block share their bodies, and shapes share the hulls of meshes.
#[test]
fn equal_shapes_are_one_body() {
    let wedge = "v 0 0 0\nv 60 0 0\nv 0 40 0\nv 0 0 200\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    let load = |x_mm: u32, file: &str| {
        format!(
            r#"{{ "type": "load", "load": {{ "mass_kg": 1, "shapes":
                [{{ "type": "mesh", "file": "{file}", "origin_mm": [{x_mm}, 0, 0] }}] }} }}"#
        )
    };
    let round = [&load(0, "a.obj"), TURN, &load(10, "a.obj"), BACK, &load(0, "b.obj"), TURN];
    let round = round.join(",");
    let program = program_of(&format!(
        r#"{BACK}, {{ "type": "repeat", "count": 50, "motions": [ {round} ] }}, {RELEASE}"#
    ));
    let mut reads = Vec::new();
    let carried = CarriedBodies::new(&program, |name| {
        reads.push(name.to_owned());
        Ok(wedge.into())
    });
    let carried = carried.unwrap();
    assert_eq!((carried.bodies().len(), carried.changes().count()), (3, 152));
    assert_eq!(reads, ["a.obj", "b.obj"]);
    let of_motion = |index| carried.during(MotionIndex::new(index)).collect::<Vec<_>>();
    assert_eq!([1, 3, 5, 7, 295].map(of_motion), [[0], [1], [2], [0], [0]].map(Vec::from));

    // The error is at the entry of the block.
    let error = CarriedBodies::new(&program, |name| {
        if name == "a.obj" { Ok(wedge.into()) } else { no_files(name) }
    });
    let error = error.unwrap_err();
    assert_eq!(error.motion().map(MotionIndex::number), Some(6));
    assert_eq!(error.message(), "shape 1 of the load: `b.obj`: there are no files");
    let text = program.to_json();
    let place = error.place_in(&text);
    assert!(text[place.span.clone()].starts_with("\"b.obj\""), "{place:?}");
}

#[test]
fn meshes_are_read_by_their_names() {
    let wedge = "v 0 0 0\nv 60 0 0\nv 0 40 0\nv 0 0 200\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    let program = program(r#"[{ "type": "mesh", "file": "parts/wedge.OBJ" }]"#);
    let carried = CarriedBodies::new(&program, |name| {
        assert_eq!(name, "parts/wedge.OBJ");
        Ok(wedge.into())
    });
    let robot = Robot::default();
    let [_, _, flange_m] = robot.flange_position(&[0.0; 7]);
    let arm = ArmInScene::new(&robot, &ceiling(flange_m + 0.3)).carrying(&carried.unwrap());
    let clearance = arm.clearance_during(MotionIndex::new(2), &[0.0; 7]).unwrap();
    assert!((clearance.distance_m - 0.1).abs() < 1e-9, "{clearance:?}");
    let error = CarriedBodies::new(&program, no_files).unwrap_err();
    assert_eq!(
        error.to_string(),
        "motion 2: shape 1 of the load: `parts/wedge.OBJ`: there are no files"
    );
    assert_eq!(error.motion().map(MotionIndex::number), Some(2));
    let error = CarriedBodies::new(&program, |_| Ok("v 0 0 0\n".into())).unwrap_err();
    assert!(error.to_string().contains("`parts/wedge.OBJ`: "), "{error}");
}
