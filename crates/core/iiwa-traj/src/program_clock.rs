//! When the motions after waits are known.

use std::collections::BTreeMap;

use iiwa_program::{MotionIndex, OverlappingWait};

use crate::section::Section;

/// The time of a program whose waits overlap its motions.
#[derive(Clone, Debug, Default)]
pub(crate) struct ProgramClock {
    /// When motions begin, in s.
    begins_s: BTreeMap<MotionIndex, f64>,
    /// When the last wait is over that has been gone through, in s.
    over_s: f64,
}

impl ProgramClock {
    /// Notes when the motions of a section begin, instead of what an earlier plan of it said.
    pub(crate) fn note(&mut self, section: &Section) {
        let Some(first) = section.pieces().first() else { return };
        let planned_before = self.begins_s.split_off(&first.motion);
        // What a stop on its way parts has begun before.
        let begun =
            planned_before.get(&first.motion).filter(|begun_s| **begun_s < section.start_s());
        self.begins_s.extend(begun.map(|begun_s| (first.motion, *begun_s)));
        for piece in section.pieces() {
            self.begins_s.entry(piece.motion).or_insert(piece.start_s);
        }
    }

    /// Notes when a motion begins that goes nowhere.
    pub(crate) fn note_still(&mut self, motion: MotionIndex, begins_s: f64) {
        self.begins_s.entry(motion).or_insert(begins_s);
    }

    /// When these waits, which follow what has been gone through, are over, in s. Waits of no time delay nothing.
    pub(crate) fn known_s(&self, waits: &[OverlappingWait]) -> f64 {
        waits.iter().filter(|wait| wait.seconds > 0.0).fold(self.over_s, |over_s, wait| {
            let since_s = self.begins_s.get(&wait.since).copied().unwrap_or(over_s);
            since_s.max(over_s) + wait.seconds
        })
    }

    /// Goes through waits that are over at this instant.
    pub(crate) fn go_through(&mut self, known_s: f64) {
        self.over_s = known_s;
    }
}
