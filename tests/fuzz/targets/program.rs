//! Motion programs, all the way to a trajectory.

#![no_main]

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_traj::{SweepOptions, Timing, Trajectory};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let Ok(program) = Program::from_json(text) else { return };
    let Ok(path) = JointPath::new(&program, &Robot::lbr_iiwa_7_r800()) else { return };
    let acceleration = Timing::Acceleration(SweepOptions::default());
    Trajectory::plan(&path, acceleration).expect("every path can be planned");
    // Shares of a millionth may be too much for the solver, which then says so.
    let _ = Trajectory::plan(&path, Timing::default());
});
