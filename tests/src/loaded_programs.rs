//! Random programs with loads up to the rated payload, for any mounting. A program is determined by
//! a seed and its number, so that it can be reproduced.

use iiwa_kin::{Load, Mount, Robot};
use iiwa_program::{Motion, Program};

use crate::{
    families::{Family, dice::Dice},
    tcp_programs::tcp_program,
};

/// Program with a load on a robot, and its torque limit.
#[derive(Clone, Debug)]
pub struct LoadedProgram {
    /// Robot model.
    pub robot: Robot,
    /// Program, without a torque limit.
    pub program: Program,
    /// Torque limit relative to the robot's.
    pub torque_limit_rel: f64,
}

/// Rated payload of an iiwa 7 and an iiwa 14, in kg.
const MAX_KG: [f64; 2] = [7.0, 14.0];

/// Torque limits relative to the robot's.
const LIMITS: [f64; 4] = [1.0, 1.0, 0.8, 0.6];

/// Returns the program of this number.
#[must_use]
pub fn loaded_program(seed: u64, index: u64) -> LoadedProgram {
    let mut dice = Dice::new(seed, "loaded", index);
    let robots = [Robot::lbr_iiwa_7_r800(), Robot::lbr_iiwa_14_r820()];
    let (robot, mut program) = if dice.percent(30) {
        let drawn = tcp_program(seed, index);
        (drawn.robot, drawn.program)
    } else {
        let family =
            [Family::Plain, Family::Plain, Family::Mixed, Family::Sliver][dice.count(0, 3)];
        (robots[dice.count(0, 1)].clone(), family.program(seed, index).program)
    };
    let is_large = robot.limits().torque_nm == robots[1].limits().torque_nm;
    let mass_kg = dice.between(0.0, MAX_KG[usize::from(is_large)]);
    // A ball of 150 mm.
    let inertia_kg_m2 = [0.4 * mass_kg * 0.15 * 0.15; 3];
    let center_mm =
        [dice.between(-30.0, 30.0), dice.between(-30.0, 30.0), dice.between(0.0, 120.0)];
    let load = Load { mass_kg, center_mm, inertia_kg_m2, ..Load::default() };
    program.motions.insert(0, Motion::Load(Some(load.into())));
    program.workcell.mount = Mount::from_rpy_deg(match dice.count(0, 3) {
        0 => [0.0; 3],
        1 => [180.0, 0.0, 0.0],
        2 => [0.0, 90.0, 0.0],
        _ => [dice.between(-180.0, 180.0), dice.between(-180.0, 180.0), 0.0],
    });
    LoadedProgram { robot, program, torque_limit_rel: LIMITS[dice.count(0, 3)] }
}
