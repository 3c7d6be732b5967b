//! Times at which the motions after waits become known.

use std::collections::BTreeMap;

use iiwa_program::{MotionIndex, OverlappingWait};

use crate::section::Section;

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
