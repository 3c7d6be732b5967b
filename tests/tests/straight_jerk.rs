//! Straight motions from rest to rest with jerk limits: their durations are known in closed form.
//! The comparison with ruckig is in `tests/peers`.

// Test helpers may panic.
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

use iiwa_kin::{Joints, Robot};
use iiwa_path::{BlendShape, Continuity, JointPath, PathOptions};
use iiwa_program::{
    Blend, LimitKind, Motion, MotionLimits, Program, Ptp, Sources, Start, Workcell,
};
use iiwa_traj::{JerkOptions, Timing, Trajectory};

/// Returns the duration from rest to rest over `distance`, in s, with speed, acceleration and jerk
/// limits.
fn duration_s(distance: f64, [v, a, j]: [f64; 3]) -> f64 {
    // Time to reach the speed `top`, with or without a phase of constant acceleration.
    let rise = |top: f64| if top >= a * a / j { top / a + a / j } else { 2.0 * (top / j).sqrt() };
    if v * rise(v) <= distance {
        distance / v + rise(v)
    } else if distance >= 2.0 * a.powi(3) / j.powi(2) {
        a / j + ((a / j).powi(2) + 4.0 * distance / a).sqrt()
    } else {
        (32.0 * distance / j).cbrt()
    }
}

/// Returns the expected duration of `ptp`: for each kind of limit, the smallest ratio of a joint's
/// limit to its displacement is critical.
fn expected_s(start: &Joints, ptp: &Ptp) -> f64 {
    let robot = MotionLimits::full(&Robot::lbr_iiwa_7_r800());
    let lower = LimitKind::ALL.map(|kind| {
        let (limit, share) = (robot.of(kind), ptp.share(kind));
        (0..7)
            .map(|i| limit[i] * share[i] / (ptp.target_rad[i] - start[i]).abs())
            .fold(f64::INFINITY, f64::min)
    });
    duration_s(1.0, lower)
}

fn path(start_rad: Joints, motions: Vec<Ptp>, blend_shape: BlendShape) -> JointPath {
    let motions = motions.into_iter().map(Motion::Ptp).collect();
    let program = Program {
        robot: None,
        start: Start::Joints(start_rad),
        motions,
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let options = PathOptions { blend_shape, ..PathOptions::default() };
    JointPath::with_options(&program, &Robot::lbr_iiwa_7_r800(), options).unwrap()
}

/// Returns the general solver, with cells finer by this factor.
fn general(refinement: f64) -> Timing {
    Timing::Jerk(JerkOptions { refinement, general: true })
}

fn found_s(start: Joints, ptp: &Ptp, timing: Timing) -> f64 {
    let path = path(start, vec![ptp.clone()], BlendShape::Iiwa);
    Trajectory::plan(&path, timing).unwrap().motion_time_s()
}

/// Returns joint `joint` (from 1) at `deg`, the others at zero.
fn single_joint(joint: usize, deg: f64) -> Joints {
    std::array::from_fn(|j| if j + 1 == joint { deg.to_radians() } else { 0.0 })
}

const ALL: Joints = [0.9, -0.8, 0.7, -0.6, 0.5, -0.4, 0.3];

/// Returns motions from zero: each joint alone and all together, long and short, with various
/// relative limits.
fn moves() -> Vec<Ptp> {
    let alone = (1..=7).flat_map(|joint| {
        [100.0, 40.0, 19.6, 5.0, 0.3, 0.01, 1e-4].map(|deg| Ptp::to(single_joint(joint, deg)))
    });
    let together = [1.0, 0.2, 1e-2, 1e-5].map(|size| Ptp::to(ALL.map(|q| q * size)));
    let shares = [
        [1.0, 1.0, 1.0],
        [0.3, 1.0, 1.0],
        [0.01, 1.0, 1.0],
        [1.0, 0.25, 1.0],
        [1.0, 1.0, 0.1],
        [0.3, 0.5, 0.02],
        [0.5, 0.02, 1.0],
    ];
    let mut moves: Vec<_> = alone
        .chain(together)
        .flat_map(|ptp| {
            shares.map(|[v, a, j]| Ptp {
                velocity_rel: [v; 7],
                acceleration_rel: [a; 7],
                jerk_rel: [j; 7],
                ..ptp.clone()
            })
        })
        .collect();
    // Different relative limits, so that three joints are critical.
    for size in [1.0, 0.1, 1e-3] {
        let mut ptp = Ptp::to(ALL.map(|q| q * size));
        ptp.velocity_rel[4] = 0.2;
        ptp.acceleration_rel[6] = 0.05;
        ptp.jerk_rel[2] = 0.03;
        moves.push(ptp);
    }
    moves
}

/// Returns the smallest and the largest relative difference of durations from the closed form.
fn differences(timing: Timing) -> [f64; 2] {
    let differences = moves().into_iter().map(|ptp| {
        let actual_s = found_s([0.0; 7], &ptp, timing);
        let difference = actual_s / expected_s(&[0.0; 7], &ptp) - 1.0;
        assert!(difference.abs() < 0.1, "{difference:e}: {ptp:?}");
        difference
    });
    let [lowest, highest] =
        differences.fold([0.0_f64; 2], |[low, high], d| [low.min(d), high.max(d)]);
    println!("{timing:?}: {lowest:+e} to {highest:+e}");
    [lowest, highest]
}

#[test]
fn joint_1_from_minus_20_to_20_deg() {
    // Limits of Larsen 2019, Tables 2 and 5.
    let expected = 40.0 / 98.0 + 98.0 / 490.0 + 490.0 / 10_384.86;
    let ptp = Ptp::to(single_joint(1, 20.0));
    for (timing, tolerance) in
        [(Timing::jerk_limited(), 1e-12), (general(1.0), 1e-3), (general(4.0), 1e-4)]
    {
        let error = found_s(single_joint(1, -20.0), &ptp, timing) / expected - 1.0;
        assert!(error.abs() < tolerance, "{timing:?}: {error:e}");
    }
}

#[test]
fn as_the_formula_says() {
    let [lowest, highest] = differences(Timing::jerk_limited());
    assert!(lowest > -1e-9 && highest < 1e-9);
}

/// Compares the general solver with the closed form. Where jerk is constant, its speed (square root
/// of x) is slightly below the optimum between the points at which the jerk limit is enforced.
/// Finer cells converge.
#[test]
fn the_general_solver_agrees() {
    for (refinement, tolerance) in [(1.0, [-1e-4, 1.5e-3]), (8.0, [-1e-4, 1e-4])] {
        let [lowest, highest] = differences(general(refinement));
        assert!(lowest > tolerance[0] && highest < tolerance[1], "{lowest:e} to {highest:e}");
    }
}

/// Collinear motions with blends are equal to the line from the first start to the last target.
#[test]
fn straight_on_through_blends() {
    let shapes = [
        BlendShape::Iiwa,
        BlendShape::Alpha(Continuity::Second),
        BlendShape::Alpha(Continuity::Third),
        BlendShape::MinAcceleration,
    ];
    let timing = |refinement| Timing::Jerk(JerkOptions { refinement, general: false });
    let mut largest = [0.0_f64; 2];
    for shape in shapes {
        for to in [single_joint(1, 90.0), ALL, ALL.map(|q| 0.05 * q)] {
            for blend in [Blend::Fraction(0.1), Blend::Fraction(0.25), Blend::Fraction(0.5)] {
                for [v, a, j] in [[1.0, 1.0, 1.0], [0.1, 1.0, 1.0], [0.7, 0.5, 0.1]] {
                    let part = |share: f64| Ptp {
                        velocity_rel: [v; 7],
                        acceleration_rel: [a; 7],
                        jerk_rel: [j; 7],
                        ..Ptp::to(to.map(|q| share * q))
                    };
                    let expected = expected_s(&[0.0; 7], &part(1.0));
                    let parts = vec![part(0.3).blend(blend), part(0.65).blend(blend), part(1.0)];
                    let path = path([0.0; 7], parts, shape);
                    assert!(path.blends().all(|(corner, _)| corner.gamma_deg.abs() < 1e-5));
                    for (largest, refinement) in largest.iter_mut().zip([1.0, 8.0]) {
                        let actual = Trajectory::plan(&path, timing(refinement)).unwrap();
                        let error = (actual.motion_time_s() / expected - 1.0).abs();
                        assert!(error < 0.1, "{shape:?} {blend:?} {v} {a} {j}: {error:e}");
                        *largest = largest.max(error);
                    }
                }
            }
        }
    }
    println!("largest errors {largest:?}");
    assert!(largest[0] < 2e-3 && largest[1] < 1e-4, "{largest:?}");
}

/// A LIN limited only by TCP limits takes the time of its seven phases, to the last digits; the
/// general solver, which does not use this form, takes hardly more.
#[test]
fn slow_lines_of_the_tcp() {
    let robot = Robot::lbr_iiwa_7_r800();
    for [speed, acceleration, jerk] in [
        [50.0, 200.0, 2000.0],
        [100.0, 1500.0, 3000.0],
        [20.0, 40.0, 1e4],
        [250.0, 150.0, 500.0],
        // Limited by the joint jerk.
        [100.0, 2000.0, 1e6],
    ] {
        let text = format!(
            r#"{{ "version": 1, "start": {{ "joints_deg": [0, 30, 0, -60, 0, 70, 0] }},
                 "motions": [{{ "type": "lin_rel",
                    "offset": {{ "x_mm": 40, "y_mm": -120, "z_mm": 30 }},
                    "cart_velocity_mm_s": {speed}, "cart_acceleration_mm_s2": {acceleration},
                    "cart_jerk_mm_s3": {jerk} }}] }}"#
        );
        let path = JointPath::new(&Program::from_json(&text).unwrap(), &robot).unwrap();
        let [jerk_limited, solved] = [Timing::jerk_limited(), general(1.0)]
            .map(|timing| Trajectory::plan(&path, timing).unwrap());
        let expected_s = duration_s(130.0, [speed, acceleration, jerk]);
        let [own_s, solved_s] = [&jerk_limited, &solved].map(Trajectory::motion_time_s);
        if jerk < 1e5 {
            assert!((own_s / expected_s - 1.0).abs() < 1e-12, "{text}: {own_s} {expected_s}");
        } else {
            assert!(own_s > 1.001 * expected_s, "{text}: {own_s} {expected_s}");
        }
        assert!((solved_s / own_s - 1.0).abs() < 1e-3, "{text}: {own_s} {solved_s}");
        // Enough nodes for the curves of the joints.
        let nodes = jerk_limited.sections()[0]
            .pieces()
            .iter()
            .map(|piece| jerk_limited.sections()[0].nodes(piece).len());
        assert!(nodes.sum::<usize>() > 50);
    }
}
