//! Motions that can end in a blend.

use iiwa_program::{CART_MM_MIN, Motion, MotionIndex, Program};

use crate::change::{Change, ChangeKind};

/// Radii that are tried, in mm, beside the largest one.
const RADII_MM: [f64; 10] = [5.0, 10.0, 15.0, 20.0, 30.0, 40.0, 50.0, 70.0, 100.0, 150.0];

/// Returns the blends that can be tried at the ends of motions, up to a radius: motion by motion,
/// smaller radii first.
pub(crate) fn blends(program: &Program, max_mm: f64) -> Vec<Vec<Change>> {
    let tried = |motion: MotionIndex| {
        let from = program.motions[motion.index()].blend();
        let radii = RADII_MM.into_iter().filter(|radius_mm| *radius_mm < max_mm);
        // A smaller blend is a stop.
        let radii = radii.chain((max_mm >= CART_MM_MIN).then_some(max_mm));
        let kinds = radii.map(|to_mm| ChangeKind::Blend { from, to_mm });
        kinds.map(|kind| Change { motion, kind }).collect()
    };
    ends_in_motion(program).map(tried).collect()
}

/// Returns the motions that the program waits for although the next entry is a motion.
pub(crate) fn awaited(program: &Program) -> Vec<Change> {
    let awaited =
        ends_in_motion(program).filter(|motion| program.motions[motion.index()].is_blocking());
    awaited.map(|motion| Change { motion, kind: ChangeKind::NoWaitForEnd }).collect()
}

/// Motions after which the arm moves on without a wait, an input, an output or another payload.
fn ends_in_motion(program: &Program) -> impl Iterator<Item = MotionIndex> + '_ {
    let loads = program.loads();
    let pairs = program.entries().zip(program.motions.iter().skip(1));
    let moves_on = move |((motion, entry), next): &((MotionIndex, &Motion), &Motion)| {
        let index = motion.index();
        entry.moves() && next.moves() && loads.get(index) == loads.get(index + 1)
    };
    pairs.filter(moves_on).map(|((motion, _), _)| motion)
}
