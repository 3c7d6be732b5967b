//! Sections that are too long to be solved as a whole.

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::{Blend, Motion, Program, Ptp, Sources, Start, Workcell};
use iiwa_traj::{JerkOptions, State, Timing, Trajectory};
use iiwasim_tests::differences::ratios;
use proptest::{
    prelude::*,
    strategy::ValueTree,
    test_runner::{RngSeed, TestRunner},
};

/// Returns a random program without a stop, the same at each call.
fn path(motions: usize, blend: &BoxedStrategy<Blend>) -> JointPath {
    let share = || prop_oneof![3 => Just(1.0), 1 => 0.1..1.0_f64];
    let joints = || prop::array::uniform7(-1.0..1.0_f64);
    let motion = (joints(), share(), share(), share(), blend.clone()).prop_map(
        |(target, v, a, j, blend)| Ptp {
            acceleration_rel: [a; 7],
            jerk_rel: [j; 7],
            ..Ptp::to(target).velocity(v).blend(blend)
        },
    );
    let path = prop::collection::vec(motion, motions).prop_filter_map("swings out", |mut all| {
        all.last_mut()?.blend = None;
        let motions = all.into_iter().map(Motion::Ptp).collect();
        JointPath::new(
            &Program {
                robot: None,
                start: Start::Joints([0.0; 7]),
                motions,
                workcell: Workcell::default(),
                sources: Sources::default(),
            },
            &Robot::default(),
        )
        .ok()
    });
    let config = ProptestConfig { rng_seed: RngSeed::Fixed(7), ..ProptestConfig::default() };
    path.new_tree(&mut TestRunner::new(config)).unwrap().current()
}

fn blends() -> [BoxedStrategy<Blend>; 3] {
    [
        (0.05..0.5_f64).prop_map(Blend::Fraction).boxed(),
        // No lines in between, or slivers.
        prop_oneof![Just(Blend::Fraction(0.5)), Just(Blend::Fraction(0.3))].boxed(),
        (5.0..200.0_f64).prop_map(Blend::CartMm).boxed(),
    ]
}

/// Solving in parts gives the same duration as solving as a whole.
#[test]
fn parts_make_no_difference() {
    for blend in blends() {
        let path = path(70, &blend);
        let parts = Trajectory::plan(&path, Timing::jerk_limited()).unwrap().motion_time_s();
        let whole = Timing::Jerk(JerkOptions { general: true, ..JerkOptions::default() });
        let whole = Trajectory::plan(&path, whole).unwrap().motion_time_s();
        let error = parts / whole - 1.0;
        assert!(error.abs() < 2e-4, "{parts} s in parts, {whole} s as a whole");
    }
}

#[test]
fn parts_join() {
    for blend in blends() {
        let path = path(70, &blend);
        let trajectory = Trajectory::plan(&path, Timing::jerk_limited()).unwrap();
        for rate_hz in [1000.0, 250.0] {
            let [v, a, j] = ratios(&trajectory, rate_hz);
            assert!(v <= 1.01 && a <= 1.01 && j <= 1.05, "{v}, {a}, {j} at {rate_hz} Hz");
        }
        let mut last: Option<State> = None;
        for state in trajectory.states() {
            assert!(last.is_none_or(|last| last.t_s < state.t_s), "at {} s", state.t_s);
            last = Some(state);
        }
    }
}
