//! Controller override: it stretches the time of motions, but not the standstill after stops or
//! waits.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_traj::{SweepOptions, Timing, Totals, Trajectory};

/// Motions of all kinds, blended or not, one without displacement, and a wait.
const PROGRAM: &str = r#"{
    "version": 1,
    "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
    "motions": [
        { "type": "ptp", "joints_deg": [40, 20, 10, -70, 0, 80, 0], "blocking": true },
        { "type": "ptp", "joints_deg": [40, 20, 10, -70, 0, 80, 0], "blocking": true },
        { "type": "ptp", "joints_deg": [41, 20, 10, -70, 0, 80, 0], "jerk_rel": 0.5 },
        { "type": "wait", "seconds": 0.7 },
        { "type": "ptp", "joints_deg": [20, 35, 0, -60, 20, 60, 90], "blend": { "cart_mm": 60 } },
        { "type": "ptp", "joints_deg": [30, 35, 0, -60, 20, 60, 90] },
        { "type": "lin_rel", "offset": { "z_mm": -60, "a_deg": 40 }, "blend": { "cart_mm": 20 } },
        { "type": "lin_rel", "offset": { "z_mm": -80 }, "cart_velocity_mm_s": 100 },
        { "type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
        { "type": "spline", "segments": [
            { "type": "spl", "frame": { "x_mm": 520, "y_mm": 80, "z_mm": 560,
                "a_deg": 0, "b_deg": 180, "c_deg": 0, "e1_deg": 0 } },
            { "type": "spl", "frame": { "x_mm": 500, "y_mm": 160, "z_mm": 500,
                "a_deg": 0, "b_deg": 180, "c_deg": 0, "e1_deg": 0 } }
        ] }
    ]
}"#;

fn totals(override_percent: &str, timing: Timing) -> Totals {
    let text = PROGRAM.replacen("1,", &format!("1, {override_percent}"), 1);
    let path = JointPath::new(&Program::from_json(&text).unwrap(), &Robot::default()).unwrap();
    Trajectory::plan(&path, timing).unwrap().totals().to_owned()
}

#[test]
fn motions_take_longer_and_pauses_do_not() {
    let acceleration = Timing::Acceleration(SweepOptions::default());
    for timing in [Timing::default(), Timing::jerk_limited(), acceleration] {
        let full = totals("", timing);
        for (percent, share) in [(100.0, 1.0), (30.0, 0.3), (1.0, 0.01)] {
            let slow = totals(&format!("\"override_percent\": {percent},"), timing);
            let ratio = slow.motion_time_s * share / full.motion_time_s;
            assert!((ratio - 1.0).abs() < 2e-4, "{} at {percent} %: {ratio}", timing.name());
            // A motion without displacement takes time, too.
            let still_s = if timing == Timing::default() { 0.2 } else { 0.0 };
            let pauses_s = slow.settle_time_s - still_s / share;
            assert!((pauses_s - (2.0 * 0.093 + 5.0 * 0.05)).abs() < 1e-9, "{pauses_s} s");
            assert!((slow.wait_time_s - 0.7).abs() < 1e-12);
        }
    }
}

#[test]
fn a_motion_without_distance_takes_its_settle_time() {
    let path = JointPath::new(&Program::from_json(PROGRAM).unwrap(), &Robot::default()).unwrap();
    let trajectory = Trajectory::plan(&path, Timing::default()).unwrap();
    let motions: Vec<_> =
        trajectory.sections().iter().flat_map(iiwa_traj::Section::motions).collect();
    let still = motions.iter().find(|motion| motion.motion.index() == 1).unwrap();
    assert!((still.end_s - still.start_s - 0.2).abs() < 1e-9);
    let before = motions.iter().find(|motion| motion.motion.index() == 0).unwrap();
    assert!((still.start_s - before.end_s - 0.093).abs() < 1e-9);
}
