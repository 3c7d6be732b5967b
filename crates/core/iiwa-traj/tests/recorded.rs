//! Poses of a recorded robot; docs/evidence.md has the source.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_kin::{Joints, Robot};

/// Returns the robot of the recordings, with the plain flange.
pub(crate) fn recorded_robot() -> Robot {
    Robot::default().with_flange_m(0.126).unwrap()
}

/// Returns the flange frame at a pose, in the format of a program.
pub(crate) fn frame(robot: &Robot, pose_deg: &Joints) -> String {
    let pose = robot.flange_pose(&pose_deg.map(f64::to_radians));
    let [x, y, z] = pose.position_m.map(|m| 1e3 * m);
    let [a, b, c] = pose.abc_rad().map(f64::to_degrees);
    let e1 = pose_deg[2];
    format!(
        r#"{{ "x_mm": {x}, "y_mm": {y}, "z_mm": {z},
            "a_deg": {a}, "b_deg": {b}, "c_deg": {c}, "e1_deg": {e1} }}"#
    )
}

/// Taught points, in degrees.
pub(crate) const POINTS: [Joints; 5] = [
    [129.326, 52.411, -79.129, 27.547, -159.391, 102.384, 38.650],
    [84.643, 70.503, -71.651, 83.282, -159.744, 95.381, 19.585],
    [99.924, 59.003, -77.681, 39.105, -148.451, 118.737, 35.970],
    [74.142, 55.857, -59.149, 74.187, -142.174, 100.153, 34.758],
    [93.052, 73.068, -73.452, 86.203, -164.678, 85.958, 16.974],
];

/// Ends of short lines, in degrees.
pub(crate) const SHORT: [[Joints; 2]; 2] = [
    [
        [-31.323, 69.348, -59.619, 106.621, 129.843, 20.917, -98.844],
        [-28.027, 68.088, -60.446, 101.617, 132.003, 22.394, -101.532],
    ],
    [
        [-37.867, 71.826, -58.275, 116.056, 126.224, 18.227, -94.279],
        [-31.323, 69.348, -59.619, 106.621, 129.843, 20.917, -98.844],
    ],
];
