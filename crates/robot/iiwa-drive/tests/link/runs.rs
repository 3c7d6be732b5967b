//! Runs through the simulated cabinet keep the planned time and path.

use iiwa_kin::{Joints, Robot};
use iiwa_link::{
    ClientError, TimedJoints,
    message::{Code, DriveState, Run},
};
use iiwa_path::JointPath;
use iiwa_program::{Blend, Motion, MotionList, Ptp};
use iiwa_traj::{Timing, Trajectory};
use iiwasim_tests::realtime_guard::in_real_time;

use crate::link::rig::{LONG, Rig};

pub(crate) fn motions() -> Vec<Motion> {
    let rad = |deg: Joints| deg.map(f64::to_radians);
    vec![
        Motion::Ptp(
            Ptp::to(rad([10.0, 20.0, 0.0, -40.0, 0.0, 30.0, 0.0])).blend(Blend::Fraction(0.25)),
        ),
        Motion::Ptp(Ptp::to(rad([30.0, 10.0, 5.0, -60.0, 0.0, 50.0, 20.0])).velocity(0.5)),
        Motion::Wait { seconds: 0.1, overlap: 0 },
        Motion::Ptp(Ptp::to(rad([0.0, 10.0, 5.0, -50.0, 0.0, 50.0, 0.0]))),
    ]
}

pub(crate) fn planned(motions: Vec<Motion>) -> Trajectory {
    planned_from([0.0; 7], motions.into())
}

pub(crate) fn planned_from(start_rad: Joints, motions: MotionList) -> Trajectory {
    planned_with(Timing::default(), start_rad, motions)
}

/// Returns a plan that may be commanded point by point: jerk-limited.
pub(crate) fn to_command(motions: Vec<Motion>) -> Trajectory {
    to_command_from([0.0; 7], motions.into())
}

pub(crate) fn to_command_from(start_rad: Joints, motions: MotionList) -> Trajectory {
    planned_with(Timing::jerk_limited(), start_rad, motions)
}

fn planned_with(timing: Timing, start_rad: Joints, motions: MotionList) -> Trajectory {
    let path = JointPath::new(&motions.starting_at(start_rad), &Robot::default()).unwrap();
    Trajectory::plan(&path, timing).unwrap()
}

/// Asserts that the run took the planned time, within a cycle, on the planned path.
pub(crate) fn assert_as_planned(run: &Run, plan: &Trajectory, period_s: f64) {
    let cycle_time_s = run.cycle_time_s.unwrap();
    let late_s = cycle_time_s - plan.cycle_time_s();
    assert!((-1e-6..period_s + 1e-6).contains(&late_s), "late by {late_s} s");
    let start_s = run.start_s.unwrap();
    let mut worst = 0.0_f64;
    for (t_s, q) in run.samples.t_s.iter().zip(&run.samples.joints_rad) {
        let expected = plan.at(t_s - start_s).q;
        worst = (0..7).map(|j| (q[j] - expected[j]).abs()).fold(worst, f64::max);
    }
    assert!(worst < 1e-3, "off by {worst} rad");
    let first = *run.samples.t_s.first().unwrap();
    let last = *run.samples.t_s.last().unwrap();
    assert!(first <= start_s && (last - start_s - cycle_time_s).abs() < 1e-6);
    // No sample is missing.
    let count = ((last - first) / period_s).round() as usize + 1;
    assert_eq!(run.samples.t_s.len(), count);
    println!("late by {late_s:.6} s, off by {worst:.1e} rad, {count} samples");
}

#[test]
fn motions_take_the_planned_time_and_path() {
    for period_ms in [5, 1] {
        let rig = Rig::new(period_ms);
        let run = rig.client().run_motions(motions(), Some(LONG)).unwrap();
        assert_as_planned(&run, &planned(motions()), f64::from(period_ms) * 1e-3);
        assert_eq!(rig.client().state().unwrap().state, DriveState::Idle);
        assert_eq!(rig.client().last_run().unwrap(), run);
    }
}

pub(crate) fn sampled(plan: &Trajectory, step_s: f64) -> TimedJoints {
    let count = (plan.cycle_time_s() / step_s).ceil();
    let t_s: Vec<f64> =
        (0..=count as u32).map(|i| (f64::from(i) * step_s).min(plan.cycle_time_s())).collect();
    let joints_rad = t_s.iter().map(|t_s| plan.at(*t_s).q).collect();
    TimedJoints { t_s, joints_rad }
}

/// Runs a trajectory from the start.
fn commanded(period_ms: u32, trajectory: &TimedJoints) -> (Rig, Run) {
    let rig = Rig::new(period_ms);
    let run = rig.client().run_trajectory(trajectory.clone(), Some(LONG)).unwrap();
    (rig, run)
}

#[test]
fn trajectories_take_their_time_and_path() {
    in_real_time(|| {
        for period_ms in [5, 1] {
            let plan = to_command(motions());
            let (rig, run) = commanded(period_ms, &sampled(&plan, 0.004));
            assert_as_planned(&run, &plan, f64::from(period_ms) * 1e-3);
            assert_eq!(rig.client().state().unwrap().state, DriveState::Idle);
        }
    });
}

/// Motions to the ends of the joint ranges and back at full speed: set-points between points do not
/// overshoot.
#[test]
fn trajectories_reach_the_ends_of_the_range() {
    in_real_time(|| {
        let range = Robot::default().limits().upper_rad;
        let mut far = [0.0; 7];
        (far[0], far[3], far[6]) = (range[0], -range[3], range[6]);
        let plan = to_command(vec![Motion::Ptp(Ptp::to(far)), Motion::Ptp(Ptp::to([0.0; 7]))]);
        for step_s in [0.004, 0.0071] {
            let (_, run) = commanded(5, &sampled(&plan, step_s));
            assert_as_planned(&run, &plan, 0.005);
            let furthest = run.samples.joints_rad.iter().map(|q| q[0]).fold(0.0, f64::max);
            assert!((furthest - range[0]).abs() < 1e-6, "{furthest} rad");
        }
    });
}

#[test]
fn a_trajectory_from_elsewhere_is_refused() {
    let rig = Rig::new(5);
    let mut trajectory = sampled(&to_command(motions()), 0.004);
    for q in &mut trajectory.joints_rad {
        q[3] -= 0.6_f64.to_radians();
    }
    let error = rig.client().run_trajectory(trajectory, Some(LONG)).unwrap_err();
    let ClientError::Refused { refusal, .. } = error else { panic!("{error}") };
    assert_eq!(refusal.code, Code::StartMismatch);
    assert!(refusal.message.contains("joint A4"), "{refusal}");
}
