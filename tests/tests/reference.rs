//! Reference programs, cross-validated against the results of an independent solver.

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_traj::{JerkOptions, SweepOptions, Timing, Trajectory};
use iiwasim_tests::reference::{Case, cases};

fn path(case: &Case) -> JointPath {
    JointPath::new(&case.program, &Robot::lbr_iiwa_7_r800()).unwrap()
}

fn close<const N: usize>(actual: [f64; N], expected: [f64; N], label: &str) {
    for (actual, expected) in actual.iter().zip(expected) {
        assert!((actual - expected).abs() < 1e-6, "{label}: {actual}, expected {expected}");
    }
}

#[test]
fn blends() {
    for case in cases() {
        let path = path(&case);
        let robot = path.robot();
        assert_eq!(path.blends().count(), case.answers.blends.len(), "program {}", case.id);
        for ((corner, blend), answer) in path.blends().zip(&case.answers.blends) {
            let label = format!("program {}, blend after motion {}", case.id, corner.motion);
            close([corner.gamma_deg], [answer.gamma_deg], &label);
            close(blend.at(0.0).q, answer.start_rad, &label);
            close(blend.at(0.5).q, answer.mid_rad, &label);
            close(blend.at(1.0).q, answer.end_rad, &label);
            close(robot.flange_position(&blend.at(0.5).q), answer.mid_tcp_m, &label);
        }
    }
}

fn largest_time_error(samples: usize) -> f64 {
    let timing = Timing::Acceleration(SweepOptions { samples });
    let mut largest = 0.0_f64;
    for case in cases() {
        let trajectory = Trajectory::plan(&path(&case), timing).unwrap();
        let expected = case.answers.motion_s.acceleration;
        let error = trajectory.motion_time_s() / expected - 1.0;
        println!("program {:2}, N = {samples}: {:+.5} %", case.id, 100.0 * error);
        largest = largest.max(error.abs());
        let settle = case.answers.settle_s;
        assert!((trajectory.totals().settle_time_s - settle).abs() < 1e-9, "program {}", case.id);
        let stops = settle / Robot::default().settle_time_s();
        assert!((stops - stops.round()).abs() < 1e-9);
        let cycle = trajectory.motion_time_s() + settle;
        assert!((trajectory.cycle_time_s() - cycle).abs() < 1e-9);
    }
    largest
}

#[test]
fn cycle_times_at_the_default_samples() {
    assert!(largest_time_error(SweepOptions::default().samples) < 1e-3);
}

#[test]
fn cycle_times_with_many_samples() {
    assert!(largest_time_error(1600) < 3e-4);
}

/// Returns the motion times of all programs with jerk limits, in s.
fn jerk_limited_s(refinement: f64) -> Vec<f64> {
    let timing = Timing::Jerk(JerkOptions { refinement, ..JerkOptions::default() });
    let plan = |case: &Case| Trajectory::plan(&path(case), timing).unwrap();
    cases()
        .iter()
        .map(|case| {
            let trajectory = plan(case);
            let settle = case.answers.settle_s;
            assert!((trajectory.totals().settle_time_s - settle).abs() < 1e-9, "{}", case.id);
            trajectory.motion_time_s()
        })
        .collect()
}

#[test]
fn cycle_times_under_limits_of_jerk() {
    for (case, reference) in cases().iter().zip(jerk_limited_s(1.0)) {
        let error = reference / case.answers.motion_s.jerk - 1.0;
        println!("program {:2}: {:+.5} %", case.id, 100.0 * error);
        // Straight lines have a closed form. Otherwise the reference is accurate to 0.1 %, from
        // below.
        let straight = case.answers.blends.is_empty();
        let (lower, upper) = if straight { (-1e-4, 1e-4) } else { (-5e-4, 3e-3) };
        assert!(lower <= error && error <= upper, "program {}: {error:e}", case.id);
    }
}

#[test]
fn finer_cells_change_little() {
    for (id, (usual, fine)) in jerk_limited_s(1.0).iter().zip(jerk_limited_s(4.0)).enumerate() {
        let change = fine / usual - 1.0;
        println!("program {id:2}: {:+.5} %", 100.0 * change);
        assert!(change.abs() < 1e-3, "program {id}: {change:e}");
    }
}
