//! Replanning: plans after a change are as good as plans from scratch, and unchanged after an
//! error.

// Test helpers may panic.
#![allow(clippy::unwrap_used)]

use fastrand::Rng;
use iiwa_kin::Robot;
use iiwa_path::{JointPath, PathOptions};
use iiwa_program::{Blend, Motion, MotionIndex, Program, Ptp, Sources, Start, Workcell};
use iiwa_traj::{JerkOptions, PlanError, Replanner, Timing, Trajectory};
use iiwasim_tests::{extremes::extremes, families::Family, tolerances::RATIOS};

/// Cycle time by which a plan may be slower than one from scratch, relative.
const BAR: f64 = 1e-3;

fn replanner(program: &Program) -> Replanner {
    let robot = Robot::default();
    Replanner::new(program.clone(), &robot, PathOptions::default(), JerkOptions::default()).unwrap()
}

fn cold(program: &Program) -> Trajectory {
    let path = JointPath::new(program, &Robot::default()).unwrap();
    Trajectory::plan(&path, Timing::jerk_limited()).unwrap()
}

/// Returns a motion with another target, speed or blend.
fn changed(rng: &mut Rng, ptp: &Ptp) -> Motion {
    let mut ptp = ptp.clone();
    match rng.u32(0..4) {
        0 => ptp.velocity_rel = [rng.f64().mul_add(0.8, 0.2); 7],
        1 if ptp.blend.is_some() => ptp.blend = Some(Blend::Fraction(0.45 * rng.f64() + 0.05)),
        2 => ptp.blend = None,
        _ => ptp.target_rad.iter_mut().for_each(|q| *q *= rng.f64().mul_add(0.2, 0.85)),
    }
    Motion::Ptp(ptp)
}

#[test]
fn changes_are_planned_as_well_as_programs() {
    let mut rng = Rng::with_seed(3);
    let mut replaced = 0;
    for index in 0..30 {
        let drawn = Family::Plain.program(5, index).program;
        let mut plan = replanner(&drawn);
        assert!((plan.cycle_time_s() - cold(&drawn).cycle_time_s()).abs() < 1e-9);
        for _ in 0..6 {
            let motion = rng.usize(0..drawn.motions.len());
            let Motion::Ptp(ptp) = &plan.program().motions[motion] else { continue };
            let new = changed(&mut rng, ptp);
            let before = plan.program().clone();
            if plan.replace(MotionIndex::new(motion), new).is_err() {
                assert_eq!(*plan.program(), before);
                continue;
            }
            replaced += 1;
            let trajectory = plan.trajectory();
            let whole_s = trajectory.cycle_time_s();
            assert!((whole_s - plan.cycle_time_s()).abs() < 1e-9, "{whole_s} {:?}", plan.program());
            let expected_s = cold(plan.program()).cycle_time_s();
            let slower = plan.cycle_time_s() / expected_s - 1.0;
            assert!(slower < BAR, "program {index}, motion {motion}: {slower:e}");

            // Limits hold at each patched place, and time increases.
            let actual = extremes(&trajectory, Timing::jerk_limited());
            for (ratio, allowed) in actual.ratios().into_iter().zip(RATIOS) {
                assert!(
                    ratio <= allowed,
                    "program {index}, motion {motion}: {:?}",
                    actual.ratios()
                );
            }
            assert!(actual.jumps.iter().all(|jump| *jump < 1e-6), "{:?}", actual.jumps);
            let states: Vec<_> = trajectory.states().collect();
            assert!(states.windows(2).all(|pair| pair[0].t_s < pair[1].t_s));
        }
    }
    assert!(replaced > 100, "{replaced}");
}

#[test]
fn an_error_leaves_everything_as_it_was() {
    let program = Family::Plain.program(5, 1).program;
    let mut plan = replanner(&program);
    let before_s = plan.cycle_time_s();
    let Motion::Ptp(ptp) = &program.motions[0] else { panic!("{:?}", program.motions[0]) };
    let outside = Ptp { target_rad: [9.0; 7], ..ptp.clone() };
    let error = plan.replace(MotionIndex::new(0), Motion::Ptp(outside)).unwrap_err();
    assert!(matches!(error, PlanError::Fault(_)), "{error}");
    assert_eq!(*plan.program(), program);
    assert_eq!(plan.cycle_time_s().to_bits(), before_s.to_bits());
    assert_eq!(plan.path().steps().len(), cold(&program).path().steps().len());
}

#[test]
fn stops_come_and_go() {
    let via = [0.4, 0.2, 0.0, -0.9, 0.0, 0.6, 0.0];
    let mut motions: Vec<_> = [0.0, 0.5, -0.5, 0.7, -0.3]
        .map(|q| {
            Motion::Ptp(
                Ptp::to([q, 0.3 * q, 0.0, -0.8, 0.1 * q, 0.4, 0.0]).blend(Blend::Fraction(0.3)),
            )
        })
        .to_vec();
    motions.push(Motion::Ptp(Ptp::to([0.0; 7])));
    let mut plan = replanner(&Program {
        robot: None,
        start: Start::Joints([0.3; 7]),
        motions,
        workcell: Workcell::default(),
        sources: Sources::default(),
    });
    let sections = |plan: &Replanner| plan.trajectory().sections().len();
    let is_as_cold = |plan: &Replanner| {
        let expected_s = cold(plan.program()).cycle_time_s();
        assert!((plan.cycle_time_s() / expected_s - 1.0).abs() < BAR, "{expected_s}");
    };
    assert_eq!(sections(&plan), 1);
    let middle = MotionIndex::new(2);
    plan.replace(middle, Motion::Ptp(Ptp::to(via))).unwrap();
    is_as_cold(&plan);
    assert_eq!(sections(&plan), 2);
    // A blend into a wait is invalid, so the motion before must stop first.
    assert!(plan.replace(middle, Motion::Wait { seconds: 1.0, overlap: 0 }).is_err());
    let Motion::Ptp(before) = plan.program().motions[1].clone() else { panic!() };
    plan.replace(MotionIndex::new(1), Motion::Ptp(Ptp { blend: None, ..before.clone() })).unwrap();
    assert_eq!(sections(&plan), 3);
    plan.replace(middle, Motion::Wait { seconds: 1.0, overlap: 0 }).unwrap();
    is_as_cold(&plan);
    assert_eq!(sections(&plan), 2);
    plan.replace(middle, Motion::Ptp(Ptp::to(via).blend(Blend::Fraction(0.4)))).unwrap();
    plan.replace(MotionIndex::new(1), Motion::Ptp(before)).unwrap();
    is_as_cold(&plan);
    assert_eq!(sections(&plan), 1);
    // The same target twice: nothing moves in between.
    plan.replace(middle, plan.program().motions[1].clone()).unwrap();
    is_as_cold(&plan);
}
