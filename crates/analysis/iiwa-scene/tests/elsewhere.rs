//! Clearances that a program has to keep with the robot at another place.

// Test helpers may panic.
#![allow(clippy::unwrap_used)]

use iiwa_kin::{Pose, Robot};
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_scene::{AllowedClearances, ArmInScene, Clearance, Form, Obstacle, Scene};
use iiwa_traj::{Timing, Trajectory};

/// Smallest clearance, in m.
const MIN_M: f64 = 0.01;

const UP: [f64; 7] = [0.0; 7];

/// Plan in which the arm, stretched out upwards, rotates its flange: all clearances are constant.
fn upright() -> Trajectory {
    let program = Program::from_deg(UP).ptp_deg([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 40.0]).build();
    let path = JointPath::new(&program, &Robot::default()).unwrap();
    Trajectory::plan(&path, Timing::default()).unwrap()
}

fn cuboid(name: &str, center_m: [f64; 3], size_m: [f64; 3]) -> Obstacle {
    let form = Form::Box { center_m, size_m, rpy_rad: [0.0; 3] };
    Obstacle { name: name.to_owned(), form }
}

/// Pose of the former base after a shift of the base.
fn cell(shift_m: [f64; 3]) -> Pose {
    Pose::from_xyz_abc(shift_m, [0.0; 3]).inverse()
}

/// Clearance of the upright arm after a shift of the base.
fn clearance(scene: &Scene, shift_m: [f64; 3]) -> Clearance {
    let moved = scene.with_cell_at(&cell(shift_m), &[]);
    ArmInScene::new(&Robot::default(), &moved).clearance(&UP).unwrap()
}

/// Returns true if the upright arm keeps its clearances after a shift of the base.
fn allows(scene: &Scene, shift_m: [f64; 3], with_robot: &[usize]) -> bool {
    allows_from(MIN_M, scene, shift_m, with_robot)
}

/// As [`allows`], with this smallest clearance.
fn allows_from(min_m: f64, scene: &Scene, shift_m: [f64; 3], with_robot: &[usize]) -> bool {
    let plan = upright();
    let arm = ArmInScene::new(&Robot::default(), scene);
    let clearances = AllowedClearances::new(&arm, &plan, min_m).unwrap();
    clearances.allow_elsewhere(&cell(shift_m), with_robot, &plan)
}

/// Post beside the wrist, whose clearance is `gap_m`, before the arm or behind it.
fn post(name: &str, side: f64, gap_m: f64) -> Obstacle {
    let at = |x_m: f64| cuboid(name, [side * x_m, 0.0, 1.14], [0.1, 0.1, 0.04]);
    let far_m = clearance(&Scene::new(vec![at(0.5)]).unwrap(), [0.0; 3]).distance_m;
    at(0.5 - far_m + gap_m)
}

#[test]
fn a_small_clearance_is_allowed_from_the_same_obstacle_only() {
    let scene = Scene::new(vec![post("front", 1.0, 0.005), post("rear", -1.0, 0.105)]).unwrap();
    assert!((clearance(&scene, [0.0; 3]).distance_m - 0.005).abs() < 1e-6);
    let allows = |x_m, y_m, with_robot: &[usize]| allows(&scene, [x_m, y_m, 0.0], with_robot);
    // As near as in the unchanged program, or less near.
    assert!(allows(0.0, 0.0, &[]));
    assert!(allows(0.0, 0.02, &[]));
    assert!(allows(-0.003, 0.0, &[]));
    assert!(allows(-0.05, 0.0, &[]));
    // Nearer to the same post, by more than the accuracy of clearances.
    assert!(!allows(0.0003, 0.0, &[]));
    // As near to the other post, from which the unchanged program is 105 mm away.
    assert!((clearance(&scene, [-0.1, 0.0, 0.0]).distance_m - 0.005).abs() < 1e-6);
    assert!(!allows(-0.1, 0.0, &[]));
    assert!(allows(-0.094, 0.0, &[]));
    // Posts that move with the robot base.
    assert!(allows(-0.1, 0.0, &[1]));
    assert!(allows(0.0003, 0.0, &[0]));
    assert!(!allows(0.103, 0.0, &[1]));
}

/// Clearances are accurate to 0.1 mm, which does not allow contacts.
#[test]
fn no_contact_is_allowed() {
    let near = Scene::new(vec![post("front", 1.0, 5e-5)]).unwrap();
    let far = Scene::new(vec![post("front", 1.0, 0.005)]).unwrap();
    for min_m in [0.0, MIN_M] {
        assert!(allows_from(min_m, &near, [0.0; 3], &[]));
        assert!(allows_from(min_m, &near, [-0.003, 0.0, 0.0], &[]));
        assert!(!allows_from(min_m, &near, [0.002, 0.0, 0.0], &[]));
        assert!(!allows_from(min_m, &far, [0.006, 0.0, 0.0], &[]));
    }
    assert!(allows_from(0.0, &far, [0.004, 0.0, 0.0], &[]));
    // The foot, in an obstacle that it does not touch before.
    let step = cuboid("step", [0.5, 0.0, 0.03], [0.4, 0.4, 0.06]);
    assert!(!allows_from(0.0, &Scene::new(vec![step]).unwrap(), [0.4, 0.0, 0.0], &[]));
}

#[test]
fn a_small_clearance_is_allowed_for_the_same_part_only() {
    let scene = Scene::new(vec![post("post", 1.0, 0.005)]).unwrap();
    let here = clearance(&scene, [0.0; 3]);
    // The robot is raised, so that the post is beside its elbow, and moved to the same distance.
    let raised_m = |gap_m: f64| {
        let far_m = clearance(&scene, [-0.2, 0.0, 0.4]).distance_m;
        [far_m - gap_m - 0.2, 0.0, 0.4]
    };
    let there = clearance(&scene, raised_m(0.005));
    assert!((there.distance_m - here.distance_m).abs() < 1e-6, "{here:?}, {there:?}");
    assert_ne!(there.link, here.link);
    assert!(!allows(&scene, raised_m(0.005), &[]));
    assert!(allows(&scene, raised_m(0.015), &[]));
}

/// Links 0 and 1 do not count in other clearances.
#[test]
fn the_robot_base_keeps_clear_of_obstacles() {
    // The foot has a radius of 115 mm. It is on a pedestal, which is large enough for all places.
    let step = cuboid("step", [0.5, 0.0, 0.03], [0.4, 0.4, 0.06]);
    let pedestal = cuboid("pedestal", [0.0, 0.0, -0.1], [1.0, 1.0, 0.2]);
    let scene = Scene::new(vec![step, pedestal]).unwrap();
    let allows = |x_m, with_robot: &[usize]| allows(&scene, [x_m, 0.0, 0.0], with_robot);
    assert!(allows(0.17, &[]));
    assert!(allows(-0.3, &[]));
    assert!(!allows(0.18, &[]));
    assert!(!allows(0.4, &[]));
    assert!(clearance(&scene, [0.4, 0.0, 0.0]).distance_m > MIN_M);
    assert!(allows(0.4, &[0]));
}
