//! Targets whose turn contradicts the joints there.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_kin::{Robot, Turn};
use iiwa_path::TurnContradiction;
use iiwa_program::{Frame, MotionIndex, Program};
use serde_json::{Value, json};

const JOINTS_DEG: [f64; 7] = [10.0, 40.0, -15.0, -70.0, 20.0, 60.0, -30.0];

/// The frame of the flange at `joints_deg`, with all redundancy values that a controller writes.
fn taught(joints_deg: [f64; 7], turn: u8) -> Value {
    let robot = Robot::default();
    let joints_rad = joints_deg.map(f64::to_radians);
    let Frame { xyz_mm: [x, y, z], abc_rad: [a, b, c] } = (&robot.flange_pose(&joints_rad)).into();
    let redundancy = robot.redundancy(&joints_rad);
    json!({
        "x_mm": x, "y_mm": y, "z_mm": z, "a_rad": a, "b_rad": b, "c_rad": c,
        "e1_rad": redundancy.e1_rad, "status": redundancy.status.bits(), "turn": turn
    })
}

fn contradictions_of(program: &Value) -> Vec<TurnContradiction> {
    let program = Program::from_json(&program.to_string()).unwrap();
    TurnContradiction::all(&program, &Robot::default()).unwrap()
}

#[test]
fn they_are_found_wherever_a_motion_ends() {
    let right = Turn::of(&JOINTS_DEG).bits();
    let wrong = right ^ 1;
    let program = |turn| {
        json!({
            "version": 1,
            "frames": { "there": taught(JOINTS_DEG, turn) },
            "start": { "frame": "there" },
            "motions": [
                { "type": "wait", "seconds": 1 },
                { "type": "ptp", "frame": "there" },
                { "type": "lin_rel", "offset": { "z_mm": -50 } },
                { "type": "lin", "frame": taught(JOINTS_DEG, turn) }
            ]
        })
    };
    assert_eq!(contradictions_of(&program(right)), []);
    let contradictions = contradictions_of(&program(wrong));
    let motions: Vec<_> =
        contradictions.iter().map(|found| found.motion.map(MotionIndex::index)).collect();
    assert_eq!(motions, [None, Some(1), Some(3)]);
    let [stated, actual] = [wrong, right].map(|bits| Turn::new(bits).unwrap());
    assert!(contradictions.iter().all(|found| (found.stated, found.found) == (stated, actual)));
    let texts: Vec<_> = contradictions.iter().map(ToString::to_string).collect();
    assert!(texts[0].starts_with("the start pose: the frame states turn"), "{texts:?}");
    assert!(texts[1].starts_with("motion 2: the frame states turn"), "{texts:?}");
}

#[test]
fn signs_of_joints_at_zero_do_not_count() {
    let joints_deg = [0.001, 40.0, 0.0, -70.0, -0.001, 60.0, 0.0];
    let to = |turn| {
        json!({
            "version": 1, "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
            "motions": [{ "type": "ptp", "frame": taught(joints_deg, turn) }]
        })
    };
    // Bits of A1, A3, A5 and A7.
    for bits in [0b000_1000, 0b000_1001, 0b000_1100, 0b001_1000, 0b101_1101] {
        assert_eq!(contradictions_of(&to(bits)), [], "{bits}");
    }
    assert_eq!(contradictions_of(&to(0b000_0000)).len(), 1);
    assert_eq!(contradictions_of(&to(0b010_1000)).len(), 1);
}

#[test]
fn impossible_turns_are_faults() {
    let far = json!({
        "version": 1, "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
        "motions": [{ "type": "ptp", "frame": { "x_mm": 5000, "y_mm": 0, "z_mm": 0, "a_deg": 0,
                      "b_deg": 0, "c_deg": 0, "turn": 3 } }]
    });
    let program = Program::from_json(&far.to_string()).unwrap();
    assert!(TurnContradiction::all(&program, &Robot::default()).is_err());
}
