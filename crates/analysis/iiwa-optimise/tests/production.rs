//! Small production programs: how much faster they become, and what stays as it is.

use std::{fs, path::Path};

use iiwa_optimise::{Freedom, Optimum};
use iiwa_program::Program;
use iiwa_scene::{AllowedClearances, ArmInScene, Scene};
use iiwa_traj::Trajectory;

use crate::untouched::{assert_untouched, optimiser};

/// Programs whose search is short. All of them are searched with `IIWASIM_LONG`, which takes
/// minutes.
const SHORT: [&str; 5] =
    ["camera-tour", "insert-a-peg", "over-a-wall", "press-buttons", "scan-a-part"];

/// Smallest distance from obstacles, in m.
const MIN_M: f64 = 0.01;

/// Distances of samples and of the certified search differ by no more, in m.
const TOLERANCE_M: f64 = 1e-4;

/// The changed program as a plan, which takes as long as stated.
fn planned_again(program: &Program, optimum: &Optimum) -> Trajectory {
    let text = optimum.program.to_json();
    let planned = optimiser(program).plan(&Program::from_json(&text).unwrap()).unwrap();
    assert!((planned.cycle_time_s() - optimum.changed_cycle_time_s).abs() < 1e-6);
    planned
}

/// Smallest distance at many instants: from obstacles, and of the arm from itself.
fn nearest_m(arm: &ArmInScene, plan: &Trajectory) -> [f64; 2] {
    let samples = if is_long() { 100_000 } else { 4_000 };
    let rate_hz = f64::from(samples) / plan.cycle_time_s();
    plan.samples(rate_hz).fold([f64::INFINITY; 2], |[scene_m, itself_m], state| {
        let scene = arm.clearance(&state.q).unwrap().distance_m;
        let itself = arm.self_clearance(&state.q).unwrap().distance_m;
        [scene_m.min(scene), itself_m.min(itself)]
    })
}

fn is_long() -> bool {
    std::env::var_os("IIWASIM_LONG").is_some()
}

#[test]
fn production_programs_become_faster() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures/production");
    let mut files: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap()).collect();
    files.retain(|file| {
        let is_short =
            file.path().file_stem().is_some_and(|name| SHORT.iter().any(|it| name == *it));
        file.path().is_file() && (is_short || is_long())
    });
    let mut savings = Vec::new();
    let mut scenes = 0;
    for file in files {
        let text = fs::read_to_string(file.path()).unwrap();
        let program = Program::from_json(&text).unwrap();
        let freedom = Freedom { speeds: false, ..Freedom::MOTIONS };
        let optimiser = optimiser(&program).with_freedom(freedom);
        let scene = fs::read_to_string(folder.join("scenes").join(file.file_name())).ok();
        let optimum = if let Some(scene) = scene {
            scenes += 1;
            let scene = Scene::from_json(&scene).unwrap();
            let arm = ArmInScene::new(optimiser.robot(), &scene);
            let unchanged = optimiser.plan(&program).unwrap();
            let clearances = AllowedClearances::new(&arm, &unchanged, MIN_M).unwrap();
            let rule = |changed: &Trajectory| clearances.allow(changed);
            let optimum = optimiser.optimise_within(&program, &rule).unwrap();
            let before_m = nearest_m(&arm, &unchanged);
            let after_m = nearest_m(&arm, &planned_again(&program, &optimum));
            for (after_m, before_m) in after_m.into_iter().zip(before_m) {
                let least_m = before_m.min(MIN_M) - 2.0 * TOLERANCE_M;
                assert!(after_m > least_m, "{file:?}: {after_m} m, {before_m} m before");
            }
            optimum
        } else {
            let optimum = optimiser.optimise(&program).unwrap();
            planned_again(&program, &optimum);
            optimum
        };
        assert_untouched(&program, &optimum.program);
        let saved = 1.0 - optimum.changed_cycle_time_s / optimum.cycle_time_s;
        println!("{:5.1} %  {}", 100.0 * saved, file.file_name().display());
        assert!(saved >= 0.0, "{file:?}");
        savings.push(saved);
    }
    savings.sort_by(f64::total_cmp);
    let expected = if is_long() { (20, 3) } else { (SHORT.len(), 1) };
    assert_eq!((savings.len(), scenes), expected);
    let half = savings.len() / 2;
    let median = f64::midpoint(savings[half], savings[(savings.len() - 1) / 2]);
    assert!(median >= 0.08, "{median}: {savings:?}");
}
