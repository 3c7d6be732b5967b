//! Waits at rest. The duration of waits that overlap motions follows from the time stamps.

use std::ops::Range;

use iiwa_path::{JointPath, Step};
use iiwa_program::{MotionIndex, OverlappingWait};

use crate::{
    program_clock::ProgramClock,
    section::{PieceKind, Section},
};

/// Returns the waits that overlap the motion before a blend: those between the two motions that the
/// step at `step` joins. Empty for other steps.
pub(crate) fn waits_before_blend(path: &JointPath, step: usize) -> &[OverlappingWait] {
    let Some(Step::Move { motion: next, blend: Some(corner), .. }) = path.steps().get(step) else {
        return &[];
    };
    let waits = path.overlapping_waits();
    let before = |motion: MotionIndex| waits.partition_point(|wait| wait.motion < motion);
    &waits[before(corner.motion)..before(*next)]
}

/// Rests of a program in which waits overlap motions.
pub(crate) struct Standing<'a> {
    pub(crate) clock: &'a mut ProgramClock,
    /// Duration of a motion without displacement, in s.
    pub(crate) still_s: f64,
}

impl Standing<'_> {
    /// Adds the rests of `steps` to a section that stops before them.
    pub(crate) fn rest(&mut self, section: &mut Section, steps: Range<usize>) {
        let mut end_s = section.end_s();
        for step in steps {
            let seconds = match section.path.steps()[step] {
                Step::Settle { motion, blocking, still } => {
                    self.clock.note_still(motion, end_s);
                    let still_s = if still { self.still_s } else { 0.0 };
                    section.settle(step, still_s);
                    still_s + section.pause_s(blocking)
                }
                Step::Wait { motion, seconds } => {
                    let waits = section.path.overlapping_waits();
                    let wait = waits.partition_point(|wait| wait.motion < motion);
                    let wait = waits.get(wait).filter(|wait| wait.motion == motion).copied();
                    let standing_s = wait.map_or(seconds, |wait| self.overlapped_s(wait, end_s));
                    section.stand(PieceKind::Wait, motion, step, standing_s);
                    standing_s
                }
                _ => 0.0,
            };
            end_s += seconds;
        }
    }

    /// Adds the rest of a section that stops before the blend at `step`, because the motion after
    /// it was not known in time. The robot then continues along the same path.
    pub(crate) fn rest_before_blend(&mut self, section: &mut Section, step: usize) {
        let mut end_s = section.end_s();
        for wait in waits_before_blend(&section.path.clone(), step) {
            let standing_s = self.overlapped_s(*wait, end_s);
            section.stand(PieceKind::Wait, wait.motion, step, standing_s);
            end_s += standing_s;
        }
    }

    /// Returns the remaining duration of a wait after the robot has stopped at `end_s`, in s.
    fn overlapped_s(&mut self, wait: OverlappingWait, end_s: f64) -> f64 {
        let known_s = self.clock.known_s(&[wait]);
        self.clock.go_through(known_s);
        (known_s - end_s).max(0.0)
    }
}
