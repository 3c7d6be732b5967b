//! Inverse kinematics, compared with forward kinematics, the Jacobian and finite differences.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::f64::consts::PI;

use iiwa_kin::{
    FlangePoint, Joints, MovingPose, Number, Pose, Redundancy, Robot, SingularPart, Status, Taylor,
    Turn, Unreachable,
};
use nalgebra::{SVector, Vector3};
use proptest::prelude::*;
use proptest::test_runner::Config;

/// Both robots with both flanges.
fn robots() -> [Robot; 4] {
    let [small, big] = [Robot::lbr_iiwa_7_r800(), Robot::lbr_iiwa_14_r820()];
    let plain = |robot: &Robot| robot.clone().with_flange_m(0.126).unwrap();
    [plain(&small), plain(&big), small, big]
}

fn any_robot() -> impl Strategy<Value = Robot> {
    prop::sample::select(robots().to_vec())
}

/// Any joint positions within the joint ranges.
fn any_joints() -> impl Strategy<Value = Joints> {
    let limits = *Robot::default().limits();
    prop::array::uniform7(-1.0..1.0_f64).prop_map(move |shares| limits.at_shares(&shares))
}

/// Largest difference between the numbers of two poses.
fn apart(a: &Pose, b: &Pose) -> f64 {
    let numbers = |pose: &Pose| {
        let mut all = pose.position_m.to_vec();
        all.extend(pose.rotation.as_flattened());
        all
    };
    let (a, b) = (numbers(a), numbers(b));
    a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn turn_about(axis: &[f64; 3], angle: Taylor) -> [[Taylor; 3]; 3] {
    let [x, y, z] = *axis;
    let across = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let (sin, cos) = angle.sin_cos();
    let rest = -cos + 1.0;
    std::array::from_fn(|i| {
        std::array::from_fn(|k| {
            let same = if i == k { cos } else { Taylor::constant(0.0) };
            same + sin * across[i][k] + rest * (axis[i] * axis[k])
        })
    })
}

/// A flange that moves along a parabola from `start` while rotating about an axis, both
/// non-uniformly.
fn swing(
    start: &Pose,
    velocity: &[f64; 3],
    bend: &[f64; 3],
    axis: &[f64; 3],
    s: Taylor,
) -> MovingPose {
    let turn = turn_about(axis, s * 0.7 + s * s * 0.4);
    let zero = Taylor::constant(0.0);
    MovingPose {
        position_m: std::array::from_fn(|i| {
            s * velocity[i] + s * s * bend[i] + start.position_m[i]
        }),
        rotation: std::array::from_fn(|i| {
            std::array::from_fn(|k| {
                (0..3).fold(zero, |sum, j| sum + turn[i][j] * start.rotation[j][k])
            })
        }),
    }
}

/// True if the joint positions are far enough from singularities that rounding and
/// finite-difference steps do not matter.
fn regular(robot: &Robot, joints: &Joints) -> bool {
    robot.singularity(joints).nearest().0 > 0.2
}

proptest! {
    #![proptest_config(Config::with_cases(100_000))]

    #[test]
    fn joints_come_back(robot in any_robot(), joints in any_joints()) {
        let flange = robot.flange_pose(&joints);
        let redundancy = robot.redundancy(&joints);
        let actual = robot.inverse(&flange, redundancy.e1_rad, redundancy.status)?;
        prop_assert!(apart(&robot.flange_pose(&actual), &flange) < 1e-9);
        if robot.singularity(&joints).nearest().0 > 1e-3 {
            for j in 0..7 {
                prop_assert!(
                    (actual[j] - joints[j]).abs() < 1e-9,
                    "{j}: {actual:?} for {joints:?}"
                );
            }
            prop_assert_eq!(
                robot.redundancy(&actual),
                Redundancy { e1_rad: actual[2], ..redundancy }
            );
        }
    }
}

proptest! {
    #![proptest_config(Config::with_cases(2_000))]

    #[test]
    fn every_status_reaches_the_pose(robot in any_robot(), joints in any_joints()) {
        let flange = robot.flange_pose(&joints);
        for status in Status::all() {
            let actual = robot.inverse(&flange, joints[2], status)?;
            prop_assert!(apart(&robot.flange_pose(&actual), &flange) < 1e-9);
            prop_assert_eq!(actual[2], joints[2]);
            if robot.singularity(&joints).nearest().0 > 1e-6 {
                prop_assert_eq!(Status::of(&robot, &actual), status);
            }
        }
    }

    #[test]
    fn e1_ranges_are_where_joints_are_within_limits(
        robot in any_robot(),
        joints in any_joints(),
        e1 in -PI..PI,
    ) {
        let flange = robot.flange_pose(&joints);
        let status = Status::of(&robot, &joints);
        let inside =
            |ranges: &[[f64; 2]], e1: f64| ranges.iter().any(|[a, b]| *a <= e1 && e1 <= *b);
        let far =
            |ranges: &[[f64; 2]]| ranges.as_flattened().iter().all(|end| (end - e1).abs() > 1e-7);

        let reachable = robot.reachable_e1(&flange)?;
        let actual = robot.inverse(&flange, e1, status);
        if far(&reachable) {
            prop_assert_eq!(actual.is_ok(), inside(&reachable, e1), "{:?} {}", reachable, e1);
        }
        let allowed = robot.allowed_e1(&flange, status)?;
        prop_assert!(allowed.windows(2).all(|pair| pair[0][1] < pair[1][0]), "{:?}", allowed);
        prop_assert!(allowed.iter().all(|[from, to]| from <= to), "{:?}", allowed);
        for end in allowed.as_flattened() {
            let at_end = robot.inverse(&flange, *end, status)?;
            prop_assert!(robot.limits().check(&at_end).is_ok(), "{} of {:?}", end, allowed);
        }
        let fits_at = |e1: f64| {
            let actual = robot.inverse(&flange, e1, status);
            actual.is_ok_and(|actual| robot.limits().check(&actual).is_ok())
        };
        // A joint that barely touches or leaves its limit may do so between the sampled values.
        let narrow = |e1: f64| {
            [-1.0, 1.0].iter().any(|side| {
                let near = fits_at(e1 + side * 0.5_f64.to_radians());
                near != inside(&allowed, e1) || near != fits_at(e1)
            })
        };
        if far(&allowed) && !narrow(e1) {
            prop_assert_eq!(fits_at(e1), inside(&allowed, e1), "{:?} {}", allowed, e1);
        }
        if regular(&robot, &joints) {
            prop_assert!(inside(&allowed, joints[2]) || narrow(joints[2]), "{:?}", allowed);
        }
    }

    #[test]
    fn derivatives_are_those_of_the_joints(
        robot in any_robot(),
        joints in any_joints(),
        velocity in prop::array::uniform3(-0.3..0.3_f64),
        bend in prop::array::uniform3(-0.3..0.3_f64),
        axis in prop::array::uniform3(-1.0..1.0_f64),
        e1_rate in -0.5..0.5_f64,
    ) {
        prop_assume!(regular(&robot, &joints));
        let length = axis.iter().map(|a| a * a).sum::<f64>().sqrt();
        prop_assume!(length > 0.1);
        let axis = axis.map(|a| a / length);
        let start = robot.flange_pose(&joints);
        let status = Status::of(&robot, &joints);
        let at = |s: f64| {
            let s = Taylor::variable(s);
            let flange = swing(&start, &velocity, &bend, &axis, s);
            let actual =
                robot.inverse_moving(&flange, s * s * 0.1 + s * e1_rate + joints[2], status);
            actual.map(|actual| (flange, actual))
        };
        let (flange, actual) = at(0.0)?;
        let plain = robot.inverse(&flange.pose(), joints[2], status)?;
        for j in 0..7 {
            prop_assert!((actual[j].0[0] - plain[j]).abs() < 1e-15);
        }

        // The twist.
        let rate = SVector::<f64, 7>::from_fn(|j, _| actual[j].derivatives()[1]);
        let twist = robot.jacobian(&joints) * rate;
        prop_assert!((twist.fixed_rows::<3>(0) - Vector3::from(velocity)).norm() < 1e-10);
        prop_assert!((twist.fixed_rows::<3>(3) - Vector3::from(axis) * 0.7).norm() < 1e-10);

        // Each derivative is compared with central differences of the preceding one, with an error
        // of h^4.
        let h = 1e-4;
        let near = [at(-2.0 * h)?.1, at(-h)?.1, at(h)?.1, at(2.0 * h)?.1];
        for j in 0..7 {
            let around = near.map(|joints| joints[j].derivatives());
            let derivatives = actual[j].derivatives();
            for order in 0..3 {
                let [a, b, c, d] = around.map(|derivatives| derivatives[order]);
                let slope = ((a - d) + 8.0 * (c - b)) / (12.0 * h);
                let error = (slope - derivatives[order + 1]).abs();
                prop_assert!(
                    error < 1e-6 * (1.0 + derivatives[order + 1].abs()),
                    "A{}: derivative {} is {}, and {slope} by differences",
                    j + 1,
                    order + 1,
                    derivatives[order + 1]
                );
            }
        }
    }

    #[test]
    fn abc_and_products_of_poses(
        position in prop::array::uniform3(-1.0..1.0_f64),
        abc in prop::array::uniform3(-3.1..3.1_f64),
        steep in prop::option::of(prop::sample::select(vec![1e-13, 1e-10, 1e-6, -1e-10, 0.0])),
    ) {
        let mut abc = abc;
        if let Some(short_of) = steep {
            abc[1] = (PI / 2.0 - short_of).copysign(abc[1]);
        }
        let pose = Pose::from_xyz_abc(position, abc);
        let isometry = nalgebra::Rotation3::from_euler_angles(abc[2], abc[1], abc[0]);
        prop_assert!((isometry.matrix() - pose.rotation_matrix()).norm() < 1e-14);
        prop_assert!(apart(&Pose::from_xyz_abc(position, pose.abc_rad()), &pose) < 1e-12);
        prop_assert!(apart(&pose.then(&pose.inverse()), &Pose::IDENTITY) < 1e-14);

        let other = Pose::from_xyz_abc([0.3, -0.2, 0.1], [0.5, 1.0, -2.0]);
        let moved = MovingPose::constant(&pose).then_fixed(&other);
        prop_assert!(apart(&moved.pose(), &pose.then(&other)) < 1e-15);
        let turned = moved.carried_by(&pose).pose();
        prop_assert!(apart(&turned, &pose.then(&pose).then(&other)) < 1e-14);
        let product = pose.to_isometry() * other.to_isometry();
        prop_assert!(
            (product.translation.vector - Vector3::from(moved.pose().position_m)).norm() < 1e-7
        );
    }
}

/// At singularities many solutions exist, and one of them is returned.
#[test]
fn singular_poses_are_reached() {
    for robot in robots() {
        for degrees in [
            [0.0; 7],
            [30.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [30.0, 0.0, 0.0, 60.0, 0.0, -60.0, 20.0],
            [10.0, 20.0, 30.0, 40.0, 50.0, 0.0, 60.0],
            [10.0, 20.0, 30.0, 0.0, 50.0, 40.0, 60.0],
            [10.0, 0.0, 90.0, 40.0, 50.0, 40.0, 60.0],
            [0.0, 90.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        ] {
            let joints = degrees.map(f64::to_radians);
            let flange = robot.flange_pose(&joints);
            for status in Status::all() {
                let actual = robot.inverse(&flange, joints[2], status).unwrap();
                assert!(actual.iter().all(|q| q.is_finite()), "{degrees:?}: {actual:?}");
                let off = apart(&robot.flange_pose(&actual), &flange);
                assert!(off < 2e-9, "{degrees:?} with {status}: off by {off:e}");
            }
        }
    }
}

#[test]
fn reports_the_distance_out_of_reach() {
    let robot = Robot::lbr_iiwa_7_r800();
    let status = Status::new(0).unwrap();
    let upright = |x, z| Pose { position_m: [x, 0.0, z], ..Pose::IDENTITY };
    let far = robot.inverse(&upright(0.0, 0.34 + 0.8 + 0.152 + 0.0125), 0.0, status).unwrap_err();
    let expected = "out of reach: the arm is 12.500 mm too short: the wrist would be 812.500 mm \
                    from the shoulder, and the stretched arm reaches 800.000 mm";
    assert!(matches!(far, Unreachable::TooFar { by_mm, .. } if (by_mm - 12.5).abs() < 1e-9));
    assert_eq!(far.to_string(), expected);

    // Upper arm and forearm of the iiwa 14 differ by 20 mm.
    let big = Robot::lbr_iiwa_14_r820();
    let near = big.inverse(&upright(0.005, 0.36 + 0.152), 0.0, status).unwrap_err();
    let expected = "out of reach: the wrist is 15.000 mm too near to the shoulder: it would be \
                    5.000 mm from the shoulder, and the folded arm comes as near as 20.000 mm";
    assert!(matches!(near, Unreachable::TooNear { by_mm, .. } if (by_mm - 15.0).abs() < 1e-9));
    assert_eq!(near.to_string(), expected);

    let low = robot.flange_pose(&[0.0, 0.5, 0.0, 2.0, 0.0, 1.0, 0.0]);
    let e1 = robot.inverse(&low, 1.5, status).unwrap_err();
    let Unreachable::E1 { e1_rad, within_rad } = e1 else { panic!("{e1}") };
    assert_eq!(e1_rad, 1.5);
    assert!(robot.inverse(&low, within_rad - 1e-6, status).is_ok());
    assert!(robot.inverse(&low, within_rad + 1e-6, status).is_err());
    assert!(e1.to_string().contains(&format!("{:.3} deg", within_rad.to_degrees())), "{e1}");
}

/// The definition, checked at joint positions with obvious signs.
#[test]
fn status_and_turn_are_signs() {
    let robot = Robot::lbr_iiwa_7_r800();
    let redundancy_of = |degrees: Joints| robot.redundancy(&degrees.map(f64::to_radians));
    assert_eq!(redundancy_of([0.0; 7]).status.bits(), 0);
    assert_eq!(redundancy_of([0.0; 7]).turn.bits(), 0);
    let overhead = redundancy_of([0.0, -60.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!((overhead.status.bits(), overhead.turn.bits()), (1, 2));
    // The upper arm leans back, but the wrist is still ahead.
    assert_eq!(redundancy_of([0.0, -10.0, 0.0, -90.0, 0.0, 0.0, 0.0]).status.bits(), 2);
    let all = redundancy_of([-1.0, -1.0, -1.0, 1.0, -1.0, -1.0, -1.0]);
    assert_eq!((all.status.bits(), all.turn.bits()), (5, 0b111_0111));
    assert_eq!((Status::new(8), Turn::new(128)), (None, None));
}

/// The three distances are zero where the Jacobian without the A3 column is singular.
#[test]
fn singularity_is_the_determinant() {
    for robot in robots() {
        let (d3, d5) = (robot.lengths().upper_arm_m, robot.lengths().forearm_m);
        for degrees in [
            [10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0],
            [0.0, -35.0, 80.0, -100.0, 20.0, -5.0, 0.0],
            [0.0, 100.0, -140.0, 70.0, 120.0, 95.0, 15.0],
        ] {
            let joints = degrees.map(f64::to_radians);
            let determinant = robot.jacobian(&joints).remove_column(2).determinant();
            let measure = robot.singularity(&joints);
            let product = d3 * d5 * measure.elbow * measure.shoulder * (d3 + d5) * measure.wrist;
            assert!((determinant.abs() - product).abs() < 1e-12, "{determinant} and {product}");
        }
    }
    let stretched = Robot::default().singularity(&[0.0, 0.5, 0.0, 0.01, 0.0, 0.5, 0.0]);
    assert_eq!(stretched.nearest().1, SingularPart::Elbow);
}

proptest! {
    #![proptest_config(Config::with_cases(20_000))]

    /// A flange point returns to its position with unchanged wrist joints.
    #[test]
    fn joints_of_a_point_come_back(
        robot in any_robot(), joints in any_joints(), point in prop::array::uniform3(-0.3..0.3_f64)
    ) {
        let flange = robot.flange_pose(&joints);
        let place: [f64; 3] = std::array::from_fn(|i| {
            flange.position_m[i] + (0..3).map(|k| flange.rotation[i][k] * point[k]).sum::<f64>()
        });
        let wrist = [joints[4], joints[5], joints[6]];
        let actual =
            FlangePoint::new(&robot, point, &joints).joints_at(&robot, &place, joints[2], wrist)?;
        let again = robot.flange_pose(&actual);
        for (i, place) in place.iter().enumerate() {
            let turned = (0..3).map(|k| again.rotation[i][k] * point[k]).sum::<f64>();
            let off = again.position_m[i] + turned - place;
            prop_assert!(off.abs() < 1e-7, "{off:e}: {actual:?} for {joints:?}");
        }
        let [a4, others] = [actual[3] - joints[3], actual[0] - joints[0]].map(f64::abs);
        prop_assert!(a4 < 1e-3 && others < 1e-3, "{actual:?} for {joints:?}");
    }
}
