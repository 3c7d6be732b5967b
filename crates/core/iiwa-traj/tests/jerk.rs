//! Properties of jerk-limited durations that hold for any program.

// Test helpers may panic.
#![allow(clippy::unwrap_used)]

use iiwa_kin::{Joints, Robot};
use iiwa_path::JointPath;
use iiwa_program::{Blend, LimitKind, Motion, Program, Ptp, Sources, Start, Workcell};
use iiwa_traj::{State, SweepOptions, Timing, TimingError, Trajectory};
use proptest::{
    prelude::*,
    strategy::ValueTree,
    test_runner::{RngSeed, TestRunner},
};

fn trajectory(program: &Program, robot: &Robot, timing: Timing) -> Trajectory {
    let path = JointPath::new(program, robot).unwrap();
    Trajectory::plan(&path, timing).unwrap()
}

fn motion_time_s(program: &Program) -> f64 {
    trajectory(program, &Robot::default(), Timing::jerk_limited()).motion_time_s()
}

/// Creates a motion with the same shares for all joints.
fn ptp(target: Joints, [v, a, j]: [f64; 3], blend: f64) -> Ptp {
    Ptp {
        velocity_rel: [v; 7],
        acceleration_rel: [a; 7],
        jerk_rel: [j; 7],
        blend: Some(Blend::Fraction(blend)),
        ..Ptp::to(target)
    }
}

/// Creates a program without its last blend, which would have no next motion.
fn program(start_rad: Joints, mut motions: Vec<Ptp>) -> Program {
    if let Some(last) = motions.last_mut() {
        last.blend = None;
    }
    Program {
        robot: None,
        start: Start::Joints(start_rad),
        motions: motions.into_iter().map(Motion::Ptp).collect(),
        workcell: Workcell::default(),
        sources: Sources::default(),
    }
}

/// Creates random programs of two to six motions, most of them blended; the same at each call.
fn programs(count: usize) -> Vec<Program> {
    let joints = || prop::array::uniform7(-1.5..1.5_f64);
    let share = || prop_oneof![2 => Just(1.0), 1 => 0.1..1.0_f64];
    let blend = prop_oneof![3 => 0.05..0.5_f64, 1 => Just(0.5), 1 => Just(0.0)];
    let motion = (joints(), share(), share(), share(), blend)
        .prop_map(|(target, v, a, j, blend)| ptp(target, [v, a, j], blend));
    let all = (joints(), prop::collection::vec(motion, 2..=6))
        .prop_map(|(start, motions)| program(start, motions))
        .prop_filter("a blend swings out of the limits", |program| {
            JointPath::new(program, &Robot::default()).is_ok()
        });
    let config = ProptestConfig { rng_seed: RngSeed::Fixed(42), ..ProptestConfig::default() };
    prop::collection::vec(all, count).new_tree(&mut TestRunner::new(config)).unwrap().current()
}

/// Returns the program with changed motions.
fn changed(program: &Program, change: impl Fn(usize, &mut Ptp)) -> Program {
    let mut program = program.clone();
    for (i, motion) in program.motions.iter_mut().enumerate() {
        if let Motion::Ptp(ptp) = motion {
            change(i, ptp);
        }
    }
    program
}

#[test]
fn slower_limits_never_make_it_faster() {
    let mut min_ratio = f64::INFINITY;
    for program in programs(40) {
        let before = motion_time_s(&program);
        let mut slower = |kind: LimitKind, change: &dyn Fn(usize, &mut Ptp)| {
            let ratio = motion_time_s(&changed(&program, change)) / before;
            assert!(ratio > 1.0 - 1e-3, "{ratio} times as long with a lower {kind}: {program:?}");
            min_ratio = min_ratio.min(ratio);
        };
        for kind in LimitKind::ALL {
            let times = |ptp: &mut Ptp, factor: f64| {
                ptp.share_mut(kind).iter_mut().for_each(|share| *share *= factor);
            };
            for factor in [0.9, 0.5, 0.15] {
                slower(kind, &|_, ptp| times(ptp, factor));
            }
            // Changes to one motion, and to one joint.
            slower(kind, &|i, ptp| times(ptp, if i == 1 { 0.7 } else { 1.0 }));
            slower(kind, &|_, ptp| ptp.share_mut(kind)[3] *= 0.4);
        }
    }
    println!("at least {min_ratio} times as long");
}

/// With a thousand times the jerk limit, acceleration builds up almost instantly; the rest is due
/// to the solver's cells, which are sized for the robot's jerk limits.
#[test]
fn much_jerk_is_no_limit_of_jerk() {
    let usual = Robot::default();
    let jerk: Vec<_> =
        usual.limits().jerk_rad_s3.iter().map(|jerk| 1000.0 * jerk.to_degrees()).collect();
    let profile = format!(r#"{{ "version": 1, "jerk_limit_deg_s3": {jerk:?} }}"#);
    let robot = Robot::from_profile(&profile).unwrap();
    let (mut min_ratio, mut max_ratio) = (f64::INFINITY, 0.0_f64);
    for program in programs(40) {
        let fine = Timing::Acceleration(SweepOptions { samples: 400 });
        let expected = trajectory(&program, &robot, fine).motion_time_s();
        let actual = trajectory(&program, &robot, Timing::jerk_limited()).motion_time_s();
        let ratio = actual / expected;
        assert!((ratio - 1.0).abs() < 0.025, "{actual} s, {expected} s: {program:?}");
        (min_ratio, max_ratio) = (min_ratio.min(ratio), max_ratio.max(ratio));
    }
    println!("{min_ratio} to {max_ratio} of the acceleration-limited time");
}

/// The duration depends only on the ratios of ways and limits.
#[test]
fn scale_does_not_matter() {
    let mut largest = 0.0_f64;
    for program in programs(40) {
        let before = motion_time_s(&program);
        for scale in [0.5, 0.37, 0.01] {
            let times = |values: Joints| values.map(|value| scale * value);
            let mut scaled = changed(&program, |_, ptp| {
                ptp.target_rad = times(ptp.target_rad);
                for kind in LimitKind::ALL {
                    *ptp.share_mut(kind) = times(*ptp.share(kind));
                }
            });
            scaled.start = Start::Joints(times(*scaled.start.joints_rad().unwrap()));
            let change = motion_time_s(&scaled) / before - 1.0;
            // Less than the solver's gap, 3e-5: the rounding of sums depends on the machine's
            // vector registers.
            assert!(change.abs() < 1e-5, "{change:e} at {scale} times the size: {program:?}");
            largest = largest.max(change.abs());
        }
    }
    println!("largest change {largest:e}");
}

/// At 1/c of the speed, 1/c^2 of the acceleration and 1/c^3 of the jerk, a motion takes c times as
/// long.
#[test]
fn time_scales() {
    let mut largest = 0.0_f64;
    for program in programs(40) {
        let before = motion_time_s(&program);
        for scale in [2.0, 3.0] {
            let slower = changed(&program, |_, ptp| {
                for kind in LimitKind::ALL {
                    let slower = |share: f64| share / f64::powi(scale, kind.order().into());
                    *ptp.share_mut(kind) = ptp.share(kind).map(slower);
                }
            });
            let change = motion_time_s(&slower) / (scale * before) - 1.0;
            // Cells of long duration are checked at more points, and their limits are lowered
            // accordingly.
            assert!(change.abs() < 1e-4, "{change:e} at {scale} times the time: {program:?}");
            largest = largest.max(change.abs());
        }
    }
    println!("largest change {largest:e}");
}

#[test]
fn the_way_back_takes_as_long() {
    let mut largest = 0.0_f64;
    for forward in programs(40) {
        // Uniform limits and blends, so that the reversed path equals the path.
        let forward = changed(&forward, |_, motion| {
            *motion = ptp(motion.target_rad, [0.8, 0.9, 0.7], 0.3);
        });
        let targets: Vec<_> = std::iter::once(*forward.start.joints_rad().unwrap())
            .chain(forward.motions.iter().filter_map(|motion| match motion {
                Motion::Ptp(ptp) => Some(ptp.target_rad),
                _ => None,
            }))
            .collect();
        let way = |targets: &mut dyn Iterator<Item = &Joints>| {
            let start = *targets.next().unwrap();
            program(start, targets.map(|&q| ptp(q, [0.8, 0.9, 0.7], 0.3)).collect())
        };
        let (forward, back) = (way(&mut targets.iter()), way(&mut targets.iter().rev()));
        let change = motion_time_s(&back) / motion_time_s(&forward) - 1.0;
        assert!(change.abs() < 1e-3, "{change:e}: {forward:?}");
        largest = largest.max(change.abs());
    }
    println!("largest change {largest:e}");
}

/// Memory that is reused from program to program must not affect results.
#[test]
fn earlier_motions_do_not_matter() {
    let programs = programs(30);
    let states = |program: &Program| -> Vec<State> {
        trajectory(program, &Robot::default(), Timing::jerk_limited()).states().collect()
    };
    let bits = |states: &[State]| -> Vec<u64> {
        let all = |s: &State| [[s.t_s; 7], s.q, s.dq, s.ddq];
        states.iter().flat_map(all).flatten().map(f64::to_bits).collect()
    };
    let in_order: Vec<_> = programs.iter().map(&states).collect();
    for (program, before) in programs.iter().zip(&in_order).rev() {
        assert_eq!(bits(&states(program)), bits(before));
        // The same on a fresh thread.
        let alone = std::thread::scope(|scope| scope.spawn(|| states(program)).join().unwrap());
        assert_eq!(bits(&alone), bits(before));
    }
}

/// Limits of one motion a hundred thousand times lower than those of the next: the solver returns
/// an error if it does not converge, and never panics on numerical overflow.
#[test]
fn where_there_is_no_solution_there_is_an_error() {
    let start = [0.0; 7];
    let target = |degrees: [f64; 7]| degrees.map(f64::to_radians);
    let first = target([40.0, 0.0, 0.0, -30.0, 0.0, 0.0, 0.0]);
    let second = target([60.0, 20.0, 0.0, -30.0, 0.0, 10.0, 0.0]);
    for low in [1e-5, 1e-4, 1e-3] {
        for shares in [[1.0, low, 1.0], [1.0, 1.0, low], [low, 1.0, 1.0], [1.0, low, low]] {
            let motions = vec![ptp(first, shares, 0.5), ptp(second, [1.0; 3], 0.0)];
            let program = program(start, motions);
            let path = JointPath::new(&program, &Robot::default()).unwrap();
            match Trajectory::plan(&path, Timing::jerk_limited()) {
                Ok(trajectory) => assert!(trajectory.motion_time_s().is_finite()),
                Err(error) => assert!(matches!(error, TimingError::NotConverged { .. }), "{error}"),
            }
        }
    }
}
