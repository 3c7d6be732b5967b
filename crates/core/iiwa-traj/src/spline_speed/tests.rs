//! The model's limits at every instant.

use iiwa_kin::{Joints, Robot};
use iiwa_path::{JointPath, PLACES, Segment};
use iiwa_program::Program;

use super::{SAMPLES_BEFORE_JERK, model_segments};
use crate::{
    grid::Grid,
    interval::progress,
    timing::{JerkOptions, Timing},
    trajectory::Trajectory,
};

/// Creates a spline from the first pose through the others, in degrees.
fn spline(robot: &Robot, poses_deg: &[Joints]) -> JointPath {
    let segments = poses_deg[1..].iter().map(|pose_deg| {
        let pose = robot.flange_pose(&pose_deg.map(f64::to_radians));
        let [x, y, z] = pose.position_m.map(|m| 1e3 * m);
        let [a, b, c] = pose.abc_rad().map(f64::to_degrees);
        format!(
            r#"{{ "type": "spl", "frame": {{ "x_mm": {x}, "y_mm": {y}, "z_mm": {z},
                "a_deg": {a}, "b_deg": {b}, "c_deg": {c}, "e1_deg": {} }} }}"#,
            pose_deg[2]
        )
    });
    let segments: Vec<String> = segments.collect();
    let text = format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": {:?} }},
            "motions": [{{ "type": "spline", "segments": [{}] }}] }}"#,
        poses_deg[0],
        segments.join(",")
    );
    JointPath::new(&Program::from_json(&text).unwrap(), robot).unwrap()
}

/// Returns the largest shares of the model's limits of speed, acceleration and jerk along a spline.
fn largest_shares(path: &JointPath) -> [f64; 3] {
    let plan = Trajectory::plan(path, Timing::Sunrise(JerkOptions::default())).unwrap();
    let mut largest = [0.0_f64; 3];
    for section in plan.sections() {
        let pieces = section.pieces().iter().filter(|piece| piece.kind.moves()).cloned();
        let pieces: Vec<_> = pieces.collect();
        let grid = Grid::new(SAMPLES_BEFORE_JERK);
        let segments = model_segments(path, &pieces, &grid).unwrap();
        for (piece, segment) in pieces.iter().zip(&segments) {
            let length = segment.sigma_length_rad();
            for pair in section.nodes(piece).windows(2) {
                for i in 0..=PLACES {
                    let dt = pair[0].dt_s * i as f64 / PLACES as f64;
                    let state = progress(dt, &pair[0], &pair[1]);
                    let [v, a, j] = [state.rate, state.u, state.du].map(|rate| rate * length);
                    let s = segment.s_at((pair[0].p + state.dp) * segment.sigma(1.0)[0]);
                    let limits = segment.limits_at(s.clamp(0.0, 1.0));
                    let [y1, y2, y3] = limits.way;
                    let shares = [
                        y1 * v / limits.speed,
                        (y1 * a + y2 * v * v) / limits.acceleration,
                        (y1 * j + 3.0 * y2 * v * a + y3 * v * v * v) / limits.jerk,
                    ];
                    for (largest, share) in largest.iter_mut().zip(shares) {
                        *largest = largest.max(share.abs());
                    }
                }
            }
        }
    }
    largest
}

/// Poses of a smooth spline, of one with a narrow bend and of one that turns back.
#[test]
fn the_models_limits_are_kept() {
    let poses: [Joints; 5] = [
        [10.0, 30.0, 20.0, -60.0, 15.0, 70.0, 0.0],
        [30.0, 40.0, 10.0, -70.0, 25.0, 60.0, 10.0],
        [40.0, 30.0, -10.0, -50.0, 5.0, 80.0, 30.0],
        [41.0, 33.0, -9.0, -54.0, 5.0, 79.0, 28.0],
        [15.0, 45.0, 5.0, -80.0, 20.0, 50.0, 5.0],
    ];
    let robot = Robot::default();
    for order in [&[0, 1][..], &[0, 1, 2], &[0, 1, 2, 3, 4], &[0, 2, 3, 2, 1], &[1, 3, 2, 0]] {
        let poses: Vec<Joints> = order.iter().map(|i| poses[*i]).collect();
        let shares = largest_shares(&spline(&robot, &poses));
        println!("{order:?}: {shares:.4?}");
        let is_kept =
            shares.iter().zip([1.01, 1.002, 1.02]).all(|(share, max_share)| *share <= max_share);
        assert!(is_kept, "{order:?}: {shares:?}");
        assert!(shares.iter().any(|share| *share > 0.99), "{order:?}: {shares:?}");
    }
}
