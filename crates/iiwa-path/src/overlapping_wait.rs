//! Waits during which the arm may move.

use iiwa_program::{Motion, MotionIndex, Program};

/// A wait whose time runs while the arm moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverlappingWait {
    /// The wait's place in the program.
    pub motion: MotionIndex,
    /// How long it takes, in s.
    pub seconds: f64,
    /// The motion before whose begin its time does not begin.
    pub since: MotionIndex,
}

/// Those of a program, which has been checked, in order.
pub(crate) fn overlapping_waits(program: &Program) -> Vec<OverlappingWait> {
    let waits = program.entries().filter_map(|(motion, entry)| {
        let Motion::Wait { seconds, overlap: overlap @ 1.. } = *entry else { return None };
        let before = program.motions[..motion.index()].iter().enumerate().rev();
        let (since, _) = before.filter(|(_, entry)| entry.moves()).nth(overlap - 1)?;
        Some(OverlappingWait { motion, seconds, since: MotionIndex::new(since) })
    });
    waits.collect()
}
