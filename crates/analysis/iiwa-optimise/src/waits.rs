//! Waits after a motion, during which the arm rests.

use iiwa_program::{Motion, MotionIndex, Program};

use crate::change::{Change, ChangeKind};

/// Returns the waits whose time could run during the motion before them.
pub(crate) fn waits_at_rest(program: &Program) -> Vec<Change> {
    let pairs = program.motions.iter().zip(program.entries().skip(1));
    let change = |(before, (motion, entry)): (&Motion, (MotionIndex, &Motion))| match *entry {
        Motion::Wait { seconds, overlap: 0 } if seconds > 0.0 && before.moves() => {
            let was_blocking = before.is_blocking();
            Some(Change { motion, kind: ChangeKind::OverlapWait { seconds, was_blocking } })
        }
        _ => None,
    };
    pairs.filter_map(change).collect()
}
