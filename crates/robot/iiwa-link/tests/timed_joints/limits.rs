//! The velocity, acceleration and jerk limits, and the duration of their check.

use std::time::Instant;

use iiwa_kin::Robot;
use iiwa_link::TimedJoints;

use crate::timed_joints::{
    ramp::Ramp,
    sampled::{assert_refused, check, rounded},
};

/// Function that creates a ramp with a share of one limit.
type Make<'a> = &'a dyn Fn(f64) -> Ramp;

/// Each limit in turn is exceeded by less and by more than its margin, far below the other limits.
#[test]
fn each_limit_is_checked_with_its_margin() {
    let robot = Robot::default();
    let limits = robot.limits();
    for joint in 0..7 {
        let [speed, acceleration, jerk] = [
            limits.velocity_rad_s[joint],
            limits.acceleration_rad_s2[joint],
            limits.jerk_rad_s3[joint],
        ];
        for step_ms in [1, 2, 4, 5] {
            let fast = |over: f64| Ramp::new(2.0, over * speed, 0.8 * acceleration, 0.4 * jerk);
            let strong = |over: f64| Ramp::new(2.0, 0.95 * speed, over * acceleration, 0.8 * jerk);
            let jerky = |over: f64| {
                let top = 0.98 * acceleration;
                let speed = 1.02 * top * top / (over * jerk);
                Ramp::new(2.0, speed.max(0.3 * limits.velocity_rad_s[joint]), top, over * jerk)
            };
            // The wrists are at full jerk for less than 30 ms: over such a short time, rounding to
            // six decimals has a large effect.
            let jerk_beyond = if joint < 4 { 1.15 } else { 2.0 };
            let cases: [(&str, Make<'_>, f64, f64); 3] = [
                ("velocity", &fast, 1.015, 1.025),
                ("acceleration", &strong, 1.04, 1.06),
                ("jerk", &jerky, 1.09, jerk_beyond),
            ];
            for (kind, make, within, beyond) in cases {
                let place = format!("{kind} of joint A{}, {step_ms} ms", joint + 1);
                let step_s = f64::from(step_ms) * 1e-3;
                for trajectory in [make(0.9), make(within)] {
                    let trajectory = trajectory.sampled(joint, step_s);
                    assert_eq!(check(&trajectory), Ok(()), "{place}");
                    assert_eq!(check(&rounded(&trajectory)), Ok(()), "{place}");
                }
                let trajectory = make(beyond).sampled(joint, step_s);
                for trajectory in [rounded(&trajectory), trajectory] {
                    let refusal = assert_refused(&trajectory, &place);
                    let named = format!("the {kind} of joint A{} is", joint + 1);
                    assert!(refusal.message.contains(&named), "{place}: {refusal}");
                }
            }
        }
    }
}

/// An excess is found for any distribution of stamps, also with a long rest at the end.
#[test]
fn uneven_stamps_conceal_nothing() {
    let robot = Robot::default();
    let limits = robot.limits();
    let ramp = Ramp::new(
        1.0,
        0.9 * limits.velocity_rad_s[0],
        3.0 * limits.acceleration_rad_s2[0],
        3.0 * limits.jerk_rad_s3[0],
    );
    for step_s in [1e-4, 1e-3, 4e-3] {
        let mut trajectory = ramp.sampled(0, step_s);
        let refusal = assert_refused(&trajectory, "too strong");
        assert!(refusal.message.contains("acceleration"), "{refusal}");
        let last = *trajectory.joints_rad.last().unwrap();
        trajectory.t_s.push(trajectory.t_s.last().unwrap() + 1000.0);
        trajectory.joints_rad.push(last);
        let refusal = assert_refused(&trajectory, "too strong, and a rest");
        assert!(refusal.message.contains("acceleration"), "{refusal}");
    }
}

/// A trajectory longer than the accepted maximum is checked within seconds. This is not a
/// benchmark: the bound is far above the time on a loaded machine, and far below the hours of a
/// check that compares points in pairs.
#[test]
fn the_longest_trajectory_is_checked_in_linear_time() {
    for ramp in [Ramp::new(2.0, 0.005, 0.01, 0.2), Ramp::new(1e-5, 2e-4, 0.01, 1.0)] {
        let count = 400_000;
        let step_s = ramp.duration_s() / f64::from(count - 1);
        let t_s: Vec<_> = (0..count).map(|i| f64::from(i) * step_s).collect();
        let joints_rad = t_s.iter().map(|t_s| [ramp.at(*t_s), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let trajectory = TimedJoints { joints_rad: joints_rad.collect(), t_s };
        let since = Instant::now();
        assert_eq!(check(&trajectory), Ok(()));
        let took = since.elapsed();
        println!("{count} points every {step_s} s: {took:?}");
        assert!(took.as_secs_f64() < 120.0, "{took:?}");
    }
}
