//! Programs at the bounds of speed and length.

use iiwa_program::Program;

use super::dice::{Dice, program as of, ptp};

/// Returns a program with relative velocities from 1e-6 to 1 and segments of 1e-9 to 5 rad; in half
/// of the programs acceleration and jerk vary, too.
pub(super) fn program(dice: &mut Dice) -> Program {
    let start_rad = dice.joints(|dice| dice.between(-2.0, 2.0));
    // Equal for all motions, so that the path rather than the motions is critical.
    let is_even = dice.percent(50);
    let is_slow = dice.percent(50);
    let share = |dice: &mut Dice| dice.log(1e-6, 1.0);
    let shares = |dice: &mut Dice| {
        let velocity = share(dice);
        let mut rest = || if is_slow { share(dice) } else { 1.0 };
        [velocity, rest(), rest()]
    };
    let same = shares(dice);
    let mut position = start_rad;
    let motions = (0..dice.count(1, 12)).map(|_| {
        let length = dice.log(1e-9, 5.0);
        let way = dice.leg(&position, length);
        position = std::array::from_fn(|j| position[j] + way[j]);
        let shares = if is_even { same } else { shares(dice) };
        let blend = dice.blend();
        ptp(position, shares, blend)
    });
    let motions = motions.collect();
    of(start_rad, motions)
}
