//! Clearances of a tool.

// Test helpers may panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iiwa_kin::{Joints, Robot};
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_scene::{ArmInScene, ConvexHull, Form, Obstacle, Scene, ToolShape};
use iiwa_traj::{Timing, Trajectory};
use iiwasim_tests::fixture;
use nalgebra::{Rotation3, Vector3};

const TOLERANCE_M: f64 = 1e-4;

fn named(forms: &[Form]) -> Vec<Obstacle> {
    let named =
        |(index, form): (usize, &Form)| Obstacle { name: format!("{index}"), form: form.clone() };
    forms.iter().enumerate().map(named).collect()
}

/// Returns points on a tool shape, in the flange frame.
fn points(form: &ToolShape) -> Vec<Vector3<f64>> {
    let turned = |[roll, pitch, yaw]: [f64; 3]| Rotation3::from_euler_angles(roll, pitch, yaw);
    let steps = |n: u32| (0..=n).map(move |i| 2.0 * f64::from(i) / f64::from(n) - 1.0);
    match form.clone() {
        ToolShape::Box { center_m, size_m, rpy_rad } => {
            let mut points = Vec::new();
            for x in steps(8) {
                for y in steps(8) {
                    for z in steps(8) {
                        let half = Vector3::from(size_m) * 0.5;
                        let local = Vector3::new(x, y, z).component_mul(&half);
                        points.push(Vector3::from(center_m) + turned(rpy_rad) * local);
                    }
                }
            }
            points
        }
        ToolShape::Cylinder { center_m, radius_m, length_m, rpy_rad } => {
            let mut points = Vec::new();
            for i in 0..64 {
                let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 64.0).sin_cos();
                for z in steps(20) {
                    let local = Vector3::new(radius_m * cos, radius_m * sin, 0.5 * length_m * z);
                    points.push(Vector3::from(center_m) + turned(rpy_rad) * local);
                }
            }
            points
        }
        ToolShape::Mesh { hull, origin_m, rpy_rad } => {
            let at = |corner: u32| Vector3::from(hull.corners_m()[corner as usize]);
            let mut points = Vec::new();
            for triangle in hull.triangles() {
                let [a, b, c] = triangle.map(at);
                for i in 0..=10 {
                    for j in 0..=10 - i {
                        let (u, v) = (f64::from(i) / 10.0, f64::from(j) / 10.0);
                        let local = a + (b - a) * u + (c - a) * v;
                        points.push(Vector3::from(origin_m) + turned(rpy_rad) * local);
                    }
                }
            }
            points
        }
        _ => panic!("there is no other here"),
    }
}

/// Returns the distance of a point from an obstacle, in m.
fn distance(obstacle: &Form, point: &Vector3<f64>) -> f64 {
    match *obstacle {
        Form::Plane { point_m, normal } => {
            let normal = Vector3::from(normal).normalize();
            (point - Vector3::from(point_m)).dot(&normal).max(0.0)
        }
        Form::Box { center_m, size_m, rpy_rad: [roll, pitch, yaw] } => {
            let turn = Rotation3::from_euler_angles(roll, pitch, yaw);
            let local = turn.inverse() * (point - Vector3::from(center_m));
            let half = Vector3::from(size_m) * 0.5;
            (local.abs() - half).map(|away| away.max(0.0)).norm()
        }
        _ => panic!("there is no other"),
    }
}

/// The result is at most the distance of the nearest of many points of the tool, and smaller by at
/// most their spacing.
#[test]
fn it_is_as_near_as_its_points() {
    let robot = Robot::lbr_iiwa_14_r820();
    let mut random = fastrand::Rng::with_seed(4);
    let mut tool_counts = 0;
    for round in 0..300 {
        let mut between = |from: f64, to: f64| from + (to - from) * random.f64();
        let mut turn = || [(); 3].map(|()| between(-3.0, 3.0));
        let (rpy_rad, other_rad) = (turn(), turn());
        let center_m = [between(-0.1, 0.1), between(-0.1, 0.1), between(0.1, 0.4)];
        let form = match round % 3 {
            0 => {
                let size_m = [(); 3].map(|()| between(0.02, 0.2));
                ToolShape::Box { center_m, size_m, rpy_rad }
            }
            1 => {
                let [radius_m, length_m] = [between(0.01, 0.05), between(0.05, 0.3)];
                ToolShape::Cylinder { center_m, radius_m, length_m, rpy_rad }
            }
            _ => {
                let point = |_| [(); 3].map(|()| between(-0.1, 0.1));
                let hull = ConvexHull::new((0..5 + round).map(point)).unwrap();
                ToolShape::Mesh { hull, origin_m: center_m, rpy_rad }
            }
        };
        let obstacles = [
            Form::Plane { point_m: [0.0, 0.0, -0.5], normal: [0.1, 0.0, 1.0] },
            Form::Box {
                center_m: [between(-1.2, 1.2), between(-1.2, 1.2), between(0.0, 1.5)],
                size_m: [0.2, 0.3, 0.1],
                rpy_rad: other_rad,
            },
        ];
        let q: Joints = robot.limits().at_shares(&[(); 7].map(|()| between(-0.9, 0.9)));
        let scene = Scene::new(named(&obstacles)).unwrap();
        let bare = ArmInScene::new(&robot, &scene).clearance(&q).unwrap();
        let scene = scene.with_tool(vec![form.clone()]).unwrap();
        let actual = ArmInScene::new(&robot, &scene).clearance(&q).unwrap();
        assert!(actual.distance_m <= bare.distance_m + 1e-9);
        let flange = robot.flange_pose(&q).to_isometry();
        let nearest = points(&form)
            .into_iter()
            .map(|point| flange * nalgebra::Point3::from(point))
            .flat_map(|point| {
                obstacles.each_ref().map(|obstacle| distance(obstacle, &point.coords))
            })
            .fold(f64::MAX, f64::min);
        let min_m = nearest.min(bare.distance_m);
        assert!(actual.distance_m <= min_m + 1e-6, "{round}: {actual:?}, {min_m}");
        assert!(actual.distance_m > min_m - 0.02, "{round}: {actual:?}, {min_m}");
        if actual.link == 8 {
            tool_counts += 1;
        } else {
            assert!((actual.distance_m - bare.distance_m).abs() < 1e-9);
        }
    }
    assert!(tool_counts > 50, "{tool_counts}");
}

/// Over a whole plan, no sample is nearer than the result.
#[test]
fn it_counts_in_plans() {
    let program =
        Program::from_json(&std::fs::read_to_string(fixture("pick-and-place.json")).unwrap())
            .unwrap();
    let robot = Robot::default();
    let path = JointPath::new(&program, &robot).unwrap();
    let trajectory = Trajectory::plan(&path, Timing::default()).unwrap();
    let scene = Scene::from_json(
        r#"{ "version": 1,
             "obstacles": [
                { "name": "table", "type": "plane", "point_mm": [0, 0, 0], "normal": [0, 0, 1] }
             ],
             "tool": [
                { "type": "cylinder", "center_mm": [0, 0, 40], "radius_mm": 30, "length_mm": 80 },
                { "type": "box", "center_mm": [0, 0, 100], "size_mm": [80, 30, 40],
                  "rpy_deg": [0, 0, 30] },
                { "type": "sphere", "center_mm": [0, 30, 120], "radius_mm": 10 }
             ] }"#,
    )
    .unwrap();
    let arm = ArmInScene::new(&robot, &scene);
    let actual = arm.clearance_of(&trajectory).unwrap();
    assert_eq!(actual.clearance.link, 8);
    let mut min_m = f64::MAX;
    for state in trajectory.samples(500.0) {
        min_m = min_m.min(arm.clearance(&state.q).unwrap().distance_m);
    }
    let distance_m = actual.clearance.distance_m;
    assert!(distance_m <= min_m + 1e-9 && distance_m > min_m - TOLERANCE_M, "{actual:?} {min_m}");
    // The tool points down: its sphere reaches 130 mm below the flange.
    let lowest = trajectory
        .samples(500.0)
        .map(|state| robot.flange_position(&state.q)[2])
        .fold(f64::MAX, f64::min);
    assert!((distance_m - (lowest - 0.13)).abs() < 2e-3, "{distance_m} {lowest}");
}

#[test]
fn invalid_tools_are_refused_with_their_place() {
    let refused = |shape: &str| {
        let text = format!("{{\n \"version\": 1,\n \"obstacles\": [],\n \"tool\": [{shape}]\n}}");
        Scene::from_json(&text).unwrap_err().to_string()
    };
    let cases = [
        (
            r#"{ "type": "cone" }"#,
            "unknown type `cone`; `box`, `cylinder`, `sphere` and `mesh` are known",
        ),
        (r#"{ "center_mm": [0, 0, 0] }"#, "it has no `type`"),
        (r#"{ "type": "sphere", "center_mm": [0, 0, 0] }"#, "radius_mm"),
        (
            r#"{ "type": "sphere", "center_mm": [0, 0, 0], "radius_mm": -1 }"#,
            "tool, shape 1: radius_mm is -1",
        ),
        (
            r#"{ "type": "box", "center_mm": [0, 0, 1e9], "size_mm": [1, 1, 1] }"#,
            "tool, shape 1: number 3 of center_mm",
        ),
        (r#"{ "type": "sphere", "center_mm": [0, 0, 0], "radius_mm": 1, "name": "x" }"#, "name"),
    ];
    for (shape, words) in cases {
        let message = refused(shape);
        assert!(message.contains(words) && message.contains("at line 4"), "{shape}: {message}");
    }
    let many = vec![r#"{ "type": "sphere", "center_mm": [0, 0, 0], "radius_mm": 1 }"#; 101];
    assert!(refused(&many.join(",")).contains("the tool has 101 shapes"));
}
