//! Splines as planned by Sunrise: a model of their speed.

// Test helpers may panic.
#![allow(clippy::unwrap_used)]

use std::fmt::Write;

use iiwa_kin::{Joints, Robot};
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_traj::{JerkOptions, Limit, LimitKind, Timing, Trajectory};
use proptest::{prelude::*, test_runner::RngSeed};

use crate::recorded::{POINTS, SHORT, frame, recorded_robot};

fn sunrise() -> Timing {
    Timing::Sunrise(JerkOptions::default())
}

/// Creates a spline from the first pose through the frames of the others, with further keys of the
/// motion.
fn spline(robot: &Robot, poses_deg: &[Joints], keys: &str) -> Option<JointPath> {
    let mut segments = String::new();
    for pose_deg in &poses_deg[1..] {
        let comma = if segments.is_empty() { "" } else { "," };
        let frame = frame(robot, pose_deg);
        write!(segments, r#"{comma}{{ "type": "spl", "frame": {frame} }}"#).unwrap();
    }
    let text = format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": {:?} }},
            "motions": [{{ "type": "spline"{keys}, "segments": [{segments}] }}] }}"#,
        poses_deg[0]
    );
    let program = Program::from_json(&text).unwrap();
    JointPath::new(&program, robot).ok()
}

fn seconds(path: &JointPath, timing: Timing) -> f64 {
    Trajectory::plan(path, timing).unwrap().motion_time_s()
}

/// Splines through some of the points, with the recorded duration in s.
const RECORDED: [(&[usize], f64); 6] = [
    (&[0, 1], 0.7805),
    (&[1, 2], 0.6787),
    (&[2, 3], 0.6018),
    (&[0, 1, 2], 1.2006),
    (&[0, 1, 2, 3, 4, 1], 2.3108),
    (&[0, 1, 2, 3, 4, 2], 2.5143),
];

#[test]
fn durations_are_near_recorded_ones() {
    let robot = recorded_robot();
    let mut cases: Vec<(Vec<Joints>, f64)> = RECORDED
        .iter()
        .map(|(points, s)| (points.iter().map(|point| POINTS[*point]).collect(), *s))
        .collect();
    cases.extend(SHORT.iter().zip([0.3201, 0.3624]).map(|(ends, s)| (ends.to_vec(), s)));
    for (poses, recorded_s) in cases {
        let path = spline(&robot, &poses, "").unwrap();
        let percent = 100.0 * (seconds(&path, sunrise()) / recorded_s - 1.0);
        println!("{recorded_s}: {percent:+.2} %");
        let allowed = if poses.len() == 2 { 2.0 } else { 3.0 };
        assert!(percent.abs() < allowed, "{recorded_s} s: {percent:+.2} %");
    }
}

#[test]
fn the_minimum_duration_is_named() {
    let robot = recorded_robot();
    let is_named = |poses: &[Joints]| {
        let path = spline(&robot, poses, "").unwrap();
        let trajectory = Trajectory::plan(&path, sunrise()).unwrap();
        let limits = &trajectory.motions()[0].limits;
        limits.iter().any(|active| active.limit == Limit::MinimumDuration)
    };
    assert!(SHORT.iter().all(|ends| is_named(ends)));
    assert!(!is_named(&POINTS[..5]));
}

/// Returns the robot at an override: all quantities with a unit of time are slower.
fn slowed(robot: &Robot, by: f64) -> Robot {
    let limits = robot.limits();
    let scaled = |values: Joints, order: i32| values.map(|value| value * by.powi(order));
    let mut slow = *limits;
    slow.velocity_rad_s = scaled(limits.velocity_rad_s, 1);
    slow.acceleration_rad_s2 = scaled(limits.acceleration_rad_s2, 2);
    slow.jerk_rad_s3 = scaled(limits.jerk_rad_s3, 3);
    robot.clone().with_limits(slow).with_ramp_law(robot.ramp_law().slowed_down(by))
}

#[test]
fn scaled_limits_scale_time() {
    let robot = recorded_robot();
    for by in [0.5, 0.3, 0.01] {
        let slow = slowed(&robot, by);
        for points in [&POINTS[..2], &POINTS[..5]] {
            let [fast_s, slow_s] = [&robot, &slow]
                .map(|robot| seconds(&spline(robot, points, "").unwrap(), sunrise()));
            assert!((slow_s * by / fast_s - 1.0).abs() < 5e-4, "{by}: {fast_s} {slow_s}");
        }
    }
}

/// A stop at which the spline turns back: each part has its own ramps.
#[test]
fn turning_back_is_a_stop() {
    let robot = recorded_robot();
    let points = [POINTS[0], POINTS[1], POINTS[0]];
    let path = spline(&robot, &points, "").unwrap();
    let plan = Trajectory::plan(&path, sunrise()).unwrap();
    assert!(plan.sections().len() > 1);
    let one_way_s = seconds(&spline(&robot, &points[..2], "").unwrap(), sunrise());
    assert!(plan.motion_time_s() > 1.8 * one_way_s, "{} {one_way_s}", plan.motion_time_s());
}

/// Limits of the program slow splines down.
#[test]
fn limits_of_the_motion_hold() {
    let robot = recorded_robot();
    let way_m = {
        let [a, b] = [POINTS[0], POINTS[1]].map(|q| robot.flange_position(&q.map(f64::to_radians)));
        std::iter::zip(a, b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
    };
    let path = spline(&robot, &POINTS[..2], r#", "cart_velocity_mm_s": 100"#).unwrap();
    let found_s = seconds(&path, sunrise());
    assert!(found_s > 10.0 * way_m && found_s < 10.0 * way_m + 0.25, "{found_s} {way_m}");
    let full_s = seconds(&spline(&robot, &POINTS[..5], "").unwrap(), sunrise());
    for keys in [
        r#", "velocity_rel": 0.5"#,
        r#", "acceleration_rel": 0.3"#,
        r#", "jerk_rel": 0.2"#,
        r#", "cart_acceleration_mm_s2": 800"#,
        r#", "cart_jerk_mm_s3": 5000"#,
    ] {
        let limited_s = seconds(&spline(&robot, &POINTS[..5], keys).unwrap(), sunrise());
        assert!(limited_s > 1.05 * full_s, "{keys}: {limited_s} {full_s}");
    }
}

fn pose() -> impl Strategy<Value = Joints> {
    [150.0, 90.0, 120.0, 100.0, 150.0, 100.0, 160.0_f64].map(|limit| -limit..limit)
}

/// Generates poses near to each other, some of them equal, some turning back.
fn poses() -> impl Strategy<Value = Vec<Joints>> {
    let step = (proptest::array::uniform7(-1.0..1.0_f64), -4.0..1.3_f64, 0..8_u32);
    (pose(), proptest::collection::vec(step, 1..6)).prop_map(|(start, steps)| {
        let mut poses = vec![start];
        for (direction, size, form) in steps {
            let last = poses[poses.len() - 1];
            let size = 10.0_f64.powf(size);
            poses.push(match form {
                0 => last,
                1 => poses[poses.len().saturating_sub(2)],
                _ => std::array::from_fn(|j| last[j] + size * direction[j]),
            });
        }
        poses
    })
}

proptest! {
    // Fixed cases: the deviation of the model from the expected order is not bounded by proof.
    #![proptest_config(ProptestConfig {
        cases: 48,
        rng_seed: RngSeed::Fixed(1),
        ..ProptestConfig::default()
    })]

    /// Near and far, smooth and turning back: joint velocities keep their limits at every instant,
    /// stamps increase, and the robot is at rest at both ends of each section.
    #[test]
    fn velocities_are_kept(poses in poses(), slower in -2.0..0.0_f64) {
        let robot = Robot::default();
        let keys = format!(r#", "velocity_rel": {}"#, 10.0_f64.powf(slower));
        let Some(path) = spline(&robot, &poses, &keys) else { return Ok(()) };
        let plan = Trajectory::plan(&path, sunrise()).unwrap();
        for section in plan.sections() {
            for piece in section.pieces() {
                let nodes = section.nodes(piece);
                prop_assert!(nodes.windows(2).all(|pair| pair[0].t_s < pair[1].t_s));
                prop_assert!(nodes.windows(2).all(|pair| pair[0].p <= pair[1].p));
            }
        }
        let rate_hz = 2000.0_f64.min(4e4 / plan.cycle_time_s().max(1e-3));
        for state in plan.samples(rate_hz) {
            let limits = path.limits_of(state.step).of(LimitKind::Velocity);
            for (j, (speed, limit)) in state.dq.iter().zip(limits).enumerate() {
                let share = speed.abs() / limit;
                prop_assert!(share <= 1.0 + 1e-4, "A{} at {share} at {} s", j + 1, state.t_s);
            }
        }
    }

    /// Apart from the tolerance of its cells, the model is slower with lower speed limits. However,
    /// a spline that turns back on the last thousandth of its way was seen to take 7 % less time.
    #[test]
    fn slower_takes_longer(poses in poses(), slower in 0.1..0.9_f64) {
        let robot = Robot::default();
        let at = |velocity: f64| {
            let keys = format!(r#", "velocity_rel": {velocity}"#);
            Some(seconds(&spline(&robot, &poses, &keys)?, sunrise()))
        };
        let Some([slow_s, fast_s]) = at(slower).zip(at(1.0)).map(|(a, b)| [a, b]) else {
            return Ok(());
        };
        prop_assert!(slow_s >= fast_s * (1.0 - 0.01), "{slow_s} {fast_s}");
    }
}
