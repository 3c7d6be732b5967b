//! Robot profiles: one that is read is written as one that reads back.

#![no_main]

use iiwa_kin::Robot;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let Ok(robot) = Robot::from_profile(text) else { return };
    assert_eq!(Robot::from_profile(&robot.to_profile()).expect("it was written"), robot);
});
