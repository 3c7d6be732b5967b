//! Straight motions from rest to rest under jerk limits, against ruckig: the implementation of
//! the crate `rsruckig`.

use iiwa_kin::{Joints, Robot};
use iiwa_path::JointPath;
use iiwa_program::{LimitKind, Motion, MotionLimits, Program, Ptp, Sources, Start, Workcell};
use iiwa_traj::{Timing, Trajectory};
use proptest::{
    prelude::*,
    strategy::ValueTree,
    test_runner::{RngSeed, TestRunner},
};
use rsruckig::prelude::{
    DataArrayOrVec, InputParameter, Ruckig, Synchronization, ThrowErrorHandler,
    Trajectory as RuckigTrajectory,
};

fn found_s(start: Joints, ptp: &Ptp) -> f64 {
    let program = Program {
        robot: None,
        start: Start::Joints(start),
        motions: vec![Motion::Ptp(ptp.clone())],
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let path = JointPath::new(&program, &Robot::lbr_iiwa_7_r800()).unwrap();
    Trajectory::plan(&path, Timing::jerk_limited()).unwrap().motion_time_s()
}

/// Random motions, some short, some with shares of the limits.
fn random_moves(count: usize) -> Vec<(Joints, Ptp)> {
    let config = ProptestConfig { rng_seed: RngSeed::Fixed(2021), ..ProptestConfig::default() };
    let share = || prop_oneof![2 => Just(1.0), 1 => 0.05..1.0_f64];
    let joints = || prop::array::uniform7(-1.0..1.0_f64);
    let size = prop_oneof![Just(1.5), Just(0.2), Just(0.01)];
    let one = (joints(), joints(), size, share(), share(), share()).prop_map(
        |(start, step, size, v, a, j)| {
            let ptp = Ptp {
                velocity_rel: [v; 7],
                acceleration_rel: [a; 7],
                jerk_rel: [j; 7],
                ..Ptp::to(std::array::from_fn(|i| 0.5 * start[i] + size * step[i]))
            };
            (start.map(|q| 0.5 * q), ptp)
        },
    );
    let all = prop::collection::vec(one, count);
    all.new_tree(&mut TestRunner::new(config)).unwrap().current()
}

/// Duration of ruckig's phase-synchronised motion, and how far it strays from the line as a share
/// of the way.
fn ruckig(start: &Joints, ptp: &Ptp) -> (f64, f64) {
    let robot = MotionLimits::full(&Robot::lbr_iiwa_7_r800());
    let cases_of = |kind| {
        let (limit, share) = (robot.of(kind), ptp.share(kind));
        DataArrayOrVec::Stack(std::array::from_fn(|i| limit[i] * share[i]))
    };
    let mut input = InputParameter::<7>::new(None);
    input.synchronization = Synchronization::Phase;
    input.current_position = DataArrayOrVec::Stack(*start);
    input.target_position = DataArrayOrVec::Stack(ptp.target_rad);
    input.max_velocity = cases_of(LimitKind::Velocity);
    input.max_acceleration = cases_of(LimitKind::Acceleration);
    input.max_jerk = cases_of(LimitKind::Jerk);
    let mut trajectory = RuckigTrajectory::new(None);
    Ruckig::<7, ThrowErrorHandler>::new(None, 1e-3).calculate(&input, &mut trajectory).unwrap();
    let duration_s = trajectory.get_duration();
    let mut astray = 0.0_f64;
    for i in 0..=200 {
        let mut q = DataArrayOrVec::Stack([0.0; 7]);
        let t_s = duration_s * f64::from(i) / 200.0;
        trajectory.at_time(t_s, &mut Some(&mut q), &mut None, &mut None, &mut None, &mut None);
        let shares = (0..7).map(|j| (q[j] - start[j]) / (ptp.target_rad[j] - start[j]));
        let (lowest, highest) = shares.fold((f64::MAX, f64::MIN), |(l, m), s| (l.min(s), m.max(s)));
        astray = astray.max(highest - lowest);
    }
    (duration_s, astray)
}

/// Ruckig may leave the line without an error if several joints limit the motion: such motions do
/// not count.
#[test]
fn as_ruckig_does_where_it_stays_on_the_line() {
    let moves = random_moves(200);
    let (mut stays, mut largest) = (0, 0.0_f64);
    for (start, ptp) in &moves {
        let (expected, astray) = ruckig(start, ptp);
        let actual_s = found_s(*start, ptp);
        if astray < 1e-6 {
            stays += 1;
            let error = (actual_s / expected - 1.0).abs();
            assert!(error < 1e-6, "{actual_s} s, ruckig {expected} s: {start:?} {ptp:?}");
            largest = largest.max(error);
        } else {
            // Off the line it is no slower than on it.
            assert!(expected <= actual_s * (1.0 + 1e-9), "{actual_s} s, ruckig {expected} s");
        }
    }
    println!("on the line: {stays} of {}, largest error {largest:e}", moves.len());
    assert!(10 * stays >= 8 * moves.len());
}
