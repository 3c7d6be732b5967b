//! Paths that break solvers. Each is planned and checked with both time parameterisations, and if
//! there is a closed form, its duration is compared with it.

// Test helpers may panic.
#![allow(clippy::unwrap_used, clippy::panic, clippy::float_cmp)]

use iiwa_kin::{Joints, Robot};
use iiwa_path::{BlendShape, Continuity, JointPath, PathOptions, Segment, Step};
use iiwa_program::{Blend, Motion, MotionIndex, Program, Ptp, Sources, Start, Workcell};
use iiwa_traj::{State, SweepOptions, Timing, TimingError, Trajectory};
use iiwasim_tests::differences::ratios;

fn settle_time_s() -> f64 {
    Robot::default().settle_time_s()
}

const SHAPES: [BlendShape; 6] = [
    BlendShape::Iiwa,
    BlendShape::Alpha(Continuity::First),
    BlendShape::Alpha(Continuity::Second),
    BlendShape::Alpha(Continuity::Third),
    BlendShape::MinAcceleration,
    BlendShape::Circle,
];

/// Returns joint `joint` (from 1) at `deg`, the others at zero.
fn single_joint(joint: usize, deg: f64) -> Joints {
    std::array::from_fn(|j| if j + 1 == joint { deg.to_radians() } else { 0.0 })
}

fn path(start: Joints, motions: &[Ptp], shape: BlendShape) -> JointPath {
    let motions = motions.iter().cloned().map(Motion::Ptp).collect();
    let program = Program {
        robot: None,
        start: Start::Joints(start),
        motions,
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let options = PathOptions { blend_shape: shape, ..PathOptions::default() };
    JointPath::with_options(&program, &Robot::lbr_iiwa_7_r800(), options).unwrap()
}

/// Returns the first motion whose blend starts with a jump in curvature.
fn first_kink(path: &JointPath) -> Option<MotionIndex> {
    let mut blends = path.blends();
    let kink = blends.find(|(_, segment)| !segment.has_continuous_curvature());
    kink.map(|(corner, _)| corner.motion)
}

/// Plans with both time parameterisations and checks both; returns the acceleration-limited plan.
fn plan(path: &JointPath, samples: usize) -> Trajectory {
    let timing = Timing::Acceleration(SweepOptions { samples });
    let trajectory = Trajectory::plan(path, timing).unwrap();
    check(&trajectory);
    let jerk_limited = Trajectory::plan(path, Timing::jerk_limited());
    match first_kink(path) {
        None => check_jerk(&jerk_limited.unwrap(), &trajectory),
        Some(motion) => {
            assert_eq!(jerk_limited.unwrap_err(), TimingError::CurvatureJumps { motion });
        }
    }
    trajectory
}

/// Checks that limits hold, and that the plan is no faster than without jerk limits.
fn check_jerk(trajectory: &Trajectory, acceleration: &Trajectory) {
    let mut last: Option<State> = None;
    for state in trajectory.states() {
        if let Some(last) = last {
            assert!(state.t_s > last.t_s, "{} s after {} s", state.t_s, last.t_s);
        }
        last = Some(state);
    }
    for rate_hz in [1000.0, 250.0] {
        let [v, a, j] = ratios(trajectory, rate_hz);
        assert!(v <= 1.01 && a <= 1.01 && j <= 1.05, "at {rate_hz} Hz: {v}, {a}, {j}");
    }
    let end = trajectory.at(f64::INFINITY);
    assert_eq!(end.q, acceleration.at(f64::INFINITY).q);
    assert_eq!([end.dq, end.ddq], [[0.0; 7]; 2]);
    let [actual, lower] = [trajectory, acceleration].map(Trajectory::motion_time_s);
    assert!(actual >= lower, "{actual} s, {lower} s without jerk limits");
}

/// Returns the duration of a program with `motions`, in s, without settle time.
fn motion_time_s(start: Joints, motions: &[Ptp]) -> f64 {
    plan(&path(start, motions, BlendShape::Iiwa), 100).motion_time_s()
}

/// Checks that stamps increase, limits hold, and position and velocity do not jump.
fn check(trajectory: &Trajectory) {
    let path = trajectory.path();
    let mut last: Option<State> = None;
    for state in trajectory.states() {
        let limits = path.limits_of(state.step);
        for j in 0..7 {
            let v = state.dq[j].abs() / limits.velocity_rad_s()[j];
            let a = state.ddq[j].abs() / limits.acceleration_rad_s2()[j];
            assert!(v <= 1.0 + 1e-6 && a <= 1.0 + 1e-6, "at {} s: {v}, {a}", state.t_s);
        }
        if let Some(last) = last {
            assert!(state.t_s > last.t_s, "{} s after {} s", state.t_s, last.t_s);
        }
        last = Some(state);
    }
    let robot = path.robot().limits();
    let (mut t_s, mut last) = (0.0, trajectory.at(0.0));
    assert_eq!(last.q, *path.start_rad());
    while t_s < trajectory.cycle_time_s() {
        t_s += DT;
        let state = trajectory.at(t_s);
        for j in 0..7 {
            let dq = (state.q[j] - last.q[j]).abs();
            assert!(dq <= 1.01 * robot.velocity_rad_s[j] * DT + 1e-12, "a jump at {} s", state.t_s);
            let dv = (state.dq[j] - last.dq[j]).abs();
            let tolerance = 1.01 * robot.acceleration_rad_s2[j] * DT + 1e-9;
            assert!(
                dv <= tolerance,
                "a jerk of joint {} at {} s: {dv} > {tolerance}",
                j + 1,
                state.t_s
            );
        }
        last = state;
    }
    let end = path.steps().iter().rev().find_map(|step| match step {
        Step::Move { segment, .. } => Some(segment.at(1.0).q),
        _ => None,
    });
    assert_eq!(last.q, end.unwrap_or(*path.start_rad()));
    assert_eq!(last.dq, [0.0; 7]);
}

/// Sample step of the checks, in s.
const DT: f64 = 1e-4;

/// Returns the duration from rest to rest over `distance` with speed and acceleration limits.
fn trapezoid(distance: f64, v: f64, a: f64) -> f64 {
    if distance > v * v / a { distance / v + v / a } else { 2.0 * (distance / a).sqrt() }
}

fn assert_close(actual: f64, expected: f64, tolerance: f64) {
    assert!((actual / expected - 1.0).abs() < tolerance, "{actual} s, expected {expected} s");
}

/// Speed and acceleration limits of joint 1, in deg (Larsen 2019, Table 2).
const V1: f64 = 98.0;
const A1: f64 = 490.0;

#[test]
fn one_joint_alone() {
    let limits = Robot::lbr_iiwa_7_r800();
    let limits = limits.limits();
    for joint in 1..=7 {
        let (v, a) = (limits.velocity_rad_s[joint - 1], limits.acceleration_rad_s2[joint - 1]);
        for deg in [100.0, 50.0, 19.6, 5.0, 0.01] {
            for share in [1.0, 0.3, 0.01] {
                let actual_s =
                    motion_time_s([0.0; 7], &[Ptp::to(single_joint(joint, deg)).velocity(share)]);
                assert_close(actual_s, trapezoid(f64::to_radians(deg), share * v, a), 1e-9);
            }
        }
    }
    let there_and_back = [Ptp::to(single_joint(1, 40.0)), Ptp::to(single_joint(1, 0.0))];
    assert_close(motion_time_s([0.0; 7], &there_and_back), 2.0 * trapezoid(40.0, V1, A1), 1e-9);
}

/// All joints move in proportion on a line: the slowest joint is critical, separately for speed and
/// acceleration.
#[test]
fn all_joints_on_one_line() {
    let to = [0.9, -0.8, 0.7, -0.6, 0.5, -0.4, 0.3];
    let limits = Robot::lbr_iiwa_7_r800();
    let limits = limits.limits();
    let lower_s =
        |limit: &Joints| (0..7).map(|j| limit[j] / f64::abs(to[j])).fold(f64::MAX, f64::min);
    let (v, a) = (lower_s(&limits.velocity_rad_s), lower_s(&limits.acceleration_rad_s2));
    assert_close(motion_time_s([0.0; 7], &[Ptp::to(to)]), trapezoid(1.0, v, a), 1e-9);
}

#[test]
fn a_share_for_each_joint() {
    let mut ptp = Ptp::to(single_joint(1, 60.0));
    ptp.velocity_rel = [0.5, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01];
    ptp.acceleration_rel = [0.25, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01];
    assert_close(motion_time_s([0.0; 7], &[ptp]), trapezoid(60.0, 0.5 * V1, 0.25 * A1), 1e-9);

    // Joint 3 (100 deg/s, 500 deg/s^2) would need less time than joint 1, and is slowed down.
    let both = std::array::from_fn(|j| single_joint(1, 60.0)[j] + single_joint(3, 40.0)[j]);
    let mut ptp = Ptp::to(both);
    ptp.velocity_rel[2] = 0.2;
    assert_close(motion_time_s([0.0; 7], &[ptp]), trapezoid(1.0, 20.0 / 40.0, A1 / 60.0), 1e-9);
}

#[test]
fn straight_on_is_one_motion() {
    for shape in SHAPES {
        for blend in [Blend::Fraction(0.25), Blend::Fraction(0.5), Blend::CartMm(50.0)] {
            let motions = [
                Ptp::to(single_joint(1, 30.0)).blend(blend),
                Ptp::to(single_joint(1, 60.0)).blend(blend),
                Ptp::to(single_joint(1, 90.0)),
            ];
            let path = path([0.0; 7], &motions, shape);
            assert!(path.blends().all(|(corner, _)| corner.gamma_deg.abs() < 1e-6));
            let trajectory = plan(&path, 100);
            assert_close(trajectory.motion_time_s(), trapezoid(90.0, V1, A1), 1e-6);
            assert_close(
                trajectory.cycle_time_s(),
                trapezoid(90.0, V1, A1) + settle_time_s(),
                1e-6,
            );
        }
    }
}

/// A blend already keeps the limits of the next motion (Larsen 2019, Appendix B).
#[test]
fn straight_on_into_a_slower_motion() {
    let motions = [
        Ptp::to(single_joint(1, 30.0)).blend(Blend::Fraction(0.25)),
        Ptp::to(single_joint(1, 90.0)).velocity(0.5),
    ];
    let blend_starts = 30.0 - 0.25 * 30.0;
    let slow = 0.5 * V1;
    let braking = (V1 * V1 - slow * slow) / (2.0 * A1);
    let first = V1 / A1 + (V1 - slow) / A1 + (blend_starts - V1 * V1 / (2.0 * A1) - braking) / V1;
    let second = (90.0 - blend_starts - slow * slow / (2.0 * A1)) / slow + slow / A1;
    assert_close(motion_time_s([0.0; 7], &motions), first + second, 1e-6);
}

/// A nearly collinear corner must not differ from a collinear one.
#[test]
fn nearly_straight_on() {
    for deg in [1e-9, 1e-7, 1e-5, 1e-3] {
        let mut end = single_joint(1, 90.0);
        end[1] = f64::to_radians(deg);
        for shape in SHAPES {
            let motions =
                [Ptp::to(single_joint(1, 40.0)).blend(Blend::Fraction(0.25)), Ptp::to(end)];
            let trajectory = plan(&path([0.0; 7], &motions, shape), 100);
            // Eq. 32 has a constant pace, the others do not: their grid misses the switching point.
            assert_close(trajectory.motion_time_s(), trapezoid(90.0, V1, A1), 1e-3);
        }
    }
}

/// A reversing joint is at rest at its turning point, so the motion between two turning points
/// takes the time of a motion from rest to rest.
#[test]
fn one_joint_turns_back() {
    for shape in SHAPES {
        for fraction in [0.1, 0.25, 0.5] {
            let motions = [
                Ptp::to(single_joint(1, 40.0)).blend(Blend::Fraction(fraction)),
                Ptp::to(single_joint(1, -20.0)),
            ];
            let path = path([0.0; 7], &motions, shape);
            let moves = || {
                path.steps().iter().filter_map(|step| match step {
                    Step::Move { segment, .. } => Some(segment.as_ref()),
                    _ => None,
                })
            };
            // Turning points of joint 1 on a fine grid.
            let mut turns = vec![0.0_f64];
            let mut before = (0.0_f64, 0.0_f64);
            for q in moves().flat_map(|segment: &dyn Segment| {
                (1..=20_000).map(|i| segment.at(f64::from(i) / 20_000.0).q[0].to_degrees())
            }) {
                let step = q - before.0;
                if step * before.1 < 0.0 {
                    turns.push(before.0);
                }
                if step != 0.0 {
                    before = (q, step);
                }
            }
            turns.push(before.0);
            let expected: f64 =
                turns.windows(2).map(|pair| trapezoid((pair[1] - pair[0]).abs(), V1, A1)).sum();
            let error = |samples| plan(&path, samples).motion_time_s() / expected - 1.0;
            assert!(error(100).abs() < 1e-4, "{shape:?}, {fraction}: {:e}", error(100));
            assert!(error(1600).abs() < 1e-6, "{shape:?}, {fraction}: {:e}", error(1600));
        }
    }
}

#[test]
fn all_joints_turn_back() {
    let to = [0.9, -0.8, 0.7, -0.6, 0.5, -0.4, 0.3];
    for shape in SHAPES {
        for blend in [Blend::Fraction(0.1), Blend::Fraction(0.5), Blend::CartMm(100.0)] {
            let path = path([0.0; 7], &[Ptp::to(to).blend(blend), Ptp::to([0.0; 7])], shape);
            let trajectory = plan(&path, 100);
            // The joint turns before the target: a stop there would take longer.
            let stop = motion_time_s([0.0; 7], &[Ptp::to(to), Ptp::to([0.0; 7])]);
            assert!(trajectory.motion_time_s() < stop, "{shape:?}");
        }
    }
}

#[test]
fn repeated_targets() {
    let (a, b) = (single_joint(1, 40.0), single_joint(2, 30.0));
    let blend = Blend::Fraction(0.25);
    let single = [Ptp::to(a), Ptp::to(b)];
    let double = [Ptp::to(a), Ptp::to(a).blend(blend), Ptp::to(b).blend(blend), Ptp::to(b)];
    let once = plan(&path([0.0; 7], &single, BlendShape::Iiwa), 100);
    let twice = plan(&path([0.0; 7], &double, BlendShape::Iiwa), 100);
    assert_close(twice.motion_time_s(), once.motion_time_s(), 1e-12);
    assert_close(twice.cycle_time_s(), once.cycle_time_s() + 2.0 * settle_time_s(), 1e-12);

    let nowhere = plan(&path(a, &[Ptp::to(a), Ptp::to(a)], BlendShape::Iiwa), 100);
    assert_eq!(nowhere.motion_time_s(), 0.0);
    assert_close(nowhere.cycle_time_s(), 2.0 * settle_time_s(), 1e-12);
}

/// Two blends of half a motion leave nothing of it between them, except rounding or a sliver.
#[test]
fn slivers_between_blends() {
    let a = [0.0; 7];
    let b = [0.4, 0.3, 0.0, 0.0, 0.0, 0.0, 0.0];
    let end = |length: f64| {
        let mut c = b;
        c[2] += length;
        c
    };
    let time = |sliver: f64, shape: BlendShape| {
        let (c, half) = (end(0.5 + sliver), Blend::Fraction(0.5));
        let mut d = c;
        d[3] -= 0.5;
        let motions = [Ptp::to(b).blend(half), Ptp::to(c).blend(half), Ptp::to(d)];
        let path = path(a, &motions, shape);
        assert_eq!(path.blends().count(), 2);
        plan(&path, 100).motion_time_s()
    };
    for shape in SHAPES {
        let none = time(0.0, shape);
        for sliver in [1e-12, 1.1e-9, 1e-8, 1e-7, 1e-6, 1e-5] {
            let actual_s = time(sliver, shape);
            assert!(
                (actual_s - none).abs() < 1e-4 * none,
                "{shape:?}, {sliver} rad: {actual_s}, {none}"
            );
        }
    }
}

#[test]
fn a_radius_larger_than_the_motions() {
    let (b, c) = ([0.2, 0.3, 0.1, -0.4, 0.2, 0.1, 0.3], [0.5, 0.1, 0.3, -0.2, 0.4, 0.3, 0.0]);
    for shape in SHAPES {
        let time = |blend: Blend| {
            let motions = [Ptp::to(b).blend(blend), Ptp::to(c)];
            plan(&path([0.0; 7], &motions, shape), 100).motion_time_s()
        };
        assert_eq!(time(Blend::CartMm(5000.0)), time(Blend::Fraction(0.5)));
    }
}

#[test]
fn tiny_motions() {
    let a1 = A1.to_radians();
    for rad in [1e-3, 1e-6, 1e-8] {
        let to = single_joint(1, f64::to_degrees(rad));
        assert_close(motion_time_s([0.0; 7], &[Ptp::to(to)]), 2.0 * (rad / a1).sqrt(), 1e-6);
        for shape in SHAPES {
            let mut corner = to;
            corner[1] = rad;
            let motions = [
                Ptp::to(to).blend(Blend::Fraction(0.25)),
                Ptp::to(corner).blend(Blend::Fraction(0.5)),
                Ptp::to([0.0; 7]),
            ];
            let actual_s = plan(&path([0.0; 7], &motions, shape), 100).motion_time_s();
            // Only acceleration limits the motion: its duration is proportional to the square root
            // of its size.
            let large = plan(
                &path(
                    [0.0; 7],
                    &motions.clone().map(|ptp| Ptp {
                        target_rad: ptp.target_rad.map(|q| q * 1e-2 / rad),
                        ..ptp
                    }),
                    shape,
                ),
                100,
            )
            .motion_time_s();
            println!("{rad} rad, {shape:?}");
            assert_close(actual_s / (rad / 1e-2).sqrt(), large, 2e-4);
        }
    }
    // Motions below a nanoradian are rounding.
    assert_eq!(motion_time_s([0.0; 7], &[Ptp::to(single_joint(1, 1e-8))]), 0.0);
}

/// Tiny blended motions between large ones.
#[test]
fn tiny_motions_on_the_way() {
    let half = Blend::Fraction(0.5);
    for rad in [1e-3, 1e-6, 1e-8] {
        let mut second = single_joint(1, 30.0);
        second[1] = rad;
        let mut third = second;
        third[2] = 0.5;
        let motions = [
            Ptp::to(single_joint(1, 30.0)).blend(half),
            Ptp::to(second).blend(half),
            Ptp::to(third),
        ];
        for shape in SHAPES {
            plan(&path([0.0; 7], &motions, shape), 100);
        }
    }
}

/// A tiny motion between a large and a slow one: the speed changes strongly over almost no
/// distance.
#[test]
fn tiny_motions_before_slow_ones() {
    let two = |joints: [usize; 2], q: [f64; 2]| -> Joints {
        std::array::from_fn(|j| {
            joints.iter().position(|&joint| joint == j + 1).map_or(0.0, |i| q[i])
        })
    };
    let half = Blend::Fraction(0.5);

    let q = |a, b| two([2, 7], [a, b]);
    let mut first = Ptp::to(q(0.0, 0.004_223_274)).blend(half);
    first.jerk_rel[1] = 0.32;
    let mut slow = Ptp::to(q(0.0, -1.809_725));
    slow.velocity_rel[6] = 0.01;
    let motions = [first, Ptp::to(q(0.0, 0.004_224_220)).blend(half), slow];
    plan(&path(q(-1.0, 0.196_008), &motions, BlendShape::Iiwa), 100);

    let mut first = Ptp::to(q(1.0, -0.918_454_335)).blend(half);
    first.velocity_rel[1] = 0.01;
    first.jerk_rel[6] = 0.093;
    let mut last = Ptp::to(q(1.0, -0.012_743));
    last.jerk_rel[6] = 0.01;
    let motions = [first, Ptp::to(q(1.0, -0.918_454_054)).blend(half), last];
    plan(&path(q(0.0, 0.3153), &motions, BlendShape::Iiwa), 100);

    let q = |a, b| two([1, 3], [a, b]);
    let motions = [
        Ptp::to(q(-0.1, -0.221_426_995)).blend(Blend::CartMm(288.690_755)),
        Ptp::to(q(0.1, 0.009_501_923_8)).blend(Blend::CartMm(201.516_607)),
        Ptp::to(q(0.1, 0.009_501_178_8)).blend(Blend::Fraction(0.001_5)),
        Ptp::to(q(0.7, 0.009_501_178_8)).velocity(0.01),
    ];
    plan(&path(q(-0.3, -0.205_715_525), &motions, BlendShape::Iiwa), 100);
}

#[test]
fn slow_motions_take_as_long_as_they_are_slow() {
    // A hundredth of the speed takes a hundred times as long, except for the ramps. Sampling such a
    // long time, as in the other tests, would take too long.
    for timing in [Timing::Acceleration(SweepOptions::default()), Timing::jerk_limited()] {
        let time_s = |motions: &[Ptp]| {
            let path = path([0.0; 7], motions, BlendShape::Iiwa);
            Trajectory::plan(&path, timing).unwrap().motion_time_s()
        };
        let mut corner = single_joint(1, 90.0);
        corner[1] = corner[0];
        for share in [1e-2, 1e-4, 2e-6] {
            let line = |share| time_s(&[Ptp::to(single_joint(2, 10.0)).velocity(share)]) * share;
            assert!((line(share) / (10.0 / 98.0) - 1.0).abs() < 2.0 * share, "{share}");
            let blended = |share| {
                let first =
                    Ptp::to(single_joint(1, 90.0)).velocity(share).blend(Blend::Fraction(0.1));
                time_s(&[first, Ptp::to(corner).velocity(share)]) * share
            };
            let change = blended(share) / blended(share / 1.5) - 1.0;
            assert!(change.abs() < share, "{share}");
        }
    }
}

/// The error about jerk limits names the first blend whose curvature jumps at its start.
#[test]
fn curvature_that_jumps_is_named() {
    let (a, b) = ([0.4, 0.3, 0.0, 0.0, 0.0, 0.0, 0.0], [0.4, 0.8, 0.2, 0.0, 0.0, 0.0, 0.0]);
    let blend = Blend::Fraction(0.25);
    let ptp = |target, blend| Motion::Ptp(Ptp { blend, ..Ptp::to(target) });
    let motions = vec![
        ptp(a, None),
        Motion::Wait { seconds: 0.5, overlap: 0 },
        // Collinear: there is nothing to blend.
        ptp(a.map(|q| 0.5 * q), Some(blend)),
        ptp([0.0; 7], None),
        ptp(a, Some(blend)),
        ptp(b, Some(blend)),
        ptp([0.0; 7], None),
    ];
    let program = Program {
        robot: None,
        start: Start::Joints([0.0; 7]),
        motions,
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    for shape in SHAPES {
        let options = PathOptions { blend_shape: shape, ..PathOptions::default() };
        let path = JointPath::with_options(&program, &Robot::lbr_iiwa_7_r800(), options).unwrap();
        let kinks = matches!(shape, BlendShape::Alpha(Continuity::First) | BlendShape::Circle);
        let error = Trajectory::plan(&path, Timing::jerk_limited()).err();
        assert_eq!(
            error,
            kinks.then_some(TimingError::CurvatureJumps { motion: MotionIndex::new(4) }),
            "{shape:?}"
        );
        if let Some(error) = error {
            assert!(error.to_string().starts_with("motion 5: "), "{error}");
        }
        plan(&path, 100);
    }
}

/// A joint that hardly moves can limit all others.
#[test]
fn one_joint_is_held_back() {
    let (a, b) = ([0.5, 0.3, 0.0, -0.8, 0.0, 0.4, 1.0], [0.2, 0.7, 0.3, -0.2, 0.5, 0.4, -1.0]);
    for joint in 0..7 {
        for [v, a_rel, j] in [[0.02, 1.0, 1.0], [1.0, 0.2, 1.0], [1.0, 1.0, 0.02]] {
            let held = |target| {
                let mut ptp = Ptp::to(target);
                ptp.velocity_rel[joint] = v;
                ptp.acceleration_rel[joint] = a_rel;
                ptp.jerk_rel[joint] = j;
                ptp
            };
            for motions in [
                [held(a).blend(Blend::Fraction(0.4)), Ptp::to(b)],
                [Ptp::to(a).blend(Blend::Fraction(0.4)), held(b)],
            ] {
                plan(&path([0.0; 7], &motions, BlendShape::Iiwa), 100);
            }
        }
    }
}
