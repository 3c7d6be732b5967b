//! Forward kinematics, compared with published values, with the plain matrix product and between
//! code paths.

// Two code paths to one number must give identical bits.
#![allow(clippy::float_cmp)]

use iiwa_kin::{Joints, Pose, Robot};
use nalgebra::{Matrix4, Vector3};
use proptest::prelude::*;

fn any_joints() -> impl Strategy<Value = Joints> {
    prop::array::uniform7(-3.0..3.0_f64)
}

fn product(robot: &Robot, q: &Joints) -> Matrix4<f64> {
    robot.dh().iter().zip(q).fold(Matrix4::identity(), |t, (row, q)| t * row.transform(*q))
}

/// Cross-validated: values of the public `lbr_description` chain.
#[test]
fn published_poses() {
    let robot = Robot::lbr_iiwa_7_r800();
    let up = robot.flange_pose(&[0.0; 7]);
    assert!((Vector3::from(up.position_m) - Vector3::new(0.0, 0.0, 1.292)).norm() < 1e-9);
    assert!((up.rotation_matrix() - nalgebra::Matrix3::identity()).norm() < 1e-9);
    let bent = robot.flange_pose(&[0.0, 0.5, 0.0, -1.0, 0.0, 0.7, 0.0]);
    let expected = Vector3::new(0.713_659_663, 0.0, 0.629_875_736);
    assert!((Vector3::from(bent.position_m) - expected).norm() < 1e-9);
}

proptest! {
    #[test]
    fn equals_the_product_of_the_table(q in any_joints(), big in any::<bool>()) {
        let robot = if big { Robot::lbr_iiwa_14_r820() } else { Robot::lbr_iiwa_7_r800() };
        let expected = product(&robot, &q);
        let tcp = robot.flange_pose(&q);
        for i in 0..3 {
            prop_assert!((tcp.position_m[i] - expected[(i, 3)]).abs() < 1e-14);
            for k in 0..3 {
                prop_assert!((tcp.rotation[i][k] - expected[(i, k)]).abs() < 1e-14);
            }
        }
        let position = robot.flange_position(&q);
        prop_assert!((Vector3::from(position) - Vector3::from(tcp.position_m)).norm() < 1e-14);
        let flange = robot.link_poses(&q)[8];
        prop_assert!((flange.to_isometry().inverse() * tcp.to_isometry()).rotation.angle() < 1e-7);
        prop_assert!((Vector3::from(flange.position_m) - Vector3::from(position)).norm() < 1e-14);
    }

    #[test]
    fn velocity_is_the_jacobian_times_the_rate(q in any_joints(), rate in any_joints()) {
        let robot = Robot::default();
        let (p, v) = robot.flange_motion(&q, &rate);
        prop_assert_eq!(p, robot.flange_position(&q));
        let twist = robot.jacobian(&q) * nalgebra::SVector::from(rate);
        prop_assert!((twist.fixed_rows::<3>(0) - Vector3::from(v)).norm() < 1e-13);
    }

    #[test]
    fn a_tcp_moves_as_its_positions_differ(
        q in any_joints(),
        rate in any_joints(),
        tcp in prop::array::uniform3(-0.3..0.3_f64),
    ) {
        let robot = Robot::default();
        let at = |step: f64| {
            let pose = robot.flange_pose(&std::array::from_fn(|j| q[j] + step * rate[j]));
            Vector3::from(pose.position_m) + pose.rotation_matrix() * Vector3::from(tcp)
        };
        let (p, v) = robot.tcp_motion(&tcp, &q, &rate);
        prop_assert!((Vector3::from(p) - at(0.0)).norm() < 1e-13);
        let step = 1e-5;
        prop_assert!((Vector3::from(v) - (at(step) - at(-step)) / (2.0 * step)).norm() < 1e-6);
    }

    #[test]
    fn jacobian_is_the_derivative(q in any_joints(), j in 0..7_usize) {
        let robot = Robot::default();
        let h = 1e-6;
        let at = |step: f64| {
            let mut moved = q;
            moved[j] += step;
            robot.flange_pose(&moved).to_isometry()
        };
        let (before, after) = (at(-h), at(h));
        let linear = (after.translation.vector - before.translation.vector) / (2.0 * h);
        let angular = (after.rotation * before.rotation.inverse()).scaled_axis() / (2.0 * h);
        let jacobian = robot.jacobian(&q);
        prop_assert!((jacobian.fixed_view::<3, 1>(0, j) - linear).norm() < 1e-8);
        prop_assert!((jacobian.fixed_view::<3, 1>(3, j) - angular).norm() < 1e-8);
        prop_assert!(linear.norm() <= robot.axis_reach_m()[j] + 1e-8);
    }

    #[test]
    fn a_batch_is_bit_for_bit_the_same(
        mut all in prop::collection::vec(any_joints(), 0..40),
        huge in prop::option::of((0..40_usize, 0..7_usize)),
    ) {
        if let Some((pose, joint)) = huge
            && let Some(q) = all.get_mut(pose)
        {
            q[joint] *= 1e9;
        }
        let robot = Robot::default();
        let mut poses = vec![Pose::IDENTITY; all.len()];
        robot.flange_pose_batch(&all, &mut poses);
        for (q, pose) in all.iter().zip(&poses) {
            let bits = |pose: &Pose| {
                (pose.position_m.map(f64::to_bits), pose.rotation.map(|row| row.map(f64::to_bits)))
            };
            prop_assert_eq!(bits(pose), bits(&robot.flange_pose(q)));
        }
    }
}
