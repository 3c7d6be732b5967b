//! Scenes, all the way to a clearance.

#![no_main]

use iiwa_kin::Robot;
use iiwa_scene::{ArmInScene, Scene};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let Ok(scene) = Scene::from_json(text) else { return };
    serde_json::to_string(&scene).expect("every scene can be drawn");
    let arm = ArmInScene::new(&Robot::lbr_iiwa_7_r800(), &scene);
    for q in [[0.0; 7], [0.3, 1.2, -0.4, -1.9, 0.8, 1.1, 2.0]] {
        let clearance = arm.clearance(&q);
        assert_eq!(clearance.is_none(), scene.obstacles().is_empty());
        assert!(clearance.is_none_or(|clearance| clearance.distance_m >= 0.0));
    }
});
