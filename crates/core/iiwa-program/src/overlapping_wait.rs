//! Waits, inputs and outputs that overlap motions.

use std::collections::VecDeque;

use crate::{
    motion_index::MotionIndex,
    program::{MAX_OVERLAP, Program},
};

/// A wait, also for an input, whose time runs while the robot moves; or an output that is set while
/// the robot moves, as a wait of 0 s.
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
    /// Waits, inputs and outputs that overlap motions, in order, of a checked program.
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
        let mut waits = Vec::new();
        // Preceding motions, as many as an entry may overlap.
        let mut moves = VecDeque::with_capacity(MAX_OVERLAP);
        for (motion, entry) in self.entries() {
            if entry.moves() {
                moves.truncate(MAX_OVERLAP - 1);
                moves.push_front(motion);
            }
            let overlapped = entry.overlap().checked_sub(1).and_then(|last| moves.get(last));
            if let (Some(since), Some(seconds)) = (overlapped, entry.wait_s()) {
                waits.push(OverlappingWait { motion, seconds, since: *since });
            }
        }
        waits
    }
}
