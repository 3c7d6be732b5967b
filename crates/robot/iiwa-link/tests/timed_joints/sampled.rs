//! Planned trajectories and their points.

use iiwa_kin::{Joints, Robot};
use iiwa_link::{
    TimedJoints,
    message::{Code, Refusal},
};
use iiwa_path::JointPath;
use iiwa_program::{Blend, Motion, Program, Ptp, Sources, Start, Workcell};
use iiwa_traj::{Timing, Trajectory};
use proptest::prelude::*;

/// Returns programs with fast and slow, long and tiny motions, blends and waits.
pub(crate) fn programs() -> impl Strategy<Value = Program> {
    let size = prop_oneof![4 => Just(1.2), 3 => Just(0.3), 1 => Just(1e-3), 1 => Just(0.0)];
    let step = (size, prop::array::uniform7(-1.0..1.0_f64));
    let share = || prop_oneof![2 => Just(1.0), 1 => 0.05..1.0_f64];
    let blend = prop_oneof![
        Just(None),
        (0.0..0.5_f64).prop_map(|b| Some(Blend::Fraction(b))),
        (1.0..200.0_f64).prop_map(|r| Some(Blend::CartMm(r))),
    ];
    let draft = (step, share(), share(), blend, prop::option::weighted(0.1, 0.0..0.5_f64));
    (prop::array::uniform7(-1.0..1.0_f64), prop::collection::vec(draft, 1..5))
        .prop_map(|(start_rad, drafts)| {
            let mut pose_rad = start_rad;
            let mut motions: Vec<_> = drafts
                .into_iter()
                .map(|((size, by), velocity, acceleration, blend, wait)| {
                    if let Some(seconds) = wait {
                        return Motion::Wait { seconds, overlap: 0 };
                    }
                    pose_rad =
                        std::array::from_fn(|j| (pose_rad[j] + size * by[j]).clamp(-2.0, 2.0));
                    Motion::Ptp(Ptp {
                        acceleration_rel: [acceleration; 7],
                        blend,
                        ..Ptp::to(pose_rad).velocity(velocity)
                    })
                })
                .collect();
            for i in 0..motions.len() {
                if !matches!(motions.get(i + 1), Some(Motion::Ptp(_)))
                    && let Motion::Ptp(ptp) = &mut motions[i]
                {
                    ptp.blend = None;
                }
            }
            Program {
                robot: None,
                start: Start::Joints(start_rad),
                motions,
                workcell: Workcell::default(),
                sources: Sources::default(),
            }
        })
        .prop_filter("a blend swings out of the limits", |program| {
            JointPath::new(program, &Robot::default()).is_ok()
        })
}

pub(crate) fn planned(program: &Program) -> Trajectory {
    let path = JointPath::new(program, &Robot::default()).unwrap();
    Trajectory::plan(&path, Timing::jerk_limited()).unwrap()
}

/// Returns points every `step_s`, and one at the end.
pub(crate) fn even(plan: &Trajectory, step_s: f64) -> TimedJoints {
    let count = (plan.cycle_time_s() / step_s).ceil() as u32;
    at_stamps(plan, (0..count).map(|i| f64::from(i) * step_s))
}

/// Returns points at these stamps, up to the end of the trajectory, and one at the end.
pub(crate) fn at_stamps(plan: &Trajectory, stamps: impl Iterator<Item = f64>) -> TimedJoints {
    let end_s = plan.cycle_time_s();
    // Planners do not create tiny last steps.
    let mut t_s: Vec<f64> = stamps.take_while(|t_s| *t_s < end_s - 1e-5).collect();
    t_s.push(end_s.max(t_s.last().map_or(0.0, |last| last + 1e-3)));
    if t_s.len() < 2 {
        t_s.insert(0, 0.0);
    }
    let joints_rad = t_s.iter().map(|t_s| plan.at(*t_s).q).collect();
    TimedJoints { t_s, joints_rad }
}

pub(crate) fn rounded(trajectory: &TimedJoints) -> TimedJoints {
    let round = |x: f64| (x * 1e6).round() / 1e6;
    TimedJoints {
        t_s: trajectory.t_s.iter().map(|t_s| round(*t_s)).collect(),
        joints_rad: trajectory.joints_rad.iter().map(|q| q.map(round)).collect(),
    }
}

pub(crate) fn check(trajectory: &TimedJoints) -> Result<(), Refusal> {
    let start = trajectory.joints_rad.first().copied().unwrap_or_default();
    trajectory.check(Robot::default().limits(), &start)
}

pub(crate) fn assert_refused(trajectory: &TimedJoints, label: &str) -> Refusal {
    let refusal = check(trajectory).expect_err(label);
    assert_eq!(refusal.code, Code::Limit, "{refusal}");
    refusal
}

pub(crate) fn distance(a: &Joints, b: &Joints) -> f64 {
    (0..7).map(|j| (a[j] - b[j]).abs()).fold(0.0, f64::max)
}
