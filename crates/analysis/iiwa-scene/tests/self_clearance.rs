//! Self-clearance of the arm, compared with points on its surfaces, and over whole plans.

// Test helpers may panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use iiwa_kin::{Along, Joints, Pose, Robot, Shape, Solid};
use iiwa_path::JointPath;
use iiwa_program::{Motion, Program, Ptp, Sources, Start, Workcell};
use iiwa_scene::{ArmInScene, Form, Obstacle, Other, Scene, ToolShape};
use iiwa_traj::{Timing, Trajectory};
use nalgebra::{Isometry3, Point3, Rotation3, Vector3};

/// Tolerance of the search, in m.
const TOLERANCE_M: f64 = 1e-4;

fn isometry(pose: &Pose) -> Isometry3<f64> {
    pose.to_isometry()
}

/// Returns the frame of a shape in its link frame, with z along the shape.
fn frame(shape: &Shape) -> Isometry3<f64> {
    let turn = match shape.solid {
        Solid::Cylinder { along: Along::Y, .. } => {
            Rotation3::rotation_between(&Vector3::z(), &Vector3::y()).unwrap()
        }
        _ => Rotation3::identity(),
    };
    Isometry3::from_parts(Vector3::from(shape.center_m).into(), turn.into())
}

/// Returns radius and half-length; a sphere has no half-length.
fn size(shape: &Shape) -> (f64, Option<f64>) {
    match shape.solid {
        Solid::Cylinder { radius_m, length_m, .. } => (radius_m, Some(0.5 * length_m)),
        Solid::Sphere { radius_m } => (radius_m, None),
    }
}

/// Returns points on the surface of a shape, about a centimetre apart, in its own frame.
fn points(shape: &Shape) -> Vec<Point3<f64>> {
    let (radius, half) = size(shape);
    let mut points = Vec::new();
    for i in 0..48 {
        let (sin, cos) = (f64::from(i) * TAU / 48.0).sin_cos();
        for k in 0..=24 {
            let share = f64::from(k) / 24.0;
            if let Some(half) = half {
                let z = half * (2.0 * share - 1.0);
                points.push(Point3::new(radius * cos, radius * sin, z));
                let r = radius * share;
                points.extend([-half, half].map(|z| Point3::new(r * cos, r * sin, z)));
            } else {
                let (across, along) = (0.5 * TAU * share).sin_cos();
                points.push(Point3::from(radius * Vector3::new(across * cos, across * sin, along)));
            }
        }
    }
    points
}

/// Returns the exact distance of a point from a shape, in the shape frame; 0 inside.
fn distance(shape: &Shape, point: &Point3<f64>) -> f64 {
    let (radius, half) = size(shape);
    match half {
        Some(half) => {
            let across = point.coords.xy().norm() - radius;
            across.max(0.0).hypot((point.z.abs() - half).max(0.0))
        }
        None => (point.coords.norm() - radius).max(0.0),
    }
}

/// Returns true if a sphere has a constant distance from another shape: its centre is at rest in
/// the other frame.
fn is_rigid(robot: &Robot, [(link, a), (other, b)]: [(usize, &Shape); 2]) -> bool {
    let at = |k: u32| {
        let poses = robot
            .link_poses(&[0.31, -0.7, 1.1, 0.9, -1.3, 0.8, 2.0].map(|q| q * f64::from(k) / 4.0));
        let a_in_b =
            (isometry(&poses[other]) * frame(b)).inv_mul(&(isometry(&poses[link]) * frame(a)));
        match (size(a).1, size(b).1) {
            (None, _) => distance(b, &(a_in_b * Point3::origin())),
            (_, None) => distance(a, &(a_in_b.inverse() * Point3::origin())),
            _ => f64::from(k),
        }
    };
    (1..4).all(|k| (at(k) - at(0)).abs() < 1e-9)
}

/// Returns the smallest distance of links that are three or more apart and move relative to each
/// other.
fn by_points(robot: &Robot, q: &Joints) -> f64 {
    let shapes = robot.link_shapes();
    let poses = robot.link_poses(q);
    let mut min_distance = f64::MAX;
    for link in 3..8 {
        for other in 0..=link - 3 {
            for (a, b) in
                shapes[link].iter().flat_map(|a| shapes[other].iter().map(move |b| (a, b)))
            {
                if is_rigid(robot, [(link, a), (other, b)]) {
                    continue;
                }
                let [to_a, to_b] =
                    [(link, a), (other, b)].map(|(l, it)| isometry(&poses[l]) * frame(it));
                let a_in_b = to_b.inv_mul(&to_a);
                let distance_to = |point: &Point3<f64>| distance(b, &(a_in_b * point));
                min_distance = points(a).iter().map(distance_to).fold(min_distance, f64::min);
            }
        }
    }
    min_distance
}

#[test]
fn poses_are_as_near_as_their_points() {
    let mut random = fastrand::Rng::with_seed(5);
    let mut touching = 0;
    for round in 0..400 {
        let robot =
            if round % 2 == 0 { Robot::lbr_iiwa_7_r800() } else { Robot::lbr_iiwa_14_r820() };
        let upper_rad = robot.limits().upper_rad;
        let mut q = upper_rad.map(|limit| limit * (2.0 * random.f64() - 1.0));
        if round % 4 == 0 {
            // Folded over its base.
            (q[1], q[2], q[3]) =
                (1.95 - 0.3 * random.f64(), 0.2 * random.f64(), -2.0 + 0.3 * random.f64());
        }
        let arm = ArmInScene::new(&robot, &Scene::default());
        assert_eq!(arm.clearance(&q), None);
        let actual = arm.self_clearance(&q).unwrap();
        let Other::Link(other) = actual.other else { panic!("{actual:?}") };
        assert!(actual.link >= other + 3);
        let points_m = by_points(&robot, &q);
        assert!(actual.distance_m <= points_m + 1e-6, "{q:?}: {points_m} m, {actual:?}");
        assert!(actual.distance_m > points_m - 0.012, "{q:?}: {points_m} m, {actual:?}");
        touching += u32::from(actual.distance_m == 0.0);
        let way: f64 =
            std::iter::zip(actual.on_link_m, actual.on_other_m).map(|(a, b)| (a - b).powi(2)).sum();
        assert!((way.sqrt() - actual.distance_m).abs() < 1e-9);
    }
    assert!(touching > 5, "{touching}");
}

/// Adjacent links and links next but one are not checked since they keep apart; no pose brings the
/// checked ones closer without a collision with the base.
#[test]
fn the_upper_arm_and_the_wrist_keep_clear() {
    for robot in [Robot::lbr_iiwa_7_r800(), Robot::lbr_iiwa_14_r820()] {
        let arm = ArmInScene::new(&robot, &Scene::default());
        let limits = robot.limits();
        let mut random = fastrand::Rng::with_seed(6);
        for _ in 0..50_000 {
            // With the arm upright, only A3 to A7 fold it.
            let mut q = limits.upper_rad.map(|limit| limit * (2.0 * random.f64() - 1.0));
            q[1] = 0.0;
            assert!(arm.self_clearance(&q).unwrap().distance_m > 0.03, "{q:?}");
        }
    }
}

fn plan(from_rad: Joints, to_rad: &[Joints]) -> Trajectory {
    let motions = to_rad.iter().map(|to| Motion::Ptp(Ptp::to(*to))).collect();
    let start = Start::Joints(from_rad);
    let program = Program {
        robot: None,
        start,
        motions,
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let path = JointPath::new(&program, &Robot::default()).unwrap();
    Trajectory::plan(&path, Timing::default()).unwrap()
}

/// No sample of a plan is nearer than the result, and the result is the clearance of a pose.
#[test]
fn plans_are_as_near_as_their_samples() {
    let robot = Robot::default();
    let mut random = fastrand::Rng::with_seed(7);
    let limits = robot.limits();
    let hook = ToolShape::Box {
        center_m: [0.25, 0.0, 0.02],
        size_m: [0.5, 0.04, 0.04],
        rpy_rad: [0.0; 3],
    };
    let (mut by_tool, mut touching) = (0, 0);
    for round in 0..60 {
        let mut pose = || limits.at_shares(&[(); 7].map(|()| 1.9 * (random.f64() - 0.5)));
        let plan = plan(pose(), &[pose(), pose()]);
        let scene = Scene::default();
        let tool = vec![hook.clone()];
        let scene = if round % 2 == 0 { scene.with_tool(tool).unwrap() } else { scene };
        let arm = ArmInScene::new(&robot, &scene);
        let actual = arm.self_clearance_of(&plan).unwrap();
        let distance_m = actual.clearance.distance_m;
        let at_time = arm.self_clearance(&plan.at(actual.at_s).q).unwrap();
        assert!((at_time.distance_m - distance_m).abs() < 1e-5, "{at_time:?}, {actual:?}");
        for i in 0..=800 {
            let t_s = plan.cycle_time_s() * f64::from(i) / 800.0;
            let sample = arm.self_clearance(&plan.at(t_s).q).unwrap();
            assert!(
                sample.distance_m > distance_m - TOLERANCE_M,
                "{t_s} s: {sample:?}, {actual:?}"
            );
            if distance_m == 0.0 && t_s < actual.at_s - 1e-3 {
                assert!(sample.distance_m > 0.0, "{t_s} s, {actual:?}");
            }
        }
        let sections = plan.sections().iter().filter_map(|it| arm.self_clearance_of_section(it));
        let min_m = sections.map(|it| it.clearance.distance_m).fold(f64::MAX, f64::min);
        assert!((min_m - distance_m).abs() < TOLERANCE_M);
        by_tool += u32::from(actual.clearance.link == 8);
        touching += u32::from(distance_m == 0.0);
    }
    assert!(by_tool > 10 && touching > 1, "{by_tool} {touching}");
}

/// Obstacles do not change the self-clearance, nor do links the clearance.
#[test]
fn obstacles_and_links_do_not_mix() {
    let robot = Robot::default();
    let form = Form::Plane { point_m: [0.0; 3], normal: [0.0, 0.0, 1.0] };
    let table = Scene::new(vec![Obstacle { name: "table".to_owned(), form }]).unwrap();
    let q = [0.0, 0.5, 0.0, -1.8, 0.0, 0.7, 0.0];
    let (bare, placed) =
        (ArmInScene::new(&robot, &Scene::default()), ArmInScene::new(&robot, &table));
    assert_eq!(bare.self_clearance(&q), placed.self_clearance(&q));
    assert_eq!(placed.clearance(&q).unwrap().other, Other::Obstacle(0));
    let other = placed.self_clearance(&q).unwrap().other;
    assert!(placed.name_of(other).starts_with("link "), "{other:?}");
}
