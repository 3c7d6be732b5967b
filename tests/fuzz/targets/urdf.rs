//! URDFs, checked against the model.

#![no_main]

use iiwa_kin::Robot;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let _ = Robot::lbr_iiwa_7_r800().check_urdf(text, None);
});
