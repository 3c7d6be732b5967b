//! Sections that are not one PTP motion: their ramps next to rest are as soft as recorded ones.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_kin::{Joints, Robot};
use iiwa_path::JointPath;
use iiwa_program::{Blend, Program};
use iiwa_traj::{JerkOptions, Timing, Trajectory};
use proptest::{prelude::*, test_runner::RngSeed};

use crate::{
    recorded::{POINTS, SHORT, frame, recorded_robot},
    sunrise::pose,
};

fn plan(program: &Program, robot: &Robot, timing: Timing) -> Trajectory {
    let path = JointPath::new(program, robot).unwrap();
    Trajectory::plan(&path, timing).unwrap()
}

/// Timing by the solver for all sections, including those with a closed form.
fn solved() -> Timing {
    Timing::Sunrise(JerkOptions { general: true, ..JerkOptions::default() })
}

/// A blend on a straight line has almost no effect: the motion starts, cruises and stops as the
/// single PTP motion.
#[test]
fn a_blend_within_a_line_changes_little() {
    let ends = [[0.0, 10.0, 0.0, -80.0, 0.0, 60.0, 0.0], [90.0, 50.0, 0.0, -40.0, 0.0, 60.0, 0.0]];
    let middle: Joints = std::array::from_fn(|j| 0.5 * (ends[0][j] + ends[1][j]));
    let robot = Robot::default();
    let seconds = |program: &Program, timing| plan(program, &robot, timing).motion_time_s();
    let whole = Program::from_deg(ends[0]).ptp_deg(ends[1]).build();
    let one = seconds(&whole, Timing::default());
    for share in [0.001, 0.1, 0.5] {
        let two = Program::from_deg(ends[0]).ptp_deg(middle).blend(Blend::Fraction(share));
        let two = two.ptp_deg(ends[1]).build();
        let ratio = seconds(&two, Timing::default()) / one;
        assert!((ratio - 1.0).abs() < 5e-4, "{share}: {ratio}");
        // Compared with jerk limits alone, these ramps add about 6 % of the time.
        assert!(seconds(&two, Timing::jerk_limited()) < 0.96 * one);
    }
}

/// LIN motions along recorded single SPL: at most 4 % off, whereas jerk limits alone are 6 to 22 %
/// too fast.
#[test]
fn lines_of_the_tcp_start_as_single_spl_do() {
    let robot = recorded_robot();
    let long = [0, 1, 2].map(|i| [POINTS[i], POINTS[i + 1]]);
    let lines = std::iter::zip(long.iter().chain(&SHORT), [0.7805, 0.6787, 0.6018, 0.3201, 0.3624]);
    for ([from_deg, to_deg], recorded_s) in lines {
        let frame = frame(&robot, to_deg);
        let text = format!(
            r#"{{ "version": 1, "start": {{ "joints_deg": {from_deg:?} }},
                "motions": [{{ "type": "lin", "frame": {frame} }}] }}"#
        );
        let program = Program::from_json(&text).unwrap();
        let [sunrise, jerk] = [Timing::default(), Timing::jerk_limited()].map(|timing| {
            100.0 * (plan(&program, &robot, timing).motion_time_s() / recorded_s - 1.0)
        });
        println!("{recorded_s} s: {sunrise:+.2} %, by jerk limits {jerk:+.2} %");
        assert!(sunrise.abs() < 4.0, "{recorded_s} s: {sunrise:+.2} %");
        assert!(jerk < -6.0);
    }
}

/// A LIN motion of 30 mm has a top speed of 150 mm/s, below the 225 mm/s of T1: both modes take the
/// same time.
#[test]
fn short_lines_of_the_tcp_are_as_slow_in_t1() {
    let robot = Robot::default();
    let seconds = |mode: &str| {
        let text = format!(
            r#"{{ "version": 1{mode}, "start": {{ "joints_deg": [0, 30, 0, -80, 0, 60, 0] }},
                "motions": [{{ "type": "lin_rel", "offset": {{ "z_mm": 30 }} }}] }}"#
        );
        let program = Program::from_json(&text).unwrap();
        plan(&program, &robot, Timing::default()).motion_time_s()
    };
    let [auto, t1] = ["", r#", "mode": "t1""#].map(seconds);
    assert!(auto > 0.25 && (t1 / auto - 1.0).abs() < 1e-6, "{auto} {t1}");
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 48,
        rng_seed: RngSeed::Fixed(36),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// For PTP motions with plateau and cruise, the solver with one jerk per ramp reproduces the
    /// duration of the closed form.
    #[test]
    fn one_jerk_takes_as_long_as_the_ramp(from in pose(), to in pose()) {
        let program = Program::from_deg(from).ptp_deg(to).build();
        let robot = Robot::default();
        let [closed, actual] =
            [Timing::default(), solved()]
                .map(|timing| plan(&program, &robot, timing).motion_time_s());
        let way = std::iter::zip(from, to).map(|(a, b)| (b - a).powi(2)).sum::<f64>().sqrt();
        prop_assume!(way > 100.0);
        prop_assert!((actual / closed - 1.0).abs() < 2e-3, "{actual} {closed}");
    }

    /// Sections with blends keep the joint limits, and take at least as long as under these limits
    /// alone.
    #[test]
    fn blends_keep_their_limits(
        poses in proptest::collection::vec(pose(), 3..6),
        share in 0.01..0.5_f64,
    ) {
        let mut builder = Program::from_deg(poses[0]);
        for pose in &poses[1..] {
            builder = builder.ptp_deg(*pose).blend(Blend::Fraction(share));
        }
        let program = builder.build();
        let robot = Robot::default();
        let [jerk, sunrise] = [Timing::jerk_limited(), Timing::default()]
            .map(|timing| plan(&program, &robot, timing));
        prop_assert!(sunrise.cycle_time_s() > jerk.cycle_time_s() * (1.0 - 1e-5));
        let limits = robot.limits();
        let steps = 2000;
        for i in 0..=steps {
            let state = sunrise.at(sunrise.cycle_time_s() * f64::from(i) / f64::from(steps));
            for j in 0..7 {
                prop_assert!(state.dq[j].abs() <= 1.005 * limits.velocity_rad_s[j]);
                prop_assert!(state.ddq[j].abs() <= 1.02 * limits.acceleration_rad_s2[j]);
                prop_assert!(
                    state.dddq[j].abs() <= 1.05 * limits.jerk_rad_s3[j],
                    "A{}: {}",
                    j + 1,
                    state.dddq[j] / limits.jerk_rad_s3[j]
                );
            }
        }
    }
}
