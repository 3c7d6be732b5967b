//! When the statements of the exported program go on.

use std::collections::BTreeSet;

use iiwa_program::{Motion, MotionIndex, Program};

use super::error::ExportError;

/// Which motions the exported program waits for, and where.
pub(super) struct AwaitedMotions {
    asynchronous: Vec<bool>,
    blends: Vec<bool>,
    /// Motions that are sent when the arm stands.
    in_step: BTreeSet<usize>,
}

impl AwaitedMotions {
    /// Of a program whose numbers have been checked.
    ///
    /// A wait of Sunrise begins when the program comes to it: with the first of the motions that were sent since program and
    /// arm were last in step. So all that a wait overlaps is sent in one go, and what is before them has ended by then.
    pub(super) fn new(program: &Program) -> Result<Self, ExportError> {
        let motions = &program.motions;
        let blends: Vec<bool> = (0..motions.len()).map(|index| blends(motions, index)).collect();
        let mut asynchronous = blends.clone();
        let mut spans: Vec<(MotionIndex, usize)> = Vec::new();
        for (wait, entry) in program.entries() {
            let Motion::Wait { overlap: overlap @ 1.., .. } = entry else { continue };
            let before = (0..wait.index()).rev().filter(|index| motions[*index].moves());
            let overlapped: Vec<usize> = before.take(*overlap).collect();
            for index in &overlapped {
                asynchronous[*index] = true;
            }
            spans.extend(overlapped.last().map(|first| (wait, *first)));
        }
        // How many spans are around each entry, and begin before it.
        let mut changes = vec![0_i64; motions.len() + 1];
        for (wait, first) in &spans {
            changes[first + 1] += 1;
            changes[wait.index()] -= 1;
        }
        let around = changes.iter().scan(0, |sum, change| {
            *sum += change;
            Some(*sum)
        });
        let around: Vec<i64> = around.collect();
        for (wait, first) in &spans {
            let before = (0..*first).rev().find(|index| motions[*index].moves());
            if before.is_some_and(|before| blends[before]) || around[*first] > 0 {
                return Err(ExportError::NotInSunrise {
                    motion: *wait,
                    key: "overlap",
                    why: "in Sunrise its time runs from where the first of the motions begins that are sent in one go; \
                          let it overlap all of them",
                });
            }
        }
        let in_step = spans.into_iter().map(|(_, first)| first).collect();
        Ok(Self { asynchronous, blends, in_step })
    }

    /// Whether a motion is sent without waiting for its end.
    pub(super) fn is_asynchronous(&self, index: usize) -> bool {
        self.asynchronous.get(index).is_some_and(|it| *it)
    }

    /// Whether a motion is blended into the next one.
    pub(super) fn blends(&self, index: usize) -> bool {
        self.blends.get(index).is_some_and(|it| *it)
    }

    /// Whether a motion is to be sent when the one before has ended.
    pub(super) fn is_in_step(&self, index: usize) -> bool {
        self.in_step.contains(&index)
    }
}

/// Whether a motion has a blend, and another one follows without a stop.
fn blends(motions: &[Motion], index: usize) -> bool {
    let has_blend = match &motions[index] {
        Motion::Ptp(ptp) => ptp.blend.is_some(),
        Motion::Cartesian(own) => own.blend.is_some(),
        Motion::Wait { .. } | Motion::Load(_) => false,
    };
    let mut next = motions.iter().skip(index + 1);
    has_blend && next.find(|entry| !entry.is_overlapping_wait()).is_some_and(Motion::moves)
}

/// How long a statement sleeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SleepCall {
    /// In ms.
    Milliseconds(u64),
    /// In ns, where ms are too coarse.
    Nanoseconds(u64),
}

impl SleepCall {
    /// That of a wait, and whether it is not the same to the last bit.
    pub(super) fn of(seconds: f64) -> (Self, bool) {
        // At most a day.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked")]
        let whole = |number: f64| number.round().clamp(0.0, 1e15) as u64;
        let ms = whole(1e3 * seconds);
        if ms as f64 / 1e3 == seconds {
            return (Self::Milliseconds(ms), false);
        }
        let ns = whole(1e9 * seconds);
        (Self::Nanoseconds(ns), ns as f64 / 1e9 != seconds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waits_are_whole_numbers() {
        assert_eq!(SleepCall::of(0.0), (SleepCall::Milliseconds(0), false));
        assert_eq!(SleepCall::of(0.7), (SleepCall::Milliseconds(700), false));
        assert_eq!(SleepCall::of(1e-4), (SleepCall::Nanoseconds(100_000), false));
        assert_eq!(SleepCall::of(1.0 / 3.0), (SleepCall::Nanoseconds(333_333_333), true));
        assert_eq!(SleepCall::of(86400.0), (SleepCall::Milliseconds(86_400_000), false));
    }
}
