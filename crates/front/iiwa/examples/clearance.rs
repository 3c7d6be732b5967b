//! Computes the clearance between arm and obstacles of a scene, at rest and in motion.

use std::error::Error;
use std::io::{Write, stdout};

use iiwa::prelude::*;

const SCENE: &str = r#"{
    "version": 1,
    "obstacles": [
        { "name": "floor", "type": "plane", "point_mm": [0, 0, -700], "normal": [0, 0, 1] },
        { "name": "box", "type": "box", "center_mm": [650, 0, 200], "size_mm": [200, 200, 400] }
    ]
}"#;

fn main() -> Result<(), Box<dyn Error>> {
    let robot = Robot::lbr_iiwa_7_r800();
    let scene = Scene::from_json(SCENE)?;
    let arm = ArmInScene::new(&robot, &scene);

    // Clearance of one pose: exact to 0.1 um.
    let mut out = stdout();
    if let Some(clearance) = arm.clearance(&[0.0; 7]) {
        writeln!(out, "stretched out upwards: {:.1} mm", 1e3 * clearance.distance_m)?;
    }

    // Clearance of a motion past the box: covers the whole path continuously, to 0.1 mm.
    let program = Program {
        robot: None,
        start: Start::Joints([-0.8, 0.6, 0.0, -1.2, 0.0, 1.0, 0.0]),
        motions: vec![Motion::Ptp(Ptp::to([0.8, 0.6, 0.0, -1.2, 0.0, 1.0, 0.0]))],
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let trajectory = Trajectory::plan(&JointPath::new(&program, &robot)?, Timing::default())?;
    if let Some(nearest) = arm.clearance_of(&trajectory) {
        let obstacle = arm.name_of(nearest.clearance.other);
        writeln!(
            out,
            "in motion: {:.1} mm, link {} to {obstacle} at {:.3} s",
            1e3 * nearest.clearance.distance_m,
            nearest.clearance.link,
            nearest.at_s,
        )?;
    }
    Ok(())
}
