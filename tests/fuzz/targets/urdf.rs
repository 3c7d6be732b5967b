//! URDFs, checked against the model, and their meshes.

#![no_main]

use iiwa_kin::Robot;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let robot = Robot::lbr_iiwa_7_r800();
    let _ = robot.check_urdf(text, None);
    let _ = robot.urdf_meshes(text);
});
