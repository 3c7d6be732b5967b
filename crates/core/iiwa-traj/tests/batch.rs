//! Batches of programs yield the same plans as single programs.

use iiwa_kin::{Joint, Robot};
use iiwa_path::{BlendShape, JointPath, PathOptions};
use iiwa_program::{Blend, Fault, Motion, Program, Ptp, Sources, Start, Workcell};
use iiwa_traj::{PlanError, State, SweepOptions, Timing, Trajectory, plan_all};
use rayon::ThreadPoolBuilder;

/// Creates programs that differ in length and in time.
fn programs(count: u32) -> Vec<Program> {
    let corner = |k: u32, to: f64| {
        Motion::Ptp(Ptp::to([to, 0.1 * f64::from(k % 7), 0.0, -1.0, 0.0, 0.7, 0.0]))
    };
    let program = |k: u32| {
        let mut motions: Vec<_> =
            (0..=k % 5).map(|i| corner(k + i, if i % 2 == 0 { 1.0 } else { -1.0 })).collect();
        let last = motions.len() - 1;
        for motion in &mut motions[..last] {
            if let Motion::Ptp(ptp) = motion {
                ptp.blend = Some(Blend::Fraction(0.3));
            }
        }
        motions.push(Motion::Wait { seconds: f64::from(k), overlap: 0 });
        Program {
            robot: None,
            start: Start::Joints([0.0; 7]),
            motions,
            workcell: Workcell::default(),
            sources: Sources::default(),
        }
    };
    (0..count).map(program).collect()
}

/// Returns all values from which an output file would be written.
fn states(trajectory: &Trajectory) -> Vec<State> {
    trajectory.states().collect()
}

#[test]
fn the_same_as_one_by_one_and_in_order() {
    let robot = Robot::lbr_iiwa_14_r820();
    let options =
        PathOptions { blend_shape: BlendShape::MinAcceleration, ..PathOptions::default() };
    let timing = Timing::Acceleration(SweepOptions { samples: 30 });
    let programs = programs(64);
    let plans = plan_all(&programs, &robot, options, timing);
    assert_eq!(plans.len(), programs.len());
    for (program, plan) in programs.iter().zip(&plans) {
        let path = JointPath::with_options(program, &robot, options).unwrap();
        let alone = Trajectory::plan(&path, timing).unwrap();
        let plan = plan.as_ref().unwrap();
        assert_eq!(states(plan), states(&alone));
        assert_eq!(plan.totals(), alone.totals());
        assert_eq!(plan.path().robot().name(), "lbr_iiwa_14_r820");
    }
}

#[test]
fn a_bad_program_has_its_error_in_its_place_only() {
    let mut programs = programs(9);
    programs[4].motions.clear();
    programs[7].start = Start::Joints([0.0, 0.0, 0.0, f64::NAN, 0.0, 0.0, 0.0]);
    let robot = Robot::lbr_iiwa_7_r800();
    let plans = plan_all(&programs, &robot, PathOptions::default(), Timing::jerk_limited());
    for (k, plan) in plans.iter().enumerate() {
        match k {
            4 => {
                let error = plan.as_ref().unwrap_err();
                assert_eq!(error, &PlanError::Fault(Fault::NoMotions));
                assert_eq!(error.to_string(), Fault::NoMotions.to_string());
            }
            7 => {
                let error = plan.as_ref().unwrap_err();
                assert!(
                    matches!(
                        error,
                        PlanError::Fault(Fault::JointOutside { outside, .. })
                            if outside.joint == Joint::A4
                    ),
                    "{error}"
                );
            }
            _ => assert!(plan.is_ok(), "{k}"),
        }
    }
}

#[test]
fn any_pool_will_do() {
    let programs = programs(20);
    let plan = || {
        let robot = Robot::lbr_iiwa_7_r800();
        plan_all(&programs, &robot, PathOptions::default(), Timing::jerk_limited())
            .into_iter()
            .map(|plan| states(&plan.unwrap()))
            .collect::<Vec<_>>()
    };
    for threads in [1, 5] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(plan), plan());
    }
    let none =
        plan_all(&[], &Robot::lbr_iiwa_7_r800(), PathOptions::default(), Timing::jerk_limited());
    assert!(none.is_empty());
}
