//! Swings with and without a payload show its effect on a controller's planner.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_eval::{
    LoadPlanning, VirtualRobot,
    experiment::{self, LoadEffect, LoadVerdict},
    identify::{RecordedRun, identify},
};
use iiwa_kin::{Load, Robot};

fn effect(planning: LoadPlanning, mass_kg: f64, noise_rad: f64, seed: u64) -> LoadEffect {
    let model = Robot::default();
    let load = Load { mass_kg, center_mm: [0.0, 0.0, 60.0], ..Load::default() };
    let mut robot = VirtualRobot::new(model.clone(), seed);
    (robot.load_planning, robot.noise_rad) = (planning, noise_rad);
    let trials = experiment::load(&load);
    let logs = trials.each_ref().map(|trial| robot.run(&trial.program).unwrap());
    let recordings: Vec<_> = std::iter::zip(&trials, &logs)
        .map(|(trial, log)| RecordedRun { program: &trial.program, log })
        .collect();
    LoadEffect::new(&identify(&recordings, &model).unwrap(), &load, &model).unwrap()
}

#[test]
fn three_planners_are_distinguished() {
    for noise_rad in [0.0, 1e-5, 5e-5] {
        for mass_kg in [5.0, 7.0] {
            let of = |planning| {
                let effect = effect(planning, mass_kg, noise_rad, 11);
                println!(
                    "{planning:?} {mass_kg} kg {noise_rad:e}: {:?} {:?}",
                    effect.verdict, effect.left_over
                );
                for swing in &effect.swings {
                    println!(
                        "  {} {:?} {:.4} {:.3} {:.3}",
                        swing.swing.joint,
                        swing.swing.middle_deg,
                        swing.ratio,
                        swing.needs_rel,
                        swing.share_at(1.0)
                    );
                }
                assert_eq!(effect.swings.len(), 8);
                effect.verdict
            };
            assert_eq!(of(LoadPlanning::Ignored), LoadVerdict::Ignored);
            let LoadVerdict::FactorPerKg(per_kg) = of(LoadPlanning::FactorPerKg(0.02)) else {
                panic!("{mass_kg} kg: the factor was not found")
            };
            assert!((per_kg.value - 0.02).abs() < 0.001, "{per_kg}");
            // At 5 kg, a limit of 80 % is required for a clear effect.
            let limit = if mass_kg < 6.0 { 0.8 } else { 1.0 };
            let LoadVerdict::Torque(share) = of(LoadPlanning::Torque(limit)) else {
                panic!("{mass_kg} kg: planning with torques was not found")
            };
            assert!((share.value - limit).abs() < 0.02, "{share}");
        }
    }
}

/// A payload that requires no planner to slow down shows nothing.
#[test]
fn a_light_load_is_inconclusive() {
    assert_eq!(effect(LoadPlanning::Torque(1.0), 1.0, 1e-5, 3).verdict, LoadVerdict::TooLight);
}
