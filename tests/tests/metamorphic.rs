//! Programs with equal durations: mirror images, reversed paths, segments in two parts, slower
//! limits, stops. With both time parameterisations, unless tested in the planning crate.

// Test helpers may panic.
#![allow(clippy::unwrap_used)]

use iiwa_kin::{Joints, Robot};
use iiwa_path::JointPath;
use iiwa_program::{Blend, Motion, Program, Ptp, Sources, Start, Workcell};
use iiwa_traj::{SweepOptions, Timing, Trajectory};
use iiwasim_tests::families::Family;

/// Relative tolerance of durations.
const BAR: f64 = 1e-3;

fn timings() -> [Timing; 2] {
    [Timing::Acceleration(SweepOptions::default()), Timing::jerk_limited()]
}

fn motion_time_s(program: &Program, timing: Timing) -> f64 {
    let path = JointPath::new(program, &Robot::default()).unwrap();
    Trajectory::plan(&path, timing).unwrap().motion_time_s()
}

/// Fails unless `other` takes `times` as long as `program`, to the relative tolerance `bar`.
/// Returns the relative difference.
fn compare(program: &Program, other: &Program, times: f64, timing: Timing, bar: f64) -> f64 {
    let [actual, expected] = [motion_time_s(other, timing), times * motion_time_s(program, timing)];
    let change = if actual == expected { 0.0 } else { actual / expected - 1.0 };
    assert!(
        change.abs() <= bar,
        "{} timing: {actual} s, expected {expected} s ({change:e}): {}",
        timing.name(),
        program.to_json()
    );
    change.abs()
}

/// Returns the program with changed poses and motions.
fn changed(
    program: &Program,
    pose: impl Fn(Joints) -> Joints,
    change: impl Fn(&mut Ptp),
) -> Program {
    let mut program = program.clone();
    program.start = Start::Joints(pose(*program.start.joints_rad().unwrap()));
    for motion in &mut program.motions {
        if let Motion::Ptp(ptp) = motion {
            ptp.target_rad = pose(ptp.target_rad);
            change(ptp);
        }
    }
    program
}

/// Returns programs of two to six motions of sufficient length: `shares` gives relative limits of
/// each joint, and blend fractions are up to `largest`.
fn programs(
    count: usize,
    shares: impl Fn(&mut fastrand::Rng) -> [Joints; 3],
    largest: f64,
) -> Vec<Program> {
    let mut rng = fastrand::Rng::with_seed(11);
    let mut cases = Vec::with_capacity(count);
    while cases.len() < count {
        let pose =
            |rng: &mut fastrand::Rng| -> Joints { std::array::from_fn(|_| 3.0 * rng.f64() - 1.5) };
        let start_rad = pose(&mut rng);
        let [velocity_rel, acceleration_rel, jerk_rel] = shares(&mut rng);
        let mut motions: Vec<_> = (0..rng.usize(2..=6))
            .map(|_| Ptp {
                velocity_rel,
                acceleration_rel,
                jerk_rel,
                blend: Some(Blend::Fraction(largest * (0.2 + 0.8 * rng.f64()))),
                ..Ptp::to(pose(&mut rng))
            })
            .collect();
        motions.last_mut().unwrap().blend = None;
        let motions = motions.into_iter().map(Motion::Ptp).collect();
        let program = Program {
            robot: None,
            start: Start::Joints(start_rad),
            motions,
            workcell: Workcell::default(),
            sources: Sources::default(),
        };
        // A blend may leave a joint range.
        if JointPath::new(&program, &Robot::default()).is_ok() {
            cases.push(program);
        }
    }
    cases
}

/// Returns independent relative limits of each joint.
fn apart(rng: &mut fastrand::Rng) -> [Joints; 3] {
    std::array::from_fn(|_| std::array::from_fn(|_| 0.2 + 0.8 * rng.f64()))
}

fn ptps(program: &Program) -> Vec<Ptp> {
    let ptp = |motion: &Motion| match motion {
        Motion::Ptp(ptp) => Some(ptp.clone()),
        _ => None,
    };
    program.motions.iter().filter_map(ptp).collect()
}

/// Mirror images have equal durations.
#[test]
fn a_mirror_image_takes_as_long() {
    let mirror = |mut q: Joints| {
        for j in [0, 2, 4, 6] {
            q[j] = -q[j];
        }
        q
    };
    let mut largest = 0.0_f64;
    for family in [Family::Plain, Family::Mixed, Family::Sliver, Family::Fine] {
        for index in 0..25 {
            let program = family.program(2, index).program;
            for timing in timings() {
                let image = changed(&program, mirror, |_| {});
                largest = largest.max(compare(&program, &image, 1.0, timing, BAR));
            }
        }
    }
    println!("largest change {largest:e}");
}

/// Limits and blends are symmetric: those of each joint and each corner are the same in both
/// directions.
#[test]
fn the_way_back_takes_as_long() {
    let mut largest = 0.0_f64;
    for forward in programs(40, apart, 0.5) {
        let ways = ptps(&forward);
        let mut targets: Vec<_> = ways.iter().map(|ptp| ptp.target_rad).collect();
        let start_rad = targets.pop().unwrap();
        let blends = ways.iter().rev().skip(1).map(|ptp| ptp.blend).chain([None]);
        let targets = targets.into_iter().rev().chain([*forward.start.joints_rad().unwrap()]);
        let back = targets
            .zip(blends)
            .map(|(target_rad, blend)| Motion::Ptp(Ptp { target_rad, blend, ..ways[0].clone() }));
        let back = Program {
            robot: None,
            start: Start::Joints(start_rad),
            motions: back.collect(),
            workcell: Workcell::default(),
            sources: Sources::default(),
        };
        for timing in timings() {
            largest = largest.max(compare(&forward, &back, 1.0, timing, BAR));
        }
    }
    println!("largest change {largest:e}");
}

/// Each segment in two halves with the largest blend between them, and unchanged blends at the
/// corners.
#[test]
fn legs_in_two_halves_take_as_long() {
    let mut largest = 0.0_f64;
    for program in programs(40, apart, 0.25) {
        let mut from = *program.start.joints_rad().unwrap();
        let mut motions = Vec::new();
        for ptp in ptps(&program) {
            let to = ptp.target_rad;
            let half = Ptp {
                target_rad: std::array::from_fn(|j| f64::midpoint(from[j], to[j])),
                blend: Some(Blend::Fraction(0.5)),
                ..ptp.clone()
            };
            let blend = ptp.blend.map(|blend| match blend {
                Blend::Fraction(b) => Blend::Fraction(2.0 * b),
                other => other,
            });
            motions.extend([Motion::Ptp(half), Motion::Ptp(Ptp { blend, ..ptp })]);
            from = to;
        }
        let halves = Program { motions, ..program.clone() };
        for timing in timings() {
            largest = largest.max(compare(&program, &halves, 1.0, timing, BAR));
        }
    }
    println!("largest change {largest:e}");
}

/// Scaling of limits: with 1/k of the speed and 1/k^2 of the acceleration, the program takes k
/// times as long.
#[test]
fn acceleration_limited_time_scales() {
    let timing = Timing::Acceleration(SweepOptions::default());
    let mut largest = 0.0_f64;
    let random = programs(40, apart, 0.5);
    let mixed = (0..40).map(|index| Family::Mixed.program(3, index).program);
    for program in random.into_iter().chain(mixed) {
        for k in [2.0, 3.0, 7.0] {
            let slower = changed(
                &program,
                |q| q,
                |ptp| {
                    ptp.velocity_rel = ptp.velocity_rel.map(|v| v / k);
                    ptp.acceleration_rel = ptp.acceleration_rel.map(|a| a / (k * k));
                },
            );
            largest = largest.max(compare(&program, &slower, k, timing, 1e-6));
        }
    }
    println!("largest change {largest:e}");
}

/// Motions before a stop do not affect those after it.
#[test]
fn a_stop_cuts_a_program_in_two() {
    let mut largest = 0.0_f64;
    for (first, second) in
        std::iter::zip(programs(20, apart, 0.5), programs(40, apart, 0.3).split_off(20))
    {
        let whole = Program {
            motions: [
                first.motions.clone(),
                vec![Motion::Ptp(Ptp::to(*second.start.joints_rad().unwrap()))],
                second.motions.clone(),
            ]
            .concat(),
            ..first.clone()
        };
        let link = Program {
            robot: None,
            start: Start::Joints(ptps(&first).last().unwrap().target_rad),
            motions: vec![Motion::Ptp(Ptp::to(*second.start.joints_rad().unwrap()))],
            workcell: Workcell::default(),
            sources: Sources::default(),
        };
        for timing in timings() {
            let parts: f64 =
                [&first, &link, &second].map(|part| motion_time_s(part, timing)).iter().sum();
            let change = (motion_time_s(&whole, timing) / parts - 1.0).abs();
            assert!(change < 1e-9, "{} timing: {change:e}: {}", timing.name(), whole.to_json());
            largest = largest.max(change);
        }
    }
    println!("largest change {largest:e}");
}
