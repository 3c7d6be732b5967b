//! Motions too short for the arm to reach its speed.

use iiwa_program::Program;

use super::dice::{Dice, program as of, ptp};

/// Returns a program with segments of 1e-6 to 1e-3 rad.
pub(super) fn program(dice: &mut Dice) -> Program {
    let start_rad = dice.pose();
    let mut direction = dice.direction();
    let mut position = start_rad;
    let motions = (0..dice.count(1, 12)).map(|_| {
        direction = match dice.count(0, 9) {
            0 => direction.map(|v| -v),
            1 => direction,
            2 | 3 => {
                let angle_rad = dice.between(0.0, 10.0).to_radians();
                dice.turned(&direction, angle_rad)
            }
            _ => dice.direction(),
        };
        let length = dice.log(1e-6, 1e-3);
        position = std::array::from_fn(|j| position[j] + length * direction[j]);
        let shares =
            if dice.percent(50) { [1.0; 3] } else { std::array::from_fn(|_| dice.log(0.05, 1.0)) };
        let blend = dice.blend();
        ptp(position, shares, blend)
    });
    let motions = motions.collect();
    of(start_rad, motions)
}
