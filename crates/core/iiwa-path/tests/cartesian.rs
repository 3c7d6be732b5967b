//! Motions to frames in programs: JSON round trip, and errors with their places.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::Program;
use serde_json::{Value, json};

/// A feasible program with every kind of motion.
fn good() -> Value {
    serde_json::from_str(include_str!("every_motion.json")).unwrap()
}

fn plan(program: &Value) -> Result<JointPath, String> {
    let text = serde_json::to_string_pretty(program).unwrap();
    let program = Program::from_json(&text).map_err(|error| error.to_string())?;
    JointPath::new(&program, &Robot::default())
        .map_err(|fault| format!("{fault}, at {}", fault.place_in(&text)))
}

#[test]
fn it_reads_back_as_it_is() {
    let program = Program::from_json(&good().to_string()).unwrap();
    assert_eq!(program.motions.len(), 6);
    let again = Program::from_json(&program.to_json()).unwrap();
    // Limits are converted between m and mm; the numbers of frames are kept as written.
    assert_eq!(again.workcell.frames, program.workcell.frames);
    assert_eq!(again.workcell.bases, program.workcell.bases);
    assert_eq!(again.motions.len(), program.motions.len());
    let [a, b] =
        [&program, &again].map(|program| JointPath::new(program, &Robot::default()).unwrap());
    for (a, b) in a.steps().iter().zip(b.steps()) {
        if let (
            iiwa_path::Step::Move { segment: a, .. },
            iiwa_path::Step::Move { segment: b, .. },
        ) = (a, b)
        {
            let (a, b) = (a.at(0.3), b.at(0.3));
            assert!((0..7).all(|j| (a.q[j] - b.q[j]).abs() < 1e-12));
        }
    }
    assert_eq!(Program::from_json(&again.to_json()).unwrap(), again);
}

#[test]
fn invalid_motions_are_refused_with_their_place() {
    plan(&good()).unwrap();
    let to = |x: f64, z: f64, more: &Value| {
        let mut frame = json!({
            "x_mm": x, "y_mm": 0, "z_mm": z, "a_deg": 0, "b_deg": 0, "c_deg": 180, "base": "robot"
        });
        for (key, value) in more.as_object().unwrap() {
            frame[key] = value.clone();
        }
        frame
    };
    let lin = |frame: Value| json!({ "type": "lin", "frame": frame });
    let cases = [
        ("/tool", json!("hammer"), vec!["unknown tool `hammer`", "`gripper/left`"]),
        ("/base", json!("floor"), vec!["unknown base `floor`", "`table`, `tray`"]),
        ("/motions/0/frame", json!("place"), vec!["motion 1", "unknown frame `place`", "`pick`"]),
        ("/bases/table/base", json!("tray"), vec!["refers to itself"]),
        (
            "/motions/0/frame",
            to(2000.0, 300.0, &json!({})),
            vec!["motion 1", "mm too short: the wrist would be", "mm from the shoulder"],
        ),
        (
            "/motions/0/frame",
            to(100.0, 700.0, &json!({ "e1_deg": 90.0, "status": 2 })),
            vec!["motion 1", "out of reach with E1 at 90", "within reach is E1 from"],
        ),
        (
            "/motions/0/frame",
            to(-300.0, 500.0, &json!({ "status": 2 })),
            vec![
                "motion 1",
                "at the frame, joint A1 is at",
                "; its range is -170 to 170 deg, exceeded by",
                "; E1 is 0 deg there, and has to be from",
                "with this status",
            ],
        ),
        ("/frames/pick/x_mm", json!("10"), vec!["a number"]),
        ("/motions/0/frame", json!({ "x_mm": 10 }), vec!["motion 1", "`y_mm`, `z_mm`, `a_deg`,"]),
        ("/motions/2/in", json!("trai"), vec!["motion 3: unknown frame or base `trai`", "`tray`"]),
        ("/motions/0/blend", json!({ "ori_deg": 5 }), vec!["motion 1", "unknown key `ori_deg`"]),
        (
            "/motions/1/blend",
            json!({ "fraction": 0.2 }),
            vec!["motion 2", "unknown key `fraction`"],
        ),
        ("/motions/1/blend", json!({}), vec!["motion 2", "at least one of"]),
        ("/motions/1/cart_velocity_mm_s", json!(0), vec!["motion 2", "cart_velocity_mm_s is 0"]),
        ("/motions/3/circ_angle_deg", json!(0), vec!["motion 4", "circ_angle_deg is 0"]),
        ("/motions/3/aux_orientation", json!("interpolate"), vec!["motion 4", "aux_orientation"]),
        (
            "/motions/1",
            lin(json!({ "x_mm": 10, "y_mm": 80, "z_mm": 55, "a_deg": 0, "b_deg": 0, "c_deg": 0 })),
            vec!["motion 2", "half a turn"],
        ),
        ("/motions/3/aux", good()["motions"][3]["frame"].clone(), vec!["motion 4", "no circle"]),
        ("/motions/1", lin(to(2000.0, 300.0, &json!({}))), vec!["motion 2", "too short"]),
        ("/frames/pick/status", json!(9), vec!["`pick`", "status is 9"]),
        ("/frames/pick/status", json!(300), vec!["a whole number"]),
        ("/frames/pick", json!([10, 0, 50, 0, 0, 180]), vec!["an object"]),
        ("/tools/flange", json!({ "tcp": {} }), vec!["`flange`", "the bare flange"]),
        ("/tools/a~1b", json!({ "tcp": {} }), vec!["`a/b`", "has no `/`"]),
        ("/bases/robot", json!({}), vec!["`robot`", "the robot's foot"]),
        ("/frames/tcp", good()["frames"]["pick"].clone(), vec!["`tcp`", "the TCP itself"]),
        ("/bases/", json!({}), vec!["at least one character"]),
        ("/motions/1/orientation", json!(5), vec!["motion 2", "a string"]),
        ("/mode", json!({ "t1": null }), vec!["a string"]),
        ("/mode", json!("t2"), vec!["t2"]),
        (
            "/motions/1/cart_velocity_mm_s",
            json!(-250),
            vec!["motion 2", "cart_velocity_mm_s is -250"],
        ),
        ("/motions/1/orientation_velocity_deg_s", json!(-90), vec!["is -90"]),
        ("/frames/pick/a_rad", json!(1), vec!["`pick`", "either `a_deg` or `a_rad`"]),
        ("/tools/gripper/load/mass_kg", json!(-1), vec!["`gripper`", "its mass must be 0 to"]),
    ];
    for (pointer, value, words) in cases {
        let mut program = good();
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        let key = &key.replace("~1", "/");
        let parent = program.pointer_mut(parent).unwrap();
        match parent {
            Value::Array(list) => list[key.parse::<usize>().unwrap()] = value.clone(),
            parent => parent[key.as_str()] = value.clone(),
        }
        let refused = plan(&program).expect_err(&format!("{pointer} = {value} is taken"));
        for word in words {
            assert!(refused.contains(word), "{pointer} = {value}: {refused}");
        }
        assert!(refused.contains("at line"), "{refused}");
        assert!(!refused.contains("at line 1, column 1"), "{pointer}: {refused}");
    }
}

/// No straight motion is possible from the candle pose, which is singular.
#[test]
fn singular_poses_are_refused_with_a_way_out() {
    let program = json!({
        "version": 1,
        "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
        "motions": [{ "type": "lin_rel", "offset": { "z_mm": -100 } }]
    });
    let refused = plan(&program).unwrap_err();
    assert!(refused.contains("at 0.0 % of the way, the arm is singular"), "{refused}");
    assert!(refused.contains("go there by ptp"), "{refused}");
}

/// The range of E1 in the message is that in which the motion is possible.
#[test]
fn a_possible_e1_is_named() {
    let program = |e1_deg: f64| {
        json!({
            "version": 1,
            "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
            "motions": [{ "type": "ptp", "frame": {
                "x_mm": -300, "y_mm": 0, "z_mm": 500, "a_deg": 0, "b_deg": 0, "c_deg": 180,
                "e1_deg": e1_deg, "status": 2
            } }]
        })
    };
    let refused = plan(&program(0.0)).unwrap_err();
    let (_, range) = refused.split_once("has to be from ").unwrap();
    let numbers: Vec<f64> = range.split(' ').filter_map(|word| word.parse().ok()).take(2).collect();
    let [from, to] = numbers[..] else { panic!("{refused}") };
    for e1_deg in [from, to] {
        plan(&program(e1_deg)).unwrap();
    }
    plan(&program(from - 0.2)).unwrap_err();
}

/// An offset may be in the orientation of a base. A frame of the same name takes precedence.
#[test]
fn offsets_are_in_frames_or_bases() {
    let end = |within: &str, frames: Value, by_mm: [f64; 3]| {
        let program = json!({
            "version": 1,
            "bases": { "table": { "a_deg": 90 }, "tray": { "base": "table", "a_deg": 90 } },
            "frames": frames,
            "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
            "motions": [{ "type": "lin_rel", "offset": { "x_mm": 30 }, "in": within }]
        });
        let path = plan(&program).unwrap();
        let iiwa_path::Step::Move { segment, .. } = &path.steps()[0] else { panic!() };
        let [from, to] =
            [0.0, 1.0].map(|s| Robot::default().flange_pose(&segment.at(s).q).position_m);
        for ((from, to), by) in from.iter().zip(to).zip(by_mm) {
            assert!((1e3 * (to - from) - by).abs() < 1e-6, "{within}: {from} {to}");
        }
    };
    let frame = |a_deg: f64| {
        json!({
            "x_mm": 0, "y_mm": 0, "z_mm": 0, "a_deg": a_deg, "b_deg": 0, "c_deg": 0
        })
    };
    end("robot", json!({}), [30.0, 0.0, 0.0]);
    end("table", json!({}), [0.0, 30.0, 0.0]);
    end("tray", json!({}), [-30.0, 0.0, 0.0]);
    end("corner", json!({ "corner": frame(-90.0) }), [0.0, -30.0, 0.0]);
    end("table", json!({ "table": frame(-90.0) }), [0.0, -30.0, 0.0]);
}

#[test]
fn names_are_there_once() {
    let text = good().to_string().replace("\"tray\":", "\"table\": {}, \"tray\":");
    let refused = Program::from_json(&text).unwrap_err().to_string();
    assert!(refused.contains("the name `table` appears twice"), "{refused}");
}

/// The orientation of an auxiliary frame that equals that of the start or the end changes the path
/// by next to nothing, also with rounding errors.
#[test]
fn auxiliary_orientations_at_an_end_do_not_turn_the_path() {
    let frame = |y: f64, x: f64, a: f64| {
        json!({
            "x_mm": x, "y_mm": y, "z_mm": 400, "a_deg": a, "b_deg": 180, "c_deg": 0
        })
    };
    let turns = |aux_deg: f64| {
        let program = json!({
            "version": 1,
            "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
            "motions": [
                { "type": "ptp", "frame": frame(-50.0, 550.0, 13.0) },
                { "type": "circ", "aux": frame(0.0, 600.0, aux_deg),
                  "frame": frame(50.0, 550.0, 53.0) }
            ]
        });
        let path = plan(&program).unwrap();
        let iiwa_path::Step::Move { segment, .. } = &path.steps()[2] else { unreachable!() };
        (0..=20).map(|i| segment.at(f64::from(i) / 20.0).q).collect::<Vec<_>>()
    };
    let off = |a: &[[f64; 7]], b: &[[f64; 7]]| {
        let all = a.as_flattened().iter().zip(b.as_flattened());
        all.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    for at_deg in [13.0, 53.0] {
        let turn_there = turns(at_deg);
        for beside in [1e-12, -1e-9, 1e-6] {
            assert!(off(&turn_there, &turns(at_deg + beside)) < 1e-6, "{at_deg} {beside}");
        }
        assert!(off(&turn_there, &turns(33.0)) < 0.3, "{}", off(&turn_there, &turns(33.0)));
    }
}
