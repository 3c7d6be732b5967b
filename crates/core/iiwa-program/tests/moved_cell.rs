//! Programs for a robot at another place in its cell.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_kin::Pose;
use iiwa_program::{Course, Motion, Program, SegmentCourse, Start, TargetRef};

/// Bases on bases, named frames, targets in each kind of base, and all kinds of courses.
const PROGRAM: &str = r#"{
    "version": 1,
    "start": { "frame": "home" },
    "bases": {
        "table": { "x_mm": 400, "y_mm": 100, "z_mm": 50, "a_deg": 30 },
        "stand": { "base": "robot", "x_mm": -300, "c_deg": 10 },
        "tray": { "base": "table", "x_mm": 10, "z_mm": 30, "a_deg": 5, "b_deg": 10, "c_deg": 15 }
    },
    "frames": {
        "home": { "x_mm": 500, "y_mm": 0, "z_mm": 500, "a_deg": 0, "b_deg": 180, "c_deg": 0,
            "e1_deg": 10, "turn": 2 },
        "part": { "base": "tray", "x_mm": 50, "y_mm": 0, "z_mm": 200, "a_deg": 0, "b_deg": 180,
            "c_deg": 0 }
    },
    "motions": [
        { "type": "ptp", "frame": "part" },
        { "type": "lin", "frame":
            { "x_mm": 520, "y_mm": 40, "z_mm": 480, "a_deg": 0, "b_deg": 180, "c_deg": 0 } },
        { "type": "lin", "base": "tray", "frame":
            { "x_mm": 0, "y_mm": 5, "z_mm": 300, "a_deg": 0, "b_deg": 180, "c_deg": 0 } },
        { "type": "lin", "base": "stand", "frame": { "base": "robot",
            "x_mm": 510, "y_mm": 5, "z_mm": 400, "a_deg": 0, "b_deg": 180, "c_deg": 0 } },
        { "type": "lin_rel", "offset": { "z_mm": 50 }, "in": "robot" },
        { "type": "lin_rel", "offset": { "z_mm": 50 }, "in": "table" },
        { "type": "lin_rel", "offset": { "z_mm": 50 }, "in":
            { "x_mm": 0, "y_mm": 0, "z_mm": 0, "a_deg": 20, "b_deg": 0, "c_deg": 0 } },
        { "type": "circ", "aux": { "x_mm": 520, "y_mm": 40, "z_mm": 480 }, "frame": "home" },
        { "type": "spline", "segments": [
            { "type": "spl", "frame": "part" },
            { "type": "circ", "aux": { "x_mm": 510, "y_mm": 60, "z_mm": 460 }, "frame":
                { "x_mm": 500, "y_mm": 50, "z_mm": 450, "a_deg": 0, "b_deg": 180, "c_deg": 0 } }
        ] },
        { "type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 90, 0] }
    ]
}"#;

/// Poses in the robot base of all targets, and of the frames of offsets.
fn poses(program: &Program) -> Vec<Pose> {
    let workcell = &program.workcell;
    let target = |target: &TargetRef, base: Option<&str>| workcell.target(target, base).unwrap().1;
    let mut all = Vec::new();
    if let Start::Frame(start) = &program.start {
        all.push(target(start, None));
    }
    for motion in &program.motions {
        let Motion::Cartesian(motion) = motion else { continue };
        let base = motion.base.as_deref();
        match &motion.course {
            Course::Ptp { to } | Course::Lin { to } => all.push(target(to, base)),
            Course::LinRel { within: Some(within), .. } => {
                all.push(workcell.reference(within, base).unwrap());
            }
            Course::LinRel { within: None, .. } => {}
            Course::Circ(circ) => all.extend([target(&circ.aux, base), target(&circ.to, base)]),
            Course::Spline(segments) => {
                for segment in segments {
                    if let SegmentCourse::Circ(circ) = &segment.course {
                        all.push(target(&circ.aux, base));
                    }
                    all.push(target(segment.course.target(), base));
                }
            }
        }
    }
    all
}

fn assert_same(actual: &Pose, expected: &Pose) {
    let numbers = |pose: &Pose| [&pose.rotation[..], &[pose.position_m]].concat().concat();
    for (number, expected) in numbers(actual).into_iter().zip(numbers(expected)) {
        assert!((number - expected).abs() < 1e-12, "{actual:?}");
    }
}

/// With the robot base as the base in use, and with another one.
#[test]
fn all_targets_keep_their_places_in_the_cell() {
    for base in [None, Some("table"), Some("robot")] {
        let mut program = Program::from_json(PROGRAM).unwrap();
        program.workcell.base = base.map(str::to_owned);
        let cell = Pose::from_xyz_abc([0.1, -0.2, 0.05], [0.4, 0.0, 0.0]);
        let moved = program.with_cell_at(&cell);
        let (before, after) = (poses(&program), poses(&moved));
        assert_eq!((before.len(), after.len()), (13, 13));
        for (before, after) in before.iter().zip(&after) {
            assert_same(after, &cell.then(before));
        }
        // And back.
        for (before, back) in before.iter().zip(poses(&moved.with_cell_at(&cell.inverse()))) {
            assert_same(&back, before);
        }
    }
}

/// A frame takes precedence over the robot base where an offset names both.
#[test]
fn a_frame_named_robot_moves_as_a_frame() {
    let text = PROGRAM.replace("\"home\"", "\"robot\"");
    let program = Program::from_json(&text).unwrap();
    let cell = Pose::from_xyz_abc([0.1, -0.2, 0.05], [0.4, 0.0, 0.0]);
    let moved = program.with_cell_at(&cell);
    for (before, after) in poses(&program).iter().zip(poses(&moved)) {
        assert_same(&after, &cell.then(before));
    }
}

#[test]
fn joint_positions_stay_and_signs_of_joints_are_left_out() {
    let program = Program::from_json(PROGRAM).unwrap();
    assert_eq!(program.joint_targets(), 1);
    let moved = program.with_cell_at(&Pose::from_xyz_abc([0.1, 0.0, 0.0], [0.0; 3]));
    assert_eq!(moved.motions.last(), program.motions.last());
    let home = &moved.workcell.frames["home"];
    assert_eq!((home.turn, home.e1_rad), (None, program.workcell.frames["home"].e1_rad));
    // The written program is the same again.
    assert_eq!(Program::from_json(&moved.to_json()).unwrap(), moved);
}
