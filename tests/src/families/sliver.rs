//! Reversals, and lines almost consumed by blends.

use iiwa_program::{Blend, Program};

use super::dice::{Dice, program as of, ptp};

/// Returns a program in which most segments turn by 170 to 180 degrees from the previous one, some
/// by exactly 180; most blends leave 0.2 % of the shorter segment, or nothing. Lengths are very
/// unequal.
pub(super) fn program(dice: &mut Dice) -> Program {
    let start_rad = dice.pose();
    let longest = dice.log(1e-2, 2.0);
    let mut direction = dice.direction();
    let mut position = start_rad;
    let motions = (0..dice.count(2, 10)).map(|leg| {
        if leg > 0 {
            direction = match dice.count(0, 9) {
                0..=2 => direction.map(|v| -v),
                3..=6 => {
                    let angle_rad = dice.between(170.0, 180.0).to_radians();
                    dice.turned(&direction, angle_rad)
                }
                _ => dice.direction(),
            };
        }
        let length = if dice.percent(40) { longest } else { longest * dice.log(1e-3, 1.0) };
        position = std::array::from_fn(|j| position[j] + length * direction[j]);
        let blend = match dice.count(0, 9) {
            0..=5 => Some(Blend::Fraction(dice.between(0.499, 0.5))),
            6 | 7 => Some(Blend::Fraction(0.5)),
            8 => Some(Blend::Fraction(0.5 - dice.log(1e-12, 1e-3))),
            _ => dice.blend(),
        };
        let shares =
            if dice.percent(70) { [1.0; 3] } else { std::array::from_fn(|_| dice.log(0.1, 1.0)) };
        ptp(position, shares, blend)
    });
    let motions = motions.collect();
    of(start_rad, motions)
}
