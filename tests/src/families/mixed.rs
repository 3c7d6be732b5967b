//! Independent relative limits.

use iiwa_program::{Program, Ptp};

use super::dice::{Dice, program as of};

/// Returns a program with independent relative limits of each joint, each motion and each kind,
/// from 0.01 to 1.
pub(super) fn program(dice: &mut Dice) -> Program {
    let start_rad = dice.pose();
    let mut position = start_rad;
    let motions = (0..dice.count(1, 12)).map(|_| {
        let length = if dice.percent(60) { dice.between(0.3, 3.0) } else { dice.log(1e-3, 1.0) };
        let way = dice.leg(&position, length);
        position = std::array::from_fn(|j| position[j] + way[j]);
        let mut shares = || dice.joints(|dice| dice.log(0.01, 1.0));
        let (velocity_rel, acceleration_rel, jerk_rel) = (shares(), shares(), shares());
        let blend = dice.blend();
        Ptp { velocity_rel, acceleration_rel, jerk_rel, blend, ..Ptp::to(position) }
    });
    let motions = motions.collect();
    of(start_rad, motions)
}
