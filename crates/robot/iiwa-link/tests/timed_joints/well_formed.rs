//! Steps, duration, start and number of points.

use iiwa_kin::Robot;
use iiwa_link::{MAX_POINTS, START_TOLERANCE_RAD, TimedJoints, message::Code};

use crate::timed_joints::{ramp::Ramp, sampled::check};

#[test]
fn long_steps_are_allowed_at_rest_only() {
    let slow = Ramp::new(1.0, 1.0, 5.0, 50.0);
    check(&slow.sampled(0, 0.025)).unwrap();
    let refusal = check(&slow.sampled(0, 0.026)).unwrap_err();
    assert_eq!(refusal.code, Code::BadRequest);
    assert!(refusal.message.contains("after the one before"), "{refusal}");

    // A rest of one minute at either end is a single step without drift.
    let mut trajectory = slow.sampled(0, 0.004);
    let [first, last] = [trajectory.joints_rad[0], *trajectory.joints_rad.last().unwrap()];
    trajectory.t_s.iter_mut().for_each(|t_s| *t_s += 60.0);
    trajectory.t_s.insert(0, 0.0);
    trajectory.joints_rad.insert(0, first);
    trajectory.t_s.push(trajectory.t_s.last().unwrap() + 60.0);
    trajectory.joints_rad.push(last);
    check(&trajectory).unwrap();
    for i in 0..60 {
        assert_eq!(trajectory.at(f64::from(i)), first);
        assert_eq!(trajectory.at(trajectory.duration_s() - f64::from(i)), last);
    }
}

#[test]
fn an_endless_trajectory_is_refused() {
    for t_s in [vec![0.0, 1e300], vec![-1e308, 1e308], vec![0.0, 1.0, 90_000.0]] {
        let joints_rad = vec![[0.0; 7]; t_s.len()];
        let refusal = check(&TimedJoints { t_s, joints_rad }).unwrap_err();
        assert_eq!(refusal.code, Code::BadRequest);
        assert!(refusal.message.contains("day") && refusal.message.len() < 200, "{refusal}");
    }
}

#[test]
fn a_trajectory_starts_within_half_a_degree_of_the_robot() {
    let trajectory = Ramp::new(1.0, 1.0, 5.0, 50.0).sampled(3, 0.004);
    let robot = Robot::default();
    for (off_deg, accepted) in [(0.49, true), (-0.49, true), (0.51, false), (-0.6, false)] {
        let mut start = [0.0; 7];
        start[3] += f64::to_radians(off_deg);
        let result = trajectory.check(robot.limits(), &start);
        assert_eq!(result.is_ok(), accepted, "{off_deg} deg: {result:?}");
        if let Err(refusal) = result {
            assert_eq!(refusal.code, Code::StartMismatch);
            assert!(refusal.message.contains("joint A4"), "{refusal}");
        }
    }
    assert!((START_TOLERANCE_RAD.to_degrees() - 0.5).abs() < 1e-12);
}

#[test]
fn a_list_that_is_too_long_is_refused() {
    let stamps = |count: usize| vec!["0"; count].join(",");
    let parse = |count: usize| {
        let text = format!("{{\"t_s\": [{}], \"joints_rad\": []}}", stamps(count));
        serde_json::from_str::<TimedJoints>(&text)
    };
    assert_eq!(parse(MAX_POINTS).unwrap().t_s.len(), MAX_POINTS);
    let error = parse(MAX_POINTS + 1).unwrap_err().to_string();
    assert!(error.contains("at most 200000"), "{error}");
}
