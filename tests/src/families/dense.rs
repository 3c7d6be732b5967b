//! Points along a smooth curve, as other programs generate them.

use std::f64::consts::TAU;

use iiwa_program::{Blend, Program};

use super::dice::{Dice, program as of, ptp};

/// Returns a program of 50 to 200 points along sines of low order, with equal blends.
pub(super) fn program(dice: &mut Dice) -> Program {
    let points = dice.count(50, 200);
    let blend = Blend::Fraction(if dice.percent(50) { 0.5 } else { 0.3 });
    let shares = if dice.percent(70) { [1.0; 3] } else { [dice.log(0.1, 1.0), 1.0, 1.0] };
    // Three waves per joint: amplitude in rad, periods along the whole curve, phase in rad.
    let size = dice.log(0.1, 1.0);
    let waves: [[[f64; 3]; 3]; 7] = std::array::from_fn(|_| {
        std::array::from_fn(|order| {
            let turns = (order + 1) as f64 * dice.between(0.2, 1.0);
            let amplitude = size * dice.between(-0.9, 0.9) / (order + 1) as f64;
            [amplitude, turns, dice.between(0.0, TAU)]
        })
    });
    let position = |share: f64| {
        waves.map(|waves| {
            let wave = |[a, turns, phase]: [f64; 3]| a * (TAU * turns * share + phase).sin();
            waves.into_iter().map(wave).sum()
        })
    };
    let targets = (1..=points).map(|i| position(i as f64 / points as f64));
    of(position(0.0), targets.map(|target| ptp(target, shares, Some(blend))).collect())
}
