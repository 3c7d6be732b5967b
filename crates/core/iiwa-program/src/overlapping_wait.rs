//! Waits that overlap motions.

use crate::{
    motion_index::MotionIndex,
    program::{Motion, Program},
};

/// A wait whose time runs while the robot moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverlappingWait {
    /// Motion index of the wait.
    pub motion: MotionIndex,
    /// Duration, in s.
    pub seconds: f64,
    /// Motion at whose start the time of the wait starts, at the earliest.
    pub since: MotionIndex,
}

impl Program {
    /// Waits that overlap motions, in order, of a program that has been checked.
    ///
    /// ```
    /// use iiwa_program::{Blend, Motion, MotionIndex, Program};
    ///
    /// let mut program =
    ///     Program::from_deg([0.0; 7]).ptp_deg([30.0; 7]).blend(Blend::Fraction(0.2)).build();
    /// program.motions.push(Motion::Wait { seconds: 0.5, overlap: 1 });
    /// let [wait] = program.overlapping_waits().try_into().expect("there is one");
    /// assert_eq!((wait.motion, wait.since), (MotionIndex::new(1), MotionIndex::new(0)));
    /// ```
    #[must_use]
    pub fn overlapping_waits(&self) -> Vec<OverlappingWait> {
        let waits = self.entries().filter_map(|(motion, entry)| {
            let Motion::Wait { seconds, overlap: overlap @ 1.. } = *entry else { return None };
            let before = self.motions[..motion.index()].iter().enumerate().rev();
            let (since, _) = before.filter(|(_, entry)| entry.moves()).nth(overlap - 1)?;
            Some(OverlappingWait { motion, seconds, since: MotionIndex::new(since) })
        });
        waits.collect()
    }
}
