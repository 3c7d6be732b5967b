//! TCP paths compared with 40-digit arithmetic and the durations of an independent solver, in
//! `fixtures/reference/cartesian.json`.

use iiwa_path::{JointPath, Segment, Step};
use iiwa_traj::{SweepOptions, Timing, Trajectory};
use iiwasim_tests::cartesian_cases::{CartesianCase, cartesian_cases};
use serde_json::Value;

fn path(case: &CartesianCase) -> JointPath {
    JointPath::new(&case.program, &case.robot).unwrap()
}

/// Returns the segment of the motion.
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
    for case in cartesian_cases() {
        let path = path(&case);
        let segment = segment(&path);
        let points = case.entry["points"].as_array().unwrap();
        let largest = |key: &str| {
            let all = points.iter().flat_map(|point| numbers::<7>(&point[key]));
            all.map(f64::abs).fold(0.0, f64::max)
        };
        let [dq_scale, ddq_scale] = ["dq", "ddq"].map(largest);
        for point in points {
            let point_state = segment.at(point["s"].as_f64().unwrap());
            let label = format!("{} at {}", case.id, point["s"]);
            assert!(difference(&point_state.q, &numbers(&point["q_rad"])) < 1e-8, "{label}: q");
            let flange_m = case.robot.flange_pose(&point_state.q).position_m;
            assert!(difference(&flange_m, &numbers(&point["flange_m"])) < 1e-9, "{label}: flange");
            let [dq, ddq] = ["dq", "ddq"].map(|key| numbers::<7>(&point[key]));
            let (off, off2) =
                (difference(&point_state.dq, &dq), difference(&point_state.ddq, &ddq));
            assert!(off < 1e-6 * dq_scale, "{label}: q' by {off:e} of {dq_scale}");
            assert!(off2 < 1e-6 * ddq_scale, "{label}: q'' by {off2:e} of {ddq_scale}");
        }
    }
}

#[test]
fn durations_are_those_of_an_independent_solver() {
    let timings = [
        ("acceleration", Timing::Acceleration(SweepOptions::default())),
        ("jerk", Timing::jerk_limited()),
    ];
    for case in cartesian_cases() {
        let path = path(&case);
        let id = &case.id;
        let tolerance = if id.contains("near") { 0.005 } else { 0.003 };
        for (key, timing) in timings {
            let plan = Trajectory::plan(&path, timing).unwrap();
            let answer = case.entry["motion_s"][key].as_f64().unwrap();
            let off = plan.motion_time_s() / answer - 1.0;
            println!("{id} {key}: {answer:.5} s, {:+.4} %", 100.0 * off);
            assert!((-0.0005..tolerance).contains(&off), "{id} by {key}: {:+.3} %", 100.0 * off);
        }
    }
}
