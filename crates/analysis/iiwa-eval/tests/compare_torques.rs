//! Recorded torques compared with those of a plan.

use iiwa_eval::{PlannedTrajectory, VirtualRobot, compare};
use iiwa_kin::{Load, Robot};
use iiwa_plan::PlanOptions;
use iiwa_program::Program;
use iiwa_traj::Timing;

const PROGRAM: &str = r#"{ "version": 1,
    "mount": { "rpy_deg": [0, 90, 0] },
    "tools": { "gripper": { "tcp": { "z_mm": 100 },
                            "load": { "mass_kg": 2, "center_mm": [0, 0, 60] } } },
    "tool": "gripper",
    "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
    "motions": [
        { "type": "ptp", "joints_deg": [30, 50, 20, -40, 10, 70, 50] },
        { "type": "load", "load": { "mass_kg": 5, "center_mm": [0, 20, 90] } },
        { "type": "ptp", "joints_deg": [-20, 20, 0, -80, 0, 60, 0], "velocity_rel": 0.5 },
        { "type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 90, 0] }] }"#;

#[test]
fn torques_differ_by_noise_and_by_unknown_loads() {
    let program = Program::from_json(PROGRAM).unwrap();
    let mut robot = VirtualRobot::new(Robot::default(), 5);
    robot.torque_noise_nm = Some(0.05);
    let plan =
        PlanOptions::with_timing(Timing::jerk_limited()).plan(&program, &robot.robot).unwrap();
    let plan = PlannedTrajectory::from_trajectory(&plan);
    let log = robot.run(&program).unwrap();
    let actual = compare(&plan, &log).unwrap().torques.unwrap();
    println!("{actual:#?}");
    assert!(!actual.turned && actual.samples > 1000);
    for j in 0..7 {
        assert!((actual.rms_nm[j] - 0.05).abs() < 0.01, "A{}: {}", j + 1, actual.rms_nm[j]);
        assert!(actual.largest_nm[j].abs() < 0.4, "A{}: {}", j + 1, actual.largest_nm[j]);
    }
    assert!(actual.planned_peak_nm[1].abs() > 30.0);

    // Half a kg more than the program states, the opposite sign, and a file without torques.
    robot.load = Some(Load { mass_kg: 5.5, center_mm: [0.0, 20.0, 90.0], ..Load::default() });
    let mut heavier = robot.run(&program).unwrap();
    for nm in heavier.torques_nm.iter_mut().flatten().flatten() {
        *nm = -*nm;
    }
    let actual = compare(&plan, &heavier).unwrap().torques.unwrap();
    assert!(actual.turned && actual.rms_nm[1] > 1.0, "{actual:?}");
    heavier.torques_nm.clear();
    assert_eq!(compare(&plan, &heavier).unwrap().torques, None);
}
