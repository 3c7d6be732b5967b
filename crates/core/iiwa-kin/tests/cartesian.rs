//! Joint positions and their derivatives along Cartesian motions, compared with 40-digit reference
//! values in `fixtures/reference/cartesian.json`.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::f64::consts::PI;

use iiwa_kin::{MovingPose, Number, Pose, Robot, Status, Taylor};
use nalgebra::{Matrix3, Rotation3, Unit, UnitQuaternion, Vector3};
use serde_json::Value;

/// Rotation matrices with derivatives.
type Turning = [[Taylor; 3]; 3];

fn cases() -> Vec<Value> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/reference/cartesian.json");
    let all: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    all["cases"].as_array().unwrap().clone()
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    std::array::from_fn(|i| value[i].as_f64().unwrap())
}

/// Pose of a case; the identity if absent.
fn pose(value: &Value) -> Pose {
    let read = |key: &str| value[key].as_f64().unwrap_or(0.0);
    Pose::from_xyz_abc(
        ["x_mm", "y_mm", "z_mm"].map(|key| 1e-3 * read(key)),
        ["a_deg", "b_deg", "c_deg"].map(|key| read(key).to_radians()),
    )
}

fn robot(case: &Value) -> Robot {
    let [.., flange_m] = numbers::<4>(&case["lengths_m"]);
    Robot::built_in(case["robot"].as_str().unwrap()).unwrap().with_flange_m(flange_m).unwrap()
}

/// Rotation about a fixed axis (Rodrigues).
fn turn(axis: &Unit<Vector3<f64>>, angle: Taylor) -> Turning {
    let across = axis.cross_matrix();
    let square = across * across;
    let (sin, cos) = angle.sin_cos();
    std::array::from_fn(|i| {
        std::array::from_fn(|k| {
            let one = if i == k { 1.0 } else { 0.0 };
            sin * across[(i, k)] + (-cos + 1.0) * square[(i, k)] + one
        })
    })
}

fn product(a: &Turning, b: &Turning) -> Turning {
    std::array::from_fn(|i| {
        std::array::from_fn(|k| a[i][0] * b[0][k] + a[i][1] * b[1][k] + a[i][2] * b[2][k])
    })
}

fn fixed(matrix: &Matrix3<f64>) -> Turning {
    std::array::from_fn(|i| std::array::from_fn(|k| Taylor::constant(matrix[(i, k)])))
}

/// A uniform rotation about a fixed axis, over s.
fn even_turn(from: &Matrix3<f64>, to: &Matrix3<f64>, s: Taylor) -> Turning {
    let difference = Rotation3::from_matrix_unchecked(from.transpose() * to);
    match UnitQuaternion::from_rotation_matrix(&difference).axis_angle() {
        Some((axis, angle)) => product(&fixed(from), &turn(&axis, s * angle)),
        None => fixed(from),
    }
}

/// TCP pose in the base frame at s.
fn tcp(case: &Value, start: &Pose, s: Taylor) -> MovingPose {
    let motion = &case["motion"];
    let end = pose(&motion["frame"]);
    let (from, to) = (start.rotation_matrix(), end.rotation_matrix());
    let (a, b) = (Vector3::from(start.position_m), Vector3::from(end.position_m));
    if motion["type"] == "lin" {
        let rotation = if motion["orientation"] == "constant" {
            fixed(&from)
        } else {
            even_turn(&from, &to, s)
        };
        return MovingPose { position_m: std::array::from_fn(|i| s * (b - a)[i] + a[i]), rotation };
    }

    // Circle through three points; its centre is the intersection of the bisecting planes.
    let via = Vector3::from(pose(&motion["aux"]).position_m);
    let (u, v) = (via - a, b - a);
    let normal = Unit::new_normalize(u.cross(&v));
    let planes = Matrix3::from_rows(&[u.transpose(), v.transpose(), normal.transpose()]);
    let along = Vector3::new(0.5 * u.norm_squared(), 0.5 * v.norm_squared(), 0.0);
    let center = a + planes.lu().solve(&along).unwrap();
    let radius = a - center;
    let (x, y) = (radius.dot(&(b - center)), normal.cross(&radius).dot(&(b - center)));
    let to_the_end = f64::atan2(y, x).rem_euclid(2.0 * PI);
    let whole = motion["circ_angle_deg"].as_f64().map_or(to_the_end, f64::to_radians);
    let on = turn(&normal, s * whole);
    let position_m = std::array::from_fn(|i| {
        (0..3).fold(Taylor::constant(center[i]), |p, k| p + on[i][k] * radius[k])
    });
    let rotation = if motion["orientation_reference"] == "path" {
        let back = Rotation3::from_axis_angle(&normal, -whole);
        product(&on, &even_turn(&from, &(back.matrix() * to), s))
    } else {
        even_turn(&from, &to, s)
    };
    MovingPose { position_m, rotation }
}

/// Flange pose, E1 and status of a point determine its joint positions.
#[test]
fn joints_at_the_points() {
    let mut worst = 0.0_f64;
    for case in cases() {
        let robot = robot(&case);
        let (tool, base) = (pose(&case["tool"]), pose(&case["base"]));
        let status = Status::new(u8::try_from(case["status"].as_u64().unwrap()).unwrap()).unwrap();
        let start = numbers::<7>(&case["start_joints_deg"]).map(f64::to_radians);
        assert_eq!(Status::of(&robot, &start), status);
        let points = case["points"].as_array().unwrap();
        assert_eq!(points.len(), 11);
        for point in points {
            let rotation = std::array::from_fn(|i| numbers(&point["tcp_rotation"][i]));
            let in_base =
                Pose { position_m: numbers(&point["tcp_mm"]).map(|x: f64| 1e-3 * x), rotation };
            let flange = base.then(&in_base).then(&tool.inverse());
            let stated: [f64; 3] = numbers(&point["flange_m"]);
            let apart = Vector3::from(flange.position_m) - Vector3::from(stated);
            assert!(apart.norm() < 1e-12, "{}", case["id"]);
            let expected: [f64; 7] = numbers(&point["q_rad"]);
            let joints = robot.inverse(&flange, expected[2], status).unwrap();
            for j in 0..7 {
                worst = worst.max((joints[j] - expected[j]).abs());
            }
        }
        let last = numbers::<7>(&points[10]["q_rad"]);
        assert_eq!(
            u64::from(robot.redundancy(&last).turn.bits()),
            case["turn_end"].as_u64().unwrap()
        );
    }
    assert!(worst < 1e-11, "off by up to {worst:e} rad");
}

/// The motions are recomputed from start and target alone.
#[test]
fn derivatives_along_the_motions() {
    for case in cases() {
        let robot = robot(&case);
        let (tool, base) = (pose(&case["tool"]), pose(&case["base"]));
        let start = numbers::<7>(&case["start_joints_deg"]).map(f64::to_radians);
        let status = Status::of(&robot, &start);
        let e1 = [
            start[2],
            case["motion"]["frame"]["e1_deg"].as_f64().map_or(start[2], f64::to_radians),
        ];
        let from = base.inverse().then(&robot.flange_pose(&start)).then(&tool);
        for point in case["points"].as_array().unwrap() {
            let s = Taylor::variable(point["s"].as_f64().unwrap());
            let in_base = tcp(&case, &from, s);
            let flange = in_base.carried_by(&base).then_fixed(&tool.inverse());
            let joints =
                robot.inverse_moving(&flange, s * (e1[1] - e1[0]) + e1[0], status).unwrap();
            for (order, key) in ["q_rad", "dq", "ddq", "dddq"].into_iter().enumerate() {
                let expected: [f64; 7] = numbers(&point[key]);
                let largest = expected.iter().fold(1.0_f64, |largest, q| largest.max(q.abs()));
                for j in 0..7 {
                    let error = (joints[j].derivatives()[order] - expected[j]).abs();
                    assert!(
                        error < 1e-8 * largest,
                        "{}: {key} of A{} at s = {} is off by {error:e}",
                        case["id"],
                        j + 1,
                        point["s"]
                    );
                }
            }
        }
    }
}
