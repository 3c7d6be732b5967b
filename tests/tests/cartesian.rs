//! Paths of the TCP against cases of 40-digit arithmetic and the durations of an independent solver, in
//! `fixtures/reference/cartesian.json`.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_kin::Robot;
use iiwa_path::{JointPath, Program, Segment, Step};
use iiwa_traj::{JerkOptions, SweepOptions, Timing, Trajectory};
use serde_json::{Value, json};

fn cases() -> Vec<Value> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../fixtures/reference/cartesian.json");
    let all: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    all["cases"].as_array().unwrap().clone()
}

fn robot(case: &Value) -> Robot {
    let flange_m = case["lengths_m"][3].as_f64().unwrap();
    Robot::built_in(case["robot"].as_str().unwrap()).unwrap().with_flange_m(flange_m).unwrap()
}

fn program(case: &Value) -> Program {
    let mut text = json!({
        "version": 1,
        "start": { "joints_deg": case["start_joints_deg"] },
        "motions": [case["motion"]],
    });
    // Where the auxiliary frame of a case is given without an orientation, it does not count.
    let motion = &mut text["motions"][0];
    if motion["type"] == "circ" {
        motion["aux_orientation"] = json!("ignore");
        for key in ["a_deg", "b_deg", "c_deg"] {
            motion["aux"][key] = json!(0.0);
        }
    }
    if !case["tool"].is_null() {
        text["tools"] = json!({ "tool": { "tcp": case["tool"] } });
        text["tool"] = json!("tool");
    }
    if !case["base"].is_null() {
        text["bases"] = json!({ "base": case["base"] });
        text["base"] = json!("base");
    }
    Program::from_json(&text.to_string()).unwrap()
}

fn path(case: &Value) -> JointPath {
    JointPath::new(&program(case), &robot(case)).unwrap()
}

/// The motion's segment.
fn segment(path: &JointPath) -> &dyn Segment {
    path.steps()
        .iter()
        .find_map(|step| match step {
            Step::Move { segment, .. } => Some(segment.as_ref()),
            _ => None,
        })
        .unwrap()
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    std::array::from_fn(|i| value[i].as_f64().unwrap())
}

fn difference<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    std::iter::zip(a, b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn joints_and_their_derivatives() {
    for case in cases() {
        let (path, robot) = (path(&case), robot(&case));
        let segment = segment(&path);
        let points = case["points"].as_array().unwrap();
        let largest = |key: &str| {
            let all = points.iter().flat_map(|point| numbers::<7>(&point[key]));
            all.map(f64::abs).fold(0.0, f64::max)
        };
        let [dq_scale, ddq_scale] = ["dq", "ddq"].map(largest);
        for point in points {
            let at = segment.at(point["s"].as_f64().unwrap());
            let what = format!("{} at {}", case["id"], point["s"]);
            assert!(difference(&at.q, &numbers(&point["q_rad"])) < 1e-8, "{what}: q");
            let flange_m = robot.flange_pose(&at.q).position_m;
            assert!(difference(&flange_m, &numbers(&point["flange_m"])) < 1e-9, "{what}: flange");
            let [dq, ddq] = ["dq", "ddq"].map(|key| numbers::<7>(&point[key]));
            let (off, off2) = (difference(&at.dq, &dq), difference(&at.ddq, &ddq));
            assert!(off < 1e-6 * dq_scale, "{what}: q' by {off:e} of {dq_scale}");
            assert!(off2 < 1e-6 * ddq_scale, "{what}: q'' by {off2:e} of {ddq_scale}");
        }
    }
}

#[test]
fn durations_are_those_of_an_independent_solver() {
    let timings = [
        ("acceleration", Timing::Acceleration(SweepOptions::default())),
        ("jerk", Timing::Jerk(JerkOptions::default())),
    ];
    for case in cases() {
        let path = path(&case);
        let id = case["id"].as_str().unwrap();
        let most = if id.contains("near") { 0.005 } else { 0.003 };
        for (key, timing) in timings {
            let plan = Trajectory::plan(&path, timing).unwrap();
            let answer = case["motion_s"][key].as_f64().unwrap();
            let off = plan.motion_time_s() / answer - 1.0;
            println!("{id} {key}: {answer:.5} s, {:+.4} %", 100.0 * off);
            assert!((-0.0005..most).contains(&off), "{id} by {key}: {:+.3} %", 100.0 * off);
        }
    }
}
