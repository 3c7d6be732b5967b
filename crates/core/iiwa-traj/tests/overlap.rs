//! Waits that overlap motions.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::sync::OnceLock;

use iiwa_kin::{Joints, Robot};
use iiwa_path::{JointPath, PathOptions, Step};
use iiwa_program::{Blend, Motion, MotionIndex, Program, Ptp};
use iiwa_traj::{JerkOptions, PieceKind, Replanner, SweepOptions, Timing, Trajectory};
use proptest::prelude::*;

fn acceleration() -> Timing {
    Timing::Acceleration(SweepOptions::default())
}

fn plan(program: &Program, timing: Timing) -> Trajectory {
    let path = JointPath::new(program, &Robot::default()).unwrap();
    Trajectory::plan(&path, timing).unwrap()
}

fn corner(target_deg: Joints) -> Motion {
    Motion::Ptp(Ptp::to(target_deg.map(f64::to_radians)).blend(Blend::Fraction(0.25)))
}

fn wait(seconds: f64, overlap: usize) -> Motion {
    Motion::Wait { seconds, overlap }
}

/// Creates two motions with a blend, and the entries `between` them.
fn bend(between: &[Motion]) -> Program {
    let mut program = Program::from_deg([0.0; 7]).build();
    program.motions.push(corner([40.0, 0.0, 0.0, -40.0, 0.0, 0.0, 0.0]));
    program.motions.extend(between.iter().cloned());
    let end = [40.0, 40.0, 0.0, -80.0, 0.0, 30.0, 0.0].map(f64::to_radians);
    program.motions.push(Motion::Ptp(Ptp::to(end)));
    program
}

fn bent_for(seconds: f64, timing: Timing) -> Trajectory {
    plan(&bend(&[wait(seconds, 1)]), timing)
}

fn times(trajectory: &Trajectory) -> Vec<u64> {
    trajectory
        .states()
        .flat_map(|state| [state.t_s, state.q[0], state.q[3]])
        .map(f64::to_bits)
        .collect()
}

/// Returns the joint positions and the time at the start of the blend.
fn blend_start(trajectory: &Trajectory) -> (Joints, f64) {
    let blends = trajectory.blends();
    (blends[0].start_rad, blends[0].start_s)
}

/// Returns the latest time at which the second motion of a bend has to be known.
fn needed_s(timing: Timing) -> f64 {
    let late = bent_for(5.0, timing);
    let late = late.late_blends().next().unwrap();
    assert_eq!((late.after_motion, late.known_s), (MotionIndex::new(0), 5.0));
    late.needed_s
}

#[test]
fn a_wait_that_is_over_in_time_changes_nothing() {
    for timing in [acceleration(), Timing::jerk_limited()] {
        let plain = plan(&bend(&[]), timing);
        for seconds in [0.0, 0.05, needed_s(timing) - 0.001] {
            let trajectory = bent_for(seconds, timing);
            assert_eq!(times(&trajectory), times(&plain), "{seconds} s");
            assert_eq!(trajectory.late_blends().count(), 0);
            assert_eq!(trajectory.totals().wait_time_s, 0.0);
        }
    }
}

#[test]
fn the_arm_stops_where_a_late_blend_begins_and_goes_on_along_it() {
    for timing in [acceleration(), Timing::jerk_limited()] {
        let plain = plan(&bend(&[]), timing);
        let (start_rad, in_time_s) = blend_start(&plain);
        let trajectory = bent_for(3.0, timing);
        let (late_rad, begins_s) = blend_start(&trajectory);
        assert_eq!(late_rad, start_rad);
        assert!((begins_s - 3.0).abs() < 1e-12, "{begins_s}");
        let [stop, rest] = trajectory.sections() else { panic!("there are two") };
        let standing = stop.pieces().last().unwrap();
        assert_eq!((standing.kind, standing.motion), (PieceKind::Wait, MotionIndex::new(1)));
        assert!(standing.start_s > in_time_s, "it brakes");
        assert!((trajectory.totals().wait_time_s - standing.duration_s).abs() < 1e-12);
        let state = trajectory.at(2.9);
        assert_eq!((state.q, state.dq), (start_rad, [0.0; 7]));
        // The path is the same from there on.
        let steps = |trajectory: &Trajectory| {
            let moves = trajectory.path().steps().iter().filter_map(|step| match step {
                Step::Move { segment, .. } => Some(segment.at(0.3).q),
                _ => None,
            });
            moves.collect::<Vec<_>>()
        };
        assert_eq!(steps(&trajectory), steps(&plain));
        assert_eq!(rest.pieces()[0].kind, PieceKind::Blend);
        assert!((trajectory.cycle_time_s() - rest.end_s()).abs() < 1e-12);
    }
}

#[test]
fn the_last_instant_is_that_of_braking() {
    // On a straight line under acceleration limits, the robot brakes at the full limit.
    let trajectory = bent_for(3.0, acceleration());
    let limits = *Robot::default().limits();
    let needed_s = needed_s(acceleration());
    let line = &trajectory.sections()[0].pieces()[0];
    // A1 is at its velocity limit: 98 deg/s, braked with 490 deg/s^2 in 0.2 s.
    let braking_s = limits.velocity_rad_s[0] / limits.acceleration_rad_s2[0];
    assert!((line.end_s - braking_s - needed_s).abs() < 2e-3, "{} {needed_s}", line.end_s);
}

#[test]
fn a_stop_without_rest_is_still_a_stop() {
    for timing in [acceleration(), Timing::jerk_limited()] {
        let trajectory = bent_for(needed_s(timing) + 0.001, timing);
        assert_eq!(trajectory.late_blends().count(), 1);
        assert_eq!(trajectory.sections().len(), 2);
        assert_eq!(trajectory.totals().wait_time_s, 0.0);
        let (_, begins_s) = blend_start(&trajectory);
        let state = trajectory.at(begins_s);
        assert!(state.dq.iter().all(|rate| rate.abs() < 1e-6), "{:?}", state.dq);
    }
}

#[test]
fn a_wait_after_a_stop_runs_from_the_begin_of_the_motion() {
    let stop = |between: &[Motion]| {
        let mut program = bend(between);
        if let Motion::Ptp(ptp) = &mut program.motions[0] {
            ptp.blend = None;
        }
        plan(&program, acceleration())
    };
    let plain = stop(&[]);
    let settled_s = plain.sections()[0].end_s();
    assert_eq!(times(&stop(&[wait(settled_s - 0.01, 1)])), times(&plain));
    let longer = stop(&[wait(settled_s + 0.25, 1)]);
    assert!((longer.totals().wait_time_s - 0.25).abs() < 1e-12);
    assert!((longer.cycle_time_s() - plain.cycle_time_s() - 0.25).abs() < 1e-12);
    assert_eq!(longer.late_blends().count(), 0);
    // A plain wait follows.
    let both = stop(&[wait(settled_s + 0.25, 1), wait(0.5, 0)]);
    assert!((both.totals().wait_time_s - 0.75).abs() < 1e-12);
}

#[test]
fn a_wait_at_the_end_ends_with_the_program() {
    let mut program = bend(&[]);
    let plain_s = plan(&program, acceleration()).cycle_time_s();
    program.motions.push(wait(0.1, 1));
    assert_eq!(plan(&program, acceleration()).cycle_time_s(), plain_s);
    program.motions.push(wait(4.0, 2));
    let trajectory = plan(&program, acceleration());
    // The wait counts from the start of the first motion, but not before the end of the previous
    // wait.
    let second_s = trajectory.blends()[0].start_s;
    assert!((trajectory.cycle_time_s() - (second_s + 0.1 + 4.0)).abs() < 1e-9);
}

#[test]
fn a_wait_may_count_from_motions_before() {
    let program = |overlap| {
        let mut program = Program::from_deg([0.0; 7]).build();
        program.motions.push(corner([40.0, 0.0, 0.0, -40.0, 0.0, 0.0, 0.0]));
        program.motions.push(corner([0.0, 30.0, 0.0, -80.0, 0.0, 30.0, 0.0]));
        program.motions.push(wait(3.0, overlap));
        program.motions.push(corner([-40.0, 0.0, 0.0, -80.0, 0.0, 0.0, 0.0]));
        plan(&program, acceleration())
    };
    let known_s = |overlap| program(overlap).late_blends().next().unwrap().known_s;
    let begins_s = program(1).blends()[0].start_s;
    assert_eq!(known_s(2), 3.0);
    assert!((known_s(1) - 3.0 - begins_s).abs() < 1e-12);
}

#[test]
fn a_late_blend_delays_instants_after_its_next_motion() {
    let mut program = bend(&[wait(2.0, 1)]);
    program.motions.push(wait(4.0, 1));
    let trajectory = plan(&program, acceleration());
    assert!((trajectory.cycle_time_s() - 6.0).abs() < 1e-9, "{}", trajectory.cycle_time_s());
}

#[test]
fn long_chains_are_as_if_each_blend_were_alone() {
    let zigzag = |waits: f64| {
        let mut program = Program::from_deg([0.0; 7]).build();
        for i in 0..40 {
            let side = if i % 2 == 0 { 30.0 } else { -30.0 };
            let up = if i % 4 < 2 { -60.0 } else { -20.0 };
            program.motions.push(corner([side, 0.0, 0.0, up, 0.0, 0.0, 0.0]));
            program.motions.push(wait(waits, 1));
        }
        plan(&program, acceleration())
    };
    let (in_time, late) = (zigzag(0.01), zigzag(2.0));
    assert_eq!((in_time.late_blends().count(), in_time.sections().len()), (0, 1));
    // The last motion has no next motion to blend into.
    assert_eq!((late.late_blends().count(), late.sections().len()), (39, 40));
    assert!((late.cycle_time_s() - 80.0).abs() < 1e-9, "{}", late.cycle_time_s());
}

#[test]
fn a_late_blend_is_found_after_many_that_are_in_time() {
    let timings = [acceleration(), Timing::Jerk(JerkOptions::default()), Timing::default()];
    for (timing, late) in timings.into_iter().zip([3, 9, 14]) {
        let mut program = Program::from_deg([0.0; 7]).build();
        for i in 0..16 {
            let side = if i % 2 == 0 { 10.0 } else { -10.0 };
            program.motions.push(corner([side, 0.0, 0.0, 2.0 * side, 0.0, 0.0, 0.0]));
            program.motions.push(wait(if i == late { 20.0 } else { 0.01 }, 1));
        }
        let trajectory = plan(&program, timing);
        let motions: Vec<_> = trajectory.late_blends().map(|blend| blend.after_motion).collect();
        assert_eq!(motions, [MotionIndex::new(2 * late)]);
    }
}

#[test]
fn a_replanner_knows_such_waits() {
    let options = JerkOptions::default();
    let robot = Robot::default();
    let mut replanner =
        Replanner::new(bend(&[wait(3.0, 1)]), &robot, PathOptions::default(), options).unwrap();
    let timing = Timing::Jerk(options);
    assert_eq!(times(&replanner.trajectory()), times(&bent_for(3.0, timing)));
    replanner.replace(MotionIndex::new(1), wait(2.0, 1)).unwrap();
    assert_eq!(replanner.cycle_time_s(), bent_for(2.0, timing).cycle_time_s());
    assert!(replanner.replace(MotionIndex::new(0), wait(2.0, 1)).is_err());
    assert_eq!(replanner.cycle_time_s(), bent_for(2.0, timing).cycle_time_s());
    // A bend without such waits may receive one.
    let mut replanner =
        Replanner::new(bend(&[wait(0.0, 1)]), &robot, PathOptions::default(), options).unwrap();
    replanner.replace(MotionIndex::new(1), wait(2.0, 1)).unwrap();
    assert_eq!(replanner.cycle_time_s(), bent_for(2.0, timing).cycle_time_s());
}

fn cycle_time_s(seconds: f64) -> f64 {
    bent_for(seconds, acceleration()).cycle_time_s()
}

fn plain_s() -> f64 {
    static PLAIN_S: OnceLock<f64> = OnceLock::new();
    *PLAIN_S.get_or_init(|| plan(&bend(&[]), acceleration()).cycle_time_s())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn longer_waits_take_no_less(a in 0.0..2.0_f64, b in 0.0..2.0_f64) {
        let (short, long) = (cycle_time_s(a.min(b)), cycle_time_s(a.max(b)));
        prop_assert!(short <= long + 1e-9, "{short} {long}");
        prop_assert!(long >= a.max(b) && long >= plain_s() - 1e-9);
    }

    #[test]
    fn a_wait_in_two_parts_is_the_same(seconds in 0.0..2.0_f64, share in 0.0..1.0_f64) {
        let parts = [wait(share * seconds, 1), wait(seconds - share * seconds, 1)];
        let split = plan(&bend(&parts), acceleration());
        prop_assert!((split.cycle_time_s() - cycle_time_s(seconds)).abs() < 1e-9);
        prop_assert_eq!(
            split.late_blends().count(),
            bent_for(seconds, acceleration()).late_blends().count()
        );
    }
}
