//! Waits that overlap motions: the times at which they end, and the rests that remain of them once
//! the robot has stopped. Both follow from the time stamps.

use std::{collections::BTreeMap, ops::Range};

use iiwa_path::{JointPath, Step};
use iiwa_program::{MotionIndex, OverlappingWait};

use crate::section::{PieceKind, Section};

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

/// Clock of a program whose waits overlap its motions.
#[derive(Clone, Debug, Default)]
pub(crate) struct ProgramClock {
    /// Start times of motions, in s.
    begins_s: BTreeMap<MotionIndex, f64>,
    /// End of the last wait so far, in s.
    over_s: f64,
}

impl ProgramClock {
    /// Records the start times of the motions of a section, and replaces those of an earlier plan
    /// of the section.
    pub(crate) fn note(&mut self, section: &Section) {
        let Some(first) = section.pieces().first() else { return };
        let planned_before = self.begins_s.split_off(&first.motion);
        // A motion that is interrupted by a stop started in an earlier section.
        let begun =
            planned_before.get(&first.motion).filter(|begun_s| **begun_s < section.start_s());
        self.begins_s.extend(begun.map(|begun_s| (first.motion, *begun_s)));
        for piece in section.pieces() {
            self.begins_s.entry(piece.motion).or_insert(piece.start_s);
        }
    }

    /// Records the start time of a motion without displacement.
    pub(crate) fn note_still(&mut self, motion: MotionIndex, begins_s: f64) {
        self.begins_s.entry(motion).or_insert(begins_s);
    }

    /// Returns the end of `waits`, which follow all waits so far, in s. Waits of zero duration
    /// delay nothing.
    pub(crate) fn known_s(&self, waits: &[OverlappingWait]) -> f64 {
        waits.iter().filter(|wait| wait.seconds > 0.0).fold(self.over_s, |over_s, wait| {
            let since_s = self.begins_s.get(&wait.since).copied().unwrap_or(over_s);
            since_s.max(over_s) + wait.seconds
        })
    }

    /// Advances to the end of waits at `known_s`.
    pub(crate) fn go_through(&mut self, known_s: f64) {
        self.over_s = known_s;
    }
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
