//! Scenes around a robot at another place in its cell.

// Test helpers may panic.
#![allow(clippy::unwrap_used)]

use std::{
    f64::consts::{FRAC_PI_2, PI},
    iter::zip,
};

use iiwa_kin::{Pose, Robot};
use iiwa_scene::{ArmInScene, Form, IgnoredPair, Obstacle, Scene, ToolShape};

use crate::{
    common,
    pose::{distance, to_base},
};

fn between(random: &mut fastrand::Rng, from: f64, to: f64) -> f64 {
    from + (to - from) * random.f64()
}

fn three(random: &mut fastrand::Rng, from: f64, to: f64) -> [f64; 3] {
    std::array::from_fn(|_| between(random, from, to))
}

/// Checks that each point of the cell has the same distance from the obstacles of a scene as the
/// same point in the new base has from those of the moved scene.
fn check_points(random: &mut fastrand::Rng, scene: &Scene, cell: &Pose) {
    let moved = scene.with_cell_at(cell, &[]);
    assert_eq!(scene.obstacles().len(), moved.obstacles().len());
    for (before, after) in zip(scene.obstacles(), moved.obstacles()) {
        assert_eq!(before.name, after.name);
        let [before_m, after_m] = [before, after].map(|obstacle| distance(&obstacle.form));
        for _ in 0..40 {
            let point = three(random, -1.5, 1.5);
            let difference_m = before_m(&point) - after_m(&to_base(cell, &point));
            assert!(difference_m.abs() < 1e-12, "{difference_m} m: {before:?}, {after:?}");
        }
    }
}

#[test]
fn obstacles_keep_their_places_in_the_cell() {
    let mut random = fastrand::Rng::with_seed(11);
    for round in 0..300 {
        let scene = common::solids(&mut random, 4);
        let mut abc_rad = three(&mut random, -PI, PI);
        if round % 2 == 0 {
            abc_rad = [abc_rad[0], 0.0, 0.0];
        }
        let cell = Pose::from_xyz_abc(three(&mut random, -1.0, 1.0), abc_rad);
        check_points(&mut random, &scene, &cell);
    }
}

/// With a pitch of a quarter turn, roll and yaw are about the same axis.
#[test]
fn lying_obstacles_keep_their_places_in_the_cell() {
    let mut random = fastrand::Rng::with_seed(12);
    for pitch in [FRAC_PI_2, -FRAC_PI_2] {
        for [roll, yaw] in [[0.0, 0.0], [0.3, -0.7], [FRAC_PI_2, PI]] {
            let (center_m, rpy_rad) = ([0.3, -0.2, 0.5], [roll, pitch, yaw]);
            let forms = [
                Form::Box { center_m, size_m: [0.1, 0.3, 0.7], rpy_rad },
                Form::Cylinder { center_m, radius_m: 0.1, length_m: 0.8, rpy_rad },
            ];
            let obstacle = |(index, form)| Obstacle { name: format!("obstacle {index}"), form };
            let scene = Scene::new(forms.into_iter().enumerate().map(obstacle).collect()).unwrap();
            for yaw_rad in [0.0, 0.4, FRAC_PI_2] {
                let cell = Pose::from_xyz_abc([0.1, 0.2, -0.1], [yaw_rad, 0.0, 0.0]);
                check_points(&mut random, &scene, &cell);
            }
        }
    }
}

/// A rotation of the base about its z axis is a rotation of joint 1.
#[test]
fn a_rotated_base_has_the_clearance_of_another_a1() {
    let robot = Robot::lbr_iiwa_7_r800();
    let mut random = fastrand::Rng::with_seed(13);
    for _ in 0..300 {
        let scene = common::scene(&mut random, 4);
        let yaw_rad = between(&mut random, -3.0, 3.0);
        let cell = Pose::from_xyz_abc([0.0; 3], [yaw_rad, 0.0, 0.0]).inverse();
        let limits = robot.limits().upper_rad;
        let there = limits.map(|limit| limit * between(&mut random, -1.0, 1.0));
        let mut here = there;
        here[0] += yaw_rad;
        let here_m = ArmInScene::new(&robot, &scene).clearance(&here).unwrap().distance_m;
        let moved = scene.with_cell_at(&cell, &[]);
        let there_m = ArmInScene::new(&robot, &moved).clearance(&there).unwrap().distance_m;
        assert!((here_m - there_m).abs() < 1e-6, "{here_m} m, {there_m} m: {scene:?}");
        let back = moved.with_cell_at(&cell.inverse(), &[]);
        let back_m = ArmInScene::new(&robot, &back).clearance(&here).unwrap().distance_m;
        assert!((here_m - back_m).abs() < 1e-6, "{here_m} m, {back_m} m: {scene:?}");
    }
}

/// Scene with a floor, a table and a lamp.
fn cell() -> Scene {
    let forms = [
        ("floor", Form::Plane { point_m: [0.0; 3], normal: [0.0, 0.0, 1.0] }),
        (
            "table",
            Form::Box { center_m: [0.5, 0.0, 0.1], size_m: [0.2; 3], rpy_rad: [0.1, 0.2, 0.3] },
        ),
        ("lamp", Form::Sphere { center_m: [0.0, 0.5, 1.0], radius_m: 0.1 }),
    ];
    let obstacle = |(name, form): (&str, Form)| Obstacle { name: name.to_owned(), form };
    let tool = ToolShape::Sphere { center_m: [0.0, 0.0, 0.1], radius_m: 0.05 };
    let scene = Scene::new(forms.map(obstacle).to_vec()).unwrap().with_tool(vec![tool]).unwrap();
    scene.with_ignored(vec![IgnoredPair { link: 3, obstacle: 1 }]).unwrap()
}

#[test]
fn named_obstacles_move_with_the_robot() {
    let scene = cell();
    let with_robot = scene.indices_of(&["lamp", "floor"]).unwrap();
    assert_eq!(with_robot, [2, 0]);
    let cell = Pose::from_xyz_abc([0.1, 0.2, 0.3], [0.4, 0.0, 0.0]);
    let moved = scene.with_cell_at(&cell, &with_robot);
    let is_same: Vec<_> =
        zip(scene.obstacles(), moved.obstacles()).map(|(before, after)| before == after).collect();
    assert_eq!(is_same, [true, false, true]);
    assert_eq!((moved.tool(), moved.ignored()), (scene.tool(), scene.ignored()));
    let all = scene.with_cell_at(&cell, &[0, 1, 2]);
    assert_eq!(all, scene);
}

#[test]
fn unknown_names_are_errors() {
    let error = cell().indices_of(&["floor", "desk"]).unwrap_err();
    assert_eq!(error.name(), "desk");
    let message = "unknown obstacle `desk`; `floor`, `table` and `lamp` are known";
    assert_eq!(error.to_string(), message);
    let empty = Scene::default().indices_of(&["table"]).unwrap_err();
    assert_eq!(empty.to_string(), "unknown obstacle `table`; none are known");
    // A long list would hide the message.
    let lamp = |index| Obstacle {
        name: format!("the lamp {index}"),
        form: Form::Sphere { center_m: [0.0; 3], radius_m: 0.1 },
    };
    let lamps = Scene::new((10..40).map(lamp).collect()).unwrap();
    let message = |name: &str| lamps.indices_of(&[name]).unwrap_err().to_string();
    assert_eq!(message("table"), "unknown obstacle `table`; the scene has 30 others");
    assert_eq!(
        message("the lmap 12"),
        "unknown obstacle `the lmap 12`; did you mean `the lamp 12`?"
    );
}
