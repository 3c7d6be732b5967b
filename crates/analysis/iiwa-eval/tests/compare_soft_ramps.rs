//! Starts and ends of motions as planned by Sunrise, whose position begins with the fourth power of
//! time, with noise.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use fastrand::Rng;
use iiwa_eval::{PlannedTrajectory, compare};
use iiwa_traj::{JerkOptions, Timing};

use crate::tape::{Tape, trajectory};

/// Directions of three PTP motions of a real robot, with stops in between.
const PTPS: &str = r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] }, "motions": [
    { "type": "ptp", "joints_deg": [27.04, 8.66, 21.88, -109.22, 0, 32.51, 90] },
    { "type": "ptp", "joints_deg": [99.92, 59.0, -77.68, 39.1, -148.45, 118.74, 35.97] },
    { "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
    { "type": "ptp", "joints_deg": [0, 30, 0, 0, 0, 0, 0] }] }"#;

fn sunrise() -> Timing {
    Timing::Sunrise(JerkOptions::default())
}

fn jerk() -> Timing {
    Timing::Jerk(JerkOptions::default())
}

/// Returns the largest error of a departure, an arrival or the duration of a motion, in s, of some
/// recordings of a robot that executes `sunrise` at an override, compared with a plan.
fn worst_s(planned: Timing, noise_rad: f64, override_share: f64) -> f64 {
    let real = trajectory(PTPS, sunrise());
    let plan = PlannedTrajectory::from_trajectory(&trajectory(PTPS, planned));
    let mut worst: f64 = 0.0;
    for (seed, phase) in (0..6).zip([0.0, 0.13, 0.37, 0.5, 0.71, 0.9]) {
        let section = override_share.recip();
        let (before_s, clock_s) = (0.4, 12.5 * phase);
        let tape =
            Tape { noise_rad, section, phase, clock_s, before_s, after_s: 0.4, ..Tape::default() };
        let log = tape.record(&real, &mut Rng::with_seed(seed));
        let actual = compare(&plan, &log).unwrap();
        worst = worst.max((actual.departure_s - clock_s - before_s).abs());
        let moving_s = real.motions().last().unwrap().end_s;
        worst = worst.max((actual.arrival_s - clock_s - before_s - section * moving_s).abs());
        for (motion, real) in actual.motions.iter().zip(real.motions()) {
            let seconds = section * (real.end_s - real.start_s);
            worst = worst.max((motion.real_s.unwrap() - seconds).abs());
        }
    }
    worst
}

/// The plan is that of the robot, except for the override.
#[test]
fn soft_ramps_are_found_with_their_own_plan() {
    for override_share in [1.0, 0.5, 0.3] {
        for noise_rad in [0.0, 3e-6, 1e-5] {
            let worst_s = worst_s(sunrise(), noise_rad, override_share);
            println!("override {override_share}, noise {noise_rad:.0e}: {worst_s:.1e}");
            assert!(worst_s < 1e-3, "override {override_share}, noise {noise_rad}: {worst_s}");
        }
    }
}

/// The plan has other ramps, with jerk limits.
#[test]
fn soft_ramps_are_found_with_a_plan_of_another_law() {
    for override_share in [1.0, 0.5, 0.3] {
        for noise_rad in [0.0, 3e-6, 1e-5] {
            let worst_s = worst_s(jerk(), noise_rad, override_share);
            println!("jerk, override {override_share}, noise {noise_rad:.0e}: {worst_s:.1e}");
            let max_s = if noise_rad > 5e-6 { 3e-3 } else { 1e-3 };
            assert!(worst_s < max_s, "override {override_share}, noise {noise_rad}: {worst_s}");
        }
    }
}
