//! Clearances of poses, compared with points on the surfaces of the arm.

// Test helpers may panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::{PI, TAU};

use iiwa_kin::{Along, Joints, Pose, Robot, Shape, Solid};
use iiwa_scene::{ArmInScene, Form, IgnoredPair, Obstacle, Other, Scene};

type Point = [f64; 3];

fn dot(a: &Point, b: &Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(a: &Point) -> f64 {
    dot(a, a).sqrt()
}

/// Transforms `p` from a frame to the base frame.
pub(crate) fn to_base(pose: &Pose, p: &Point) -> Point {
    std::array::from_fn(|i| pose.position_m[i] + dot(&pose.rotation[i], p))
}

/// Returns the rotation about x, then y, then z, as a product of single rotations.
fn turned([roll, pitch, yaw]: Point, [x, y, z]: Point) -> Point {
    let about = |angle: f64, a: f64, b: f64| {
        (a * angle.cos() - b * angle.sin(), a * angle.sin() + b * angle.cos())
    };
    let (y, z) = about(roll, y, z);
    let (z, x) = about(pitch, z, x);
    let (x, y) = about(yaw, x, y);
    [x, y, z]
}

/// Returns a function of the exact distance of a point from an obstacle, 0 inside.
pub(crate) fn distance(form: &Form) -> Box<dyn Fn(&Point) -> f64> {
    match *form {
        Form::Plane { point_m, normal } => {
            let normal = normal.map(|n| n / length(&normal));
            Box::new(move |p| (dot(p, &normal) - dot(&point_m, &normal)).max(0.0))
        }
        Form::Box { center_m, size_m, rpy_rad } => {
            let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            let axes = axes.map(|axis| turned(rpy_rad, axis));
            Box::new(move |p| {
                let way = std::array::from_fn(|i| p[i] - center_m[i]);
                let excess = |i: usize| (dot(&way, &axes[i]).abs() - 0.5 * size_m[i]).max(0.0);
                length(&std::array::from_fn(excess))
            })
        }
        Form::Sphere { center_m, radius_m } => Box::new(move |p| {
            (length(&std::array::from_fn(|i| p[i] - center_m[i])) - radius_m).max(0.0)
        }),
        Form::Cylinder { center_m, radius_m, length_m, rpy_rad } => {
            let axis = turned(rpy_rad, [0.0, 0.0, 1.0]);
            Box::new(move |p| {
                let way = std::array::from_fn(|i| p[i] - center_m[i]);
                let along = dot(&way, &axis);
                let across = length(&std::array::from_fn(|i| way[i] - along * axis[i]));
                let beyond = (along.abs() - 0.5 * length_m).max(0.0);
                beyond.hypot((across - radius_m).max(0.0))
            })
        }
        _ => unreachable!("there are no others"),
    }
}

/// Returns the points of a surface by two parameters from 0 to 1, in its link frame.
fn surfaces(shape: &Shape) -> Vec<Box<dyn Fn(f64, f64) -> Point>> {
    let center = shape.center_m;
    let moved = move |p: Point| std::array::from_fn(|i| center[i] + p[i]);
    match shape.solid {
        Solid::Sphere { radius_m } => vec![Box::new(move |u, v| {
            let ((su, cu), (sv, cv)) = ((TAU * u).sin_cos(), (PI * v).sin_cos());
            moved([radius_m * sv * cu, radius_m * sv * su, radius_m * cv])
        })],
        Solid::Cylinder { along, radius_m, length_m } => {
            let place = move |u: f64, radius: f64, height: f64| {
                let (sin, cos) = (TAU * u).sin_cos();
                moved(match along {
                    Along::Z => [radius * cos, radius * sin, height],
                    Along::Y => [radius * cos, height, radius * sin],
                })
            };
            vec![
                Box::new(move |u, v| place(u, radius_m, length_m * (v - 0.5))),
                Box::new(move |u, v| place(u, radius_m * v, 0.5 * length_m)),
                Box::new(move |u, v| place(u, radius_m * v, -0.5 * length_m)),
            ]
        }
    }
}

/// Returns the smallest distance of many points of a surface, with increasing density around the
/// nearest ones.
fn nearest(surface: &dyn Fn(f64, f64) -> Point, distance: &dyn Fn(&Point) -> f64) -> f64 {
    let (mut u, mut v, mut half) = (0.5, 0.5, 0.5);
    let mut best = f64::MAX;
    for _ in 0..5 {
        let around = (u, v);
        for i in 0..=24 {
            for j in 0..=12 {
                let at = |center: f64, k: i32, n: i32| {
                    center + half * (2.0 * f64::from(k) / f64::from(n) - 1.0)
                };
                let (a, b) = (at(around.0, i, 24), at(around.1, j, 12).clamp(0.0, 1.0));
                let actual = distance(&surface(a, b));
                if actual < best {
                    (best, u, v) = (actual, a, b);
                }
            }
        }
        half *= 0.2;
    }
    best
}

/// Returns the smallest distance between links 2 to 7 and a scene, except pairs that are nearer
/// than the result and at a constant distance.
fn by_points(robot: &Robot, scene: &Scene, q: &Joints, found_m: f64) -> f64 {
    let shapes = robot.link_shapes();
    let mut best = f64::MAX;
    for obstacle in scene.obstacles() {
        let distance = distance(&obstacle.form);
        let of = |link: usize, shape: &Shape, q: &Joints| {
            let pose = robot.link_poses(q)[link];
            let distance = |p: &Point| distance(&to_base(&pose, p));
            let each = surfaces(shape).into_iter().map(|surface| nearest(&surface, &distance));
            each.fold(f64::MAX, f64::min)
        };
        for (link, shape) in (2..8).flat_map(|link| shapes[link].iter().map(move |it| (link, it))) {
            let distance_m = of(link, shape, q);
            // The shoulder is symmetric about A2: only A1 moves it.
            let is_shoulder =
                link == 2 && matches!(shape.solid, Solid::Cylinder { along: Along::Z, .. });
            let turned = |a1| of(link, shape, &[a1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
            let is_constant = is_shoulder
                && distance_m < found_m - 1e-3
                && (0..24).all(|k| (turned(TAU * f64::from(k) / 24.0) - distance_m).abs() < 1e-3);
            if !is_constant {
                best = best.min(distance_m);
            }
        }
    }
    best
}

#[test]
fn a_thousand_poses_are_as_near_as_their_points() {
    let mut random = fastrand::Rng::with_seed(3);
    let (mut worst_m, mut touching) = (0.0_f64, 0);
    for round in 0..1000 {
        let robot =
            if round % 2 == 0 { Robot::lbr_iiwa_7_r800() } else { Robot::lbr_iiwa_14_r820() };
        let scene = crate::common::solids(&mut random, 3);
        let limits = robot.limits().upper_rad;
        let mut q = limits.map(|limit| limit * (2.0 * random.f64() - 1.0));
        if round % 5 == 0 {
            // Quarter turns, as is common in practice.
            q = q.map(|q| (q / (0.5 * PI)).trunc() * 0.5 * PI);
        }
        let actual = ArmInScene::new(&robot, &scene).clearance(&q).unwrap();
        if actual.distance_m == 0.0 {
            touching += 1;
            assert_eq!(actual.on_link_m, actual.on_other_m);
            let Other::Obstacle(place) = actual.other else { panic!("{actual:?}") };
            let obstacle = distance(&scene.obstacles()[place].form);
            assert!(obstacle(&actual.on_other_m) < 1e-8);
            // A box may be completely inside a link, where the surface has no points.
            continue;
        }
        let points_m = by_points(&robot, &scene, &q, actual.distance_m);
        assert!((actual.distance_m - points_m).abs() < 1e-3, "{q:?}: {points_m} m, {actual:?}");
        worst_m = worst_m.max((actual.distance_m - points_m).abs());
        let way = std::array::from_fn(|i| actual.on_link_m[i] - actual.on_other_m[i]);
        assert!((length(&way) - actual.distance_m).abs() < 1e-9);
        assert!((2..=7).contains(&actual.link));
    }
    println!("worst difference {worst_m} m, {touching} of 1000 touch");
    assert!((50..500).contains(&touching));
}

#[test]
fn known_distances() {
    let robot = Robot::lbr_iiwa_7_r800();
    let clearance = |form| {
        let scene = Scene::new(vec![Obstacle { name: "it".to_owned(), form }]).unwrap();
        ArmInScene::new(&robot, &scene).clearance(&[0.0; 7]).unwrap()
    };
    // With the arm stretched out, the flange face is at 1292 mm; a ceiling at 1500 mm.
    let down = [0.0, 0.0, -7.0];
    let ceiling = clearance(Form::Plane { point_m: [3.0, 4.0, 1.5], normal: down });
    assert!((ceiling.distance_m - 0.208).abs() < 1e-12, "{ceiling:?}");
    assert_eq!((ceiling.link, ceiling.other), (7, Other::Obstacle(0)));
    assert!((ceiling.on_link_m[2] - 1.292).abs() < 1e-12 && ceiling.on_other_m[2] == 1.5);
    // The long edge of a box rotated by 45 degrees, at the height of the wrist: link 5 ends there
    // in a sphere of 64 mm.
    let size_m = [0.2, 2.0, 0.2];
    let rpy_rad = [0.0, 0.25 * PI, 0.0];
    let edge = clearance(Form::Box { center_m: [0.5, 0.0, 1.14], size_m, rpy_rad });
    let expected_m = 0.5 - 0.1 * 2.0_f64.sqrt() - 0.064;
    assert!((edge.distance_m - expected_m).abs() < 1e-9, "{edge:?}");
    assert_eq!(edge.link, 5);
    // A robot base on a table: links 0 and 1 are not checked.
    let up = [0.0, 0.0, 1.0];
    let table = clearance(Form::Plane { point_m: [0.0; 3], normal: up });
    assert!(table.link >= 2 && table.distance_m > 0.2, "{table:?}");
}

#[test]
fn shapes_at_constant_distance_do_not_count() {
    let robot = Robot::lbr_iiwa_7_r800();
    let size_m = [0.14, 0.14, 0.3];
    let column = |z| Form::Box { center_m: [0.0, 0.0, z], size_m, rpy_rad: [0.0; 3] };
    let of = |form, q: &Joints| {
        let scene = Scene::new(vec![Obstacle { name: "it".to_owned(), form }]).unwrap();
        ArmInScene::new(&robot, &scene).clearance(q).unwrap()
    };
    // The shoulder is 266 mm above the column below the robot, at all poses: only parts whose
    // distance varies are checked.
    let apart =
        [[0.0; 7], [0.0, 1.0, 0.0, -1.5, 0.0, 0.5, 0.0], [2.0, -0.5, 0.0, 1.8, 0.0, 0.0, 0.0]]
            .map(|q| of(column(-0.15), &q).distance_m);
    assert!(apart.iter().all(|m| (m - 0.266).abs() > 1e-3), "{apart:?}");
    assert!((apart[0] - apart[1]).abs() > 0.01 && (apart[1] - apart[2]).abs() > 0.01, "{apart:?}");
    // An obstacle that it touches at all poses is checked.
    let touching = of(column(0.2), &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!((touching.distance_m, touching.link), (0.0, 2));
    // A post beside the shoulder is nearer to it at some poses than at others.
    let post = Form::Box { center_m: [0.0, 0.3, 0.34], size_m: [0.1; 3], rpy_rad: [0.0; 3] };
    let [along, across] =
        [0.0, 0.5 * PI].map(|a1| of(post.clone(), &[a1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]));
    assert_eq!((along.link, across.link), (2, 2));
    assert!((along.distance_m - across.distance_m).abs() > 0.01, "{along:?} {across:?}");
}

#[test]
fn ignored_pairs_do_not_count() {
    let robot = Robot::lbr_iiwa_7_r800();
    let ceiling = |z| Form::Plane { point_m: [0.0, 0.0, z], normal: [0.0, 0.0, -1.0] };
    let obstacles = [("low", 1.3), ("high", 1.5)]
        .map(|(name, z)| Obstacle { name: name.to_owned(), form: ceiling(z) });
    let scene = Scene::new(obstacles.to_vec()).unwrap();
    let clearance = |ignored: &[(usize, usize)]| {
        let ignored = ignored.iter().map(|(link, o)| IgnoredPair { link: *link, obstacle: *o });
        let scene = scene.clone().with_ignored(ignored.collect()).unwrap();
        ArmInScene::new(&robot, &scene).clearance(&[0.0; 7])
    };
    assert!((clearance(&[]).unwrap().distance_m - 0.008).abs() < 1e-12);
    let next = clearance(&[(7, 0)]).unwrap();
    assert_eq!((next.link, next.other), (6, Other::Obstacle(0)));
    let all: Vec<_> = (2..=7).map(|link| (link, 0)).collect();
    let high = clearance(&all).unwrap();
    assert_eq!((high.link, high.other), (7, Other::Obstacle(1)));
    assert!((high.distance_m - 0.208).abs() < 1e-12);
    let none: Vec<_> = (2..=7).flat_map(|link| [(link, 0), (link, 1)]).collect();
    assert_eq!(clearance(&none), None);
}

#[test]
fn what_overlaps_touches() {
    let robot = Robot::lbr_iiwa_7_r800();
    let tcp = robot.flange_position(&[0.0; 7]);
    let around = Form::Box { center_m: tcp, size_m: [0.3; 3], rpy_rad: [0.1, 0.2, 0.3] };
    let scene = Scene::new(vec![Obstacle { name: "it".to_owned(), form: around }]).unwrap();
    let touching = ArmInScene::new(&robot, &scene).clearance(&[0.0; 7]).unwrap();
    assert_eq!(touching.distance_m, 0.0);
    assert_eq!(touching.on_link_m, touching.on_other_m);
}
