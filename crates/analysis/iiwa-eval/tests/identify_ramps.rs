//! Identification of the ramp law under Sunrise from recordings of virtual robots with other laws
//! than the model's.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_eval::{
    Estimate, VirtualRobot,
    identify::{Identified, LineLaw, LineObservation, RecordedRun, identify},
};
use iiwa_kin::{Joints, Robot};
use iiwa_log::JointLog;
use iiwa_plan::PlanOptions;
use iiwa_program::{Motion, Program, Ptp};
use iiwa_traj::{JerkOptions, Timing, Trajectory};

/// Targets of motions of a real robot, each followed by a return to zero, in degrees; and two that
/// are limited by A4.
const POSES_DEG: [Joints; 9] = [
    [129.33, 52.41, -79.13, 27.55, -159.39, 102.38, 38.65],
    [84.01, 79.34, -79.73, 86.9, -168.39, 97.04, 10.74],
    [84.64, 70.5, -71.65, 83.28, -159.74, 95.38, 19.59],
    [99.92, 59.0, -77.68, 39.1, -148.45, 118.74, 35.97],
    [74.14, 55.86, -59.15, 74.19, -142.17, 100.15, 34.76],
    [106.16, 72.91, -78.32, 66.76, -167.27, 93.4, 17.11],
    [-38.0, 72.0, -58.0, 116.0, 126.0, 18.0, -94.0],
    [-83.15, 1.59, 8.73, -38.44, -13.83, 33.06, 40.0],
    [-21.0, 66.0, -62.0, 91.0, 137.0, 26.0, -107.0],
];

fn sunrise() -> PlanOptions {
    PlanOptions::with_timing(Timing::Sunrise(JerkOptions::default()))
}

/// Creates a program to some poses, with a return to zero from each.
fn program(poses: &[Joints]) -> Program {
    let ptp = |deg: &Joints| Motion::Ptp(Ptp::to(deg.map(f64::to_radians)));
    let motions = poses.iter().flat_map(|pose| [ptp(pose), ptp(&[0.0; 7])]).collect();
    Program { motions, ..Program::from_json(EMPTY).unwrap() }
}

const EMPTY: &str = r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
    "motions": [{ "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 1] }] }"#;

/// Returns a robot with other limits and another law than the model.
fn other_robot() -> Robot {
    let model = Robot::default();
    let mut limits = *model.limits();
    limits.velocity_rad_s = limits.velocity_rad_s.map(|limit| 1.0003 * limit);
    limits.acceleration_rad_s2 = limits.acceleration_rad_s2.map(|limit| 0.95 * limit);
    let mut law = *model.ramp_law();
    law.torque_snap_nm_s2 = law.torque_snap_nm_s2.map(|limit| 1.12 * limit);
    for (limits, share) in [(&mut law.start_nm_s, 0.9), (&mut law.stop_nm_s, 0.8)] {
        *limits = limits.map(|limit| (share * limit).min(1e9));
    }
    model.with_limits(limits).with_ramp_law(law)
}

fn recorded(program: &Program, noise_rad: f64, period_s: f64) -> JointLog {
    let mut robot = VirtualRobot::new(other_robot(), 5);
    (robot.noise_rad, robot.period_s, robot.plan) = (noise_rad, period_s, sunrise());
    robot.run(program).unwrap()
}

/// Returns the largest relative error of the estimates of the joints, and their number.
fn worst(estimates: &[Option<Estimate>; 7], truth: &Joints) -> (f64, usize) {
    let off = estimates.iter().zip(truth).filter_map(|(estimates, truth)| {
        let estimates = (*estimates)?;
        let off = (estimates.value - truth).abs();
        assert!(off < (2.0 * estimates.uncertainty).max(1e-5 * truth), "{estimates} {truth}");
        Some((estimates.value / truth - 1.0).abs())
    });
    off.fold((0.0, 0), |(worst, count), off| (f64::max(worst, off), count + 1))
}

/// Checks limits and law, each within a share.
fn check(identified: &Identified, shares: [f64; 3]) {
    let robot = other_robot();
    let (limits, law) = (robot.limits(), robot.ramp_law());
    assert!(
        identified.lines.iter().all(|line| line.law == LineLaw::Snap && !line.is_unexplained())
    );
    let ramps = identified.ramps.as_ref().unwrap();
    for (quantity, figures, truth, share, min_count) in [
        ("velocity", &identified.velocity_rad_s, &limits.velocity_rad_s, shares[0], 2),
        (
            "acceleration",
            &identified.acceleration_rad_s2,
            &limits.acceleration_rad_s2,
            shares[0],
            2,
        ),
        ("S", &ramps.torque_snap_nm_s2, &law.torque_snap_nm_s2, shares[1], 1),
        ("R at starts", &ramps.start_nm_s, &law.start_nm_s, shares[2], 2),
        ("R at stops", &ramps.stop_nm_s, &law.stop_nm_s, shares[2], 2),
    ] {
        let (off, count) = worst(figures, truth);
        assert!(off < share && count >= min_count, "{quantity}: {count} joints within {off}");
    }
}

#[test]
fn a_law_is_found_without_noise() {
    let program = program(&POSES_DEG);
    let log = recorded(&program, 0.0, 1e-3);
    let recordings = [RecordedRun { program: &program, log: &log }];
    check(&identify(&recordings, &Robot::default()).unwrap(), [1e-6, 1e-3, 1e-3]);
}

#[test]
fn a_law_is_found_in_noise() {
    let program = program(&POSES_DEG);
    let log = recorded(&program, 3e-6, 1e-3);
    let recordings = [RecordedRun { program: &program, log: &log }];
    check(&identify(&recordings, &Robot::default()).unwrap(), [1e-4, 0.02, 0.02]);
}

/// At 20 Hz and an override of 30 %, as the recording of a real robot.
#[test]
fn a_law_is_found_at_an_override() {
    let mut program = program(&POSES_DEG);
    program.workcell.speed_override = Some(0.3);
    let log = recorded(&program, 1e-9, 0.05);
    let actual =
        identify(&[RecordedRun { program: &program, log: &log }], &Robot::default()).unwrap();
    check(&actual, [1e-6, 1e-3, 1e-3]);
    // Pauses are not scaled.
    assert!(actual.settle.unwrap().mean_s.holds(0.05));
    // At another override than stated, the limits differ.
    program.workcell.speed_override = None;
    let actual =
        identify(&[RecordedRun { program: &program, log: &log }], &Robot::default()).unwrap();
    let velocity = actual.velocity_rad_s[0].unwrap().value;
    assert!((velocity / (0.3 * 1.0003 * 98_f64.to_radians()) - 1.0).abs() < 0.01, "{velocity}");
}

/// Results from one half of the motions predict the durations of the other half.
#[test]
fn one_half_predicts_the_other() {
    let every_other =
        |from: usize| -> Vec<Joints> { POSES_DEG.iter().skip(from).step_by(2).copied().collect() };
    let observed = program(&every_other(0));
    let log = recorded(&observed, 3e-6, 1e-3);
    let actual =
        identify(&[RecordedRun { program: &observed, log: &log }], &Robot::default()).unwrap();
    let robot = actual.robot(&Robot::default());
    let unseen = program(&every_other(1));
    let durations = |robot: &Robot| -> Vec<f64> {
        let plan: Trajectory = sunrise().plan(&unseen, robot).unwrap();
        plan.motions().iter().map(|motion| motion.end_s - motion.start_s).collect()
    };
    let [predicted, model, truth] = [&robot, &Robot::default(), &other_robot()].map(durations);
    let worst = |some: &[f64]| {
        some.iter().zip(&truth).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max)
    };
    println!("predicted within {:.1e}, by the model {:.1e}", worst(&predicted), worst(&model));
    assert!(worst(&predicted) < 5e-3, "{:.1e}", worst(&predicted));
}

/// A motion that follows neither law is detected, such as one during which the override changes.
#[test]
fn unexplained_motions_are_reported() {
    let program = program(&POSES_DEG[..2]);
    let mut log = recorded(&program, 1e-8, 1e-3);
    // The clock is stretched and compressed in turn, as if the override varied within each motion.
    let slow = |t_s: f64| t_s + 0.02 * (6.0 * t_s).sin();
    for t_s in &mut log.t_s {
        *t_s = slow(*t_s);
    }
    let actual =
        identify(&[RecordedRun { program: &program, log: &log }], &Robot::default()).unwrap();
    assert!(actual.lines.iter().any(LineObservation::is_unexplained), "{:?}", actual.lines);
}
