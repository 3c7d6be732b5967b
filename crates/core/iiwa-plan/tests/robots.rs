//! Choice of the robot for which a program is planned.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::fs;

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_plan::{Error, PlanRequest, ProgramSource};
use iiwa_program::{Fault, Program};
use iiwa_traj::PlanError;

/// A program for a robot, as JSON.
fn text(robot: &str) -> String {
    format!(
        r#"{{ "version": 1, {robot} "start": {{ "joints_deg": [0, 0, 0, 0, 0, 0, 0] }},
            "motions": [{{ "type": "ptp", "joints_deg": [60, 0, 0, 0, 0, 0, 0] }}] }}"#
    )
}

const R820: &str = r#""robot": "lbr_iiwa_14_r820","#;

fn time_s(request: &PlanRequest, robot: &str) -> f64 {
    let source = ProgramSource::from_json(&text(robot)).unwrap();
    request.plan(&source).unwrap().trajectory.cycle_time_s()
}

#[test]
fn a_program_is_planned_for_the_robot_that_it_names() {
    let request = PlanRequest::default();
    // The R820 rotates A1 more slowly: 85 deg/s instead of 98.
    assert!(time_s(&request, R820) > time_s(&request, "") + 0.05);
    let other = PlanRequest { robot: Some(Robot::lbr_iiwa_7_r800()), ..PlanRequest::default() };
    assert_eq!(time_s(&other, R820), time_s(&request, ""));
    let usual = PlanRequest { default_robot: Robot::lbr_iiwa_14_r820(), ..PlanRequest::default() };
    assert_eq!(time_s(&usual, ""), time_s(&request, R820));
    assert_eq!(time_s(&usual, r#""robot": "lbr_iiwa_7_r800","#), time_s(&request, ""));
}

#[test]
fn a_path_of_another_robot_names_both_robots() {
    let program = Program::from_json(&text(R820)).unwrap();
    let fault = JointPath::new(&program, &Robot::lbr_iiwa_7_r800()).unwrap_err();
    let expected = "the program is for the robot `lbr_iiwa_14_r820`; `lbr_iiwa_7_r800` was given";
    assert_eq!(fault.to_string(), expected);
    assert_eq!(fault.place_in(&text(R820)).to_string(), "line 1, column 26");
    let program = Program::from_json(&text(r#""flange_mm": 126,"#)).unwrap();
    let fault = JointPath::new(&program, &Robot::lbr_iiwa_7_r800()).unwrap_err();
    assert!(matches!(fault, Fault::OtherFlange { .. }), "{fault}");
    JointPath::new(&program, &program.with_flange(Robot::lbr_iiwa_7_r800())).unwrap();
    // A profile may be the file that the program names, a built-in model is not.
    let program = Program::from_json(&text(r#""robot": "cell-robot.json","#)).unwrap();
    JointPath::new(&program, &Robot::default().with_name("cell")).unwrap();
    let fault = JointPath::new(&program, &Robot::default()).unwrap_err();
    assert!(matches!(fault, Fault::OtherRobot { .. }), "{fault}");
}

#[test]
fn the_flange_of_the_program_is_that_of_a_model_and_not_of_a_profile() {
    let source = ProgramSource::from_json(&text(r#""flange_mm": 126,"#)).unwrap();
    let flange_m = |robot: Option<Robot>| {
        let request = PlanRequest { robot, ..PlanRequest::default() };
        request.robot(&source).unwrap().lengths().flange_m
    };
    assert_eq!(flange_m(None), 0.126);
    assert_eq!(flange_m(Some(Robot::lbr_iiwa_14_r820())), 0.126);
    assert_eq!(flange_m(Some(Robot::default().with_flange_m(0.2).unwrap())), 0.2);
}

#[test]
fn profiles_are_read_beside_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("program.json");
    fs::write(&file, text(r#""robot": "arm.json","#)).unwrap();
    let load = || ProgramSource::load(&file).unwrap();
    let error = PlanRequest::default().plan(&load()).unwrap_err();
    assert!(error.to_string().starts_with("no robot is called `arm.json`:"), "{error}");
    assert_eq!(error.place().unwrap().to_string(), "line 1, column 26");
    // A missing profile does not matter if it is not used.
    let request = PlanRequest { robot: Some(Robot::default()), ..PlanRequest::default() };
    request.plan(&load()).unwrap();

    let profile = folder.path().join("arm.json");
    fs::write(&profile, "root:x:0:0:root").unwrap();
    let error = PlanRequest::default().plan(&load()).unwrap_err();
    assert!(matches!(error, Error::UnknownRobot { .. }), "{error}");
    assert!(!error.to_string().contains("root:"), "{error}");
    fs::write(&profile, r#"{ "version": 1, "robot": 5 }"#).unwrap();
    let error = PlanRequest::default().plan(&load()).unwrap_err();
    assert!(matches!(error, Error::Profile { .. }), "{error}");
    fs::write(&profile, Robot::lbr_iiwa_14_r820().with_name("arm").to_full_profile()).unwrap();
    let plan = PlanRequest::default().plan(&load()).unwrap();
    assert_eq!(plan.robot().name(), "arm");
    assert_eq!(plan.trajectory.cycle_time_s(), time_s(&PlanRequest::default(), R820));
}

#[test]
fn faults_have_their_motion_and_place() {
    let text = text("").replace("60", "190");
    let source = ProgramSource::from_json(&text).unwrap();
    let error = PlanRequest::default().plan(&source).unwrap_err();
    assert_eq!(error.motion().map(iiwa_program::MotionIndex::number), Some(1));
    assert_eq!(error.place().unwrap().to_string(), "line 2, column 57");
    assert!(error.to_string().ends_with(", at line 2, column 57"), "{error}");
    let Error::Plan { error, .. } = error else { panic!("{error}") };
    assert!(matches!(*error, PlanError::Fault(Fault::JointOutside { .. })));
}
