//! Runs planned for a robot other than the drive's, and drives configured for a robot other than
//! the cabinet's.

use iiwa_kin::Robot;
use iiwa_link::{
    ClientError,
    message::{Code, Refusal, Request, RobotIdentity, RunLabel},
};

use crate::link::{
    rig::{LONG, Rig, wait_for},
    runs::{motions, sampled, to_command},
};

const OURS: &str = "lbr_iiwa_7_r800 with a flange of 152 mm";

/// Returns robots other than the drive's, and their names in messages.
fn others() -> [(Robot, &'static str); 2] {
    let plain = Robot::lbr_iiwa_7_r800().with_flange_m(0.126).unwrap();
    [
        (Robot::lbr_iiwa_14_r820(), "lbr_iiwa_14_r820 with a flange of 152 mm"),
        (plain, "lbr_iiwa_7_r800 with a flange of 126 mm"),
    ]
}

/// Returns the refusals of motions and of a trajectory with this label.
fn refusals(rig: &Rig, label: &RunLabel) -> [Refusal; 2] {
    let trajectory = sampled(&to_command(motions()), 0.005);
    [Request::motions(motions()), Request::trajectory(trajectory)].map(|request| {
        match rig.client().run(&request.labelled(label.clone()), Some(LONG)) {
            Err(ClientError::Refused { refusal, run }) => {
                let moved = run.is_some_and(|run| !run.samples.t_s.is_empty());
                assert!(!moved, "a part of the run was carried out");
                refusal
            }
            other => panic!("{other:?}"),
        }
    })
}

#[test]
fn a_run_for_another_robot_is_refused() {
    let rig = Rig::new(5);
    let before = rig.client().state().unwrap();
    assert_eq!(before.robot, Some(RobotIdentity::from(&Robot::default())));
    for (robot, name) in others() {
        for refusal in refusals(&rig, &RunLabel::of_robot(&robot)) {
            assert_eq!(refusal.code, Code::BadRequest);
            let message = refusal.message;
            assert!(message.contains(name) && message.contains(OURS), "{message}");
        }
    }
    let after = rig.client().state().unwrap();
    assert_eq!(after.joints_rad, before.joints_rad, "the arm has moved");
    // The drive's robot, under the name of a profile.
    let profile = Robot::from_profile(r#"{"version": 1, "name": "cell 3"}"#).unwrap();
    let request = Request::motions(motions()).labelled(RunLabel::of_robot(&profile));
    rig.client().run(&request, Some(LONG)).unwrap();
}

#[test]
fn nothing_runs_while_another_robot_is_at_the_cabinet() {
    for (robot, name) in others() {
        let mut rig = Rig::parts(5);
        // The robot program in Java does not know the simulated robot.
        rig.jar = None;
        rig.drive_config.robot = robot.clone();
        rig.start_drive();
        rig.start_cabinet();
        rig.wait_until_ready();
        let status = rig.client().state().unwrap();
        assert_eq!(
            status.hello.as_ref().unwrap().robot,
            Some(RobotIdentity::from(&Robot::default()))
        );
        let text = status.text();
        assert!(text.contains(&format!("robot          {name}\n")), "{text}");
        assert!(text.contains(&format!("the cabinet has another robot: {OURS}\n")), "{text}");
        for label in [RunLabel::default(), RunLabel::of_robot(&robot)] {
            for refusal in refusals(&rig, &label) {
                assert_eq!(refusal.code, Code::Robot);
                let message = refusal.message;
                assert!(message.contains(name) && message.contains(OURS), "{message}");
            }
        }
        // A stop is always answered.
        rig.stop();
        let moved = rig.cabinet().position().iter().any(|q| q.abs() > 1e-9);
        assert!(!moved, "the arm has moved");
    }
}

#[test]
fn the_check_of_the_connection_names_both_robots() {
    let mut rig = Rig::parts(5);
    rig.jar = None;
    rig.drive_config.robot = Robot::lbr_iiwa_14_r820();
    rig.start_cabinet();
    wait_for("the check", || {
        let check = iiwa_drive::LinkCheck::run(&rig.drive_config, &rig.remote, |_| ());
        let steps = check.steps.iter();
        let text: String =
            steps.filter(|it| it.step == "robot program").map(|it| it.text.as_str()).collect();
        !check.ok && text.contains("lbr_iiwa_14_r820") && text.contains(OURS)
    });
}
