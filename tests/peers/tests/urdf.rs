//! URDF against independent readers: `urdf-rs` for the text, `k` for the kinematics. Files that the
//! readers disagree about are in `urdf_cases`.

#[path = "../../../crates/core/iiwa-kin/tests/urdf_examples.rs"]
mod urdf_examples;

use iiwa_kin::{Joints, Robot};
use nalgebra::{
    Isometry3, Matrix3, Point3, Rotation3, SymmetricEigen, Translation3, UnitQuaternion, Vector3,
};
use proptest::prelude::*;

use urdf_examples::{namings, odd_name, robots};

/// Poses inside the limits, the same ones every time.
fn poses(robot: &Robot, count: usize) -> Vec<Joints> {
    let mut state = 7_u64;
    let mut random = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
    };
    (0..count).map(|_| robot.limits().upper_rad.map(|limit| 0.999 * limit * random())).collect()
}

/// The crate `k` finds the links of a URDF where they are. Cross-validated: the crate `k`.
fn assert_links_are_found(robot: &Robot, urdf: &str, names: &[String], count: usize) {
    let chain = k::Chain::<f64>::from(urdf_rs::read_from_string(urdf).unwrap());
    for q in poses(robot, count) {
        chain.set_joint_positions(&q).unwrap();
        chain.update_transforms();
        let links = robot.link_poses(&q);
        assert_eq!(links[8], robot.flange_pose(&q));
        for (link, expected) in names.iter().zip(&links) {
            let actual = chain.find_link(link).unwrap().world_transform().unwrap();
            let rotation = actual.rotation.to_rotation_matrix();
            for i in 0..3 {
                let apart = actual.translation.vector[i] - expected.position_m[i];
                assert!(apart.abs() < 1e-12, "{link}: {apart} m");
                for c in 0..3 {
                    let apart = rotation[(i, c)] - expected.rotation[i][c];
                    assert!(apart.abs() < 1e-12, "{link}: {apart}");
                }
            }
        }
    }
}

#[test]
fn k_finds_the_same_poses() {
    let links: Vec<_> =
        (0..8).map(|link| format!("iiwa_link_{link}")).chain(["iiwa_link_ee".to_owned()]).collect();
    for robot in robots() {
        assert_links_are_found(&robot, &robot.to_urdf(), &links, 1000);
    }
}

/// The joints have other names, too.
#[test]
fn other_names_have_the_same_poses() {
    let robot = Robot::default();
    for (names, [joint, _, flange_joint, _]) in namings() {
        let urdf = robot.to_urdf_with_names(&names);
        assert_links_are_found(&robot, &urdf, &names.links(), 100);
        let read = urdf_rs::read_from_string(&urdf).unwrap();
        let joints: Vec<_> = read.joints.iter().map(|joint| &*joint.name).collect();
        assert_eq!((joints[0], joints[7]), (joint, flange_joint));
        assert_eq!(joints[..7], names.joints());
    }
}

/// Cross-validated: the crate `urdf-rs`.
#[test]
fn numbers_read_back_exactly() {
    for robot in robots() {
        let read = urdf_rs::read_from_string(&robot.to_urdf()).unwrap();
        assert_eq!(read.name, robot.name());
        for (j, joint) in read.joints.iter().take(7).enumerate() {
            assert_eq!(joint.name, format!("iiwa_joint_{}", j + 1));
            assert_eq!(joint.limit.upper.to_bits(), robot.limits().upper_rad[j].to_bits());
            assert_eq!(joint.limit.lower.to_bits(), robot.limits().lower_rad[j].to_bits());
            assert_eq!(joint.limit.velocity.to_bits(), robot.limits().velocity_rad_s[j].to_bits());
            assert_eq!(joint.limit.effort.to_bits(), robot.limits().torque_nm[j].to_bits());
        }
        for (link, mass) in read.links.iter().zip(robot.link_mass_kg()) {
            assert_eq!(link.inertial.mass.value.to_bits(), mass.to_bits());
        }
        for (link, body) in read.links[1..].iter().zip(robot.links()) {
            let i = &link.inertial.inertia;
            assert_eq!(*link.inertial.origin.xyz, body.center_m);
            assert_eq!([i.ixx, i.ixy, i.ixz, i.iyy, i.iyz, i.izz], body.inertia_kg_m2);
        }
    }
}

#[test]
fn inertias_are_those_of_bodies() {
    for robot in robots() {
        let read = urdf_rs::read_from_string(&robot.to_urdf()).unwrap();
        for link in &read.links[..8] {
            let i = &link.inertial.inertia;
            let tensor =
                Matrix3::new(i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz);
            let m = SymmetricEigen::new(tensor).eigenvalues;
            assert!(m.min() > 0.0 && 2.0 * m.max() <= m.sum(), "{}: {m}", link.name);
            // Nothing of a link is farther from its centre than 0.4 m.
            assert!(m.max() < link.inertial.mass.value * 0.16);
        }
    }
}

fn isometry(origin: &urdf_rs::Pose) -> Isometry3<f64> {
    let [roll, pitch, yaw] = *origin.rpy;
    let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Isometry3::from_parts(Translation3::from(*origin.xyz), rotation)
}

/// Distance of `point` from the inside of `shape`, in m.
fn distance(shape: &urdf_rs::Visual, link: &Isometry3<f64>, point: Point3<f64>) -> f64 {
    let p = (link * isometry(&shape.origin)).inverse_transform_point(&point);
    match shape.geometry {
        urdf_rs::Geometry::Cylinder { radius, length } => {
            let out = (p.x.hypot(p.y) - radius).max(0.0);
            out.hypot((p.z.abs() - length / 2.0).max(0.0))
        }
        urdf_rs::Geometry::Sphere { radius } => (p.coords.norm() - radius).max(0.0),
        _ => panic!("a shape that needs a file"),
    }
}

#[test]
fn shapes_cover_the_arm() {
    for robot in robots() {
        let read = urdf_rs::read_from_string(&robot.to_urdf()).unwrap();
        assert!(read.links.iter().all(|link| link.visual.len() == link.collision.len()));
        for q in poses(&robot, 20).into_iter().chain([[0.0; 7]]) {
            let links = robot.link_poses(&q).map(|pose| pose.to_isometry());
            for pair in links.windows(2) {
                for step in 0..=50 {
                    let share = f64::from(step) / 50.0;
                    let [from, to] = [0, 1].map(|end| pair[end].translation.vector);
                    let point = Point3::from(from.lerp(&to, share));
                    let nearest = read
                        .links
                        .iter()
                        .zip(&links)
                        .flat_map(|(link, pose)| link.visual.iter().map(move |v| (v, pose)))
                        .map(|(shape, pose)| distance(shape, pose, point))
                        .fold(f64::INFINITY, f64::min);
                    assert!(nearest < 1e-9, "{point} is {nearest} m from the arm at {q:?}");
                }
            }
        }
    }
}

#[test]
fn a_name_cannot_break_the_xml() {
    let robot = odd_name();
    let read = urdf_rs::read_from_string(&robot.to_urdf()).unwrap();
    assert_eq!(read.name, robot.name());
}

proptest! {
    /// Wherever the frames lie, the chain is the same.
    #[test]
    fn shifted_frames_are_the_same_chain(shifts in prop::array::uniform7(-0.5..0.5_f64)) {
        // Joint j is shifted along its own axis; its child's origin is shifted back.
        let robot = Robot::default();
        let mut read = urdf_rs::read_from_string(&robot.to_urdf()).unwrap();
        for (j, shift) in shifts.into_iter().enumerate() {
            let [roll, pitch, yaw] = *read.joints[j].origin.rpy;
            let rotation = Rotation3::from_euler_angles(roll, pitch, yaw);
            let along = rotation * Vector3::new(0.0, 0.0, shift);
            for i in 0..3 {
                read.joints[j].origin.xyz[i] += along[i];
            }
            read.joints[j + 1].origin.xyz[2] -= shift;
        }
        let report = robot.check_urdf(&urdf_rs::write_to_string(&read).unwrap(), None).unwrap();
        prop_assert!(report.position_deviation_m < 1e-12);
        prop_assert!(report.limits.is_empty());
    }
}
