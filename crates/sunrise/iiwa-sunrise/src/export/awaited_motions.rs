//! Synchronous and asynchronous motions of the exported program.

use std::{collections::BTreeSet, iter::zip};

use iiwa_program::{Motion, MotionIndex, Program};

use super::error::ExportError;

/// Motions that the exported program waits for, and the places of these waits.
pub(super) struct AwaitedMotions {
    asynchronous: Vec<bool>,
    blends: Vec<bool>,
    /// Motions that are sent when the robot is at rest.
    in_step: BTreeSet<usize>,
}

impl AwaitedMotions {
    /// Determines the waits of a program whose numbers have been checked.
    ///
    /// A Sunrise wait begins when the program reaches it: together with the first motion that was
    /// sent since program and robot were last synchronised. All motions that a wait overlaps are
    /// therefore sent without a wait between them, and the motions before them have ended by then.
    pub(super) fn new(program: &Program) -> Result<Self, ExportError> {
        let motions = &program.motions;
        let blends: Vec<bool> = (0..motions.len()).map(|index| blends(motions, index)).collect();
        let mut asynchronous = blends.clone();
        let mut spans: Vec<WaitSpan> = Vec::new();
        // Indices of the motions so far, and changes of the number of waits that overlap them.
        let mut moves: Vec<usize> = Vec::new();
        let mut overlaps = vec![0_i64; motions.len() + 1];
        for (wait, entry) in program.entries() {
            if entry.moves() {
                moves.push(wait.index());
            }
            let first = moves.len().saturating_sub(entry.overlap());
            if first < moves.len() {
                overlaps[first] += 1;
                overlaps[moves.len()] -= 1;
                let before = first.checked_sub(1).map(|before| moves[before]);
                spans.push(WaitSpan { wait, first: moves[first], before });
            }
        }
        for (index, overlaps) in zip(&moves, sums(&overlaps)) {
            asynchronous[*index] |= overlaps > 0;
        }
        // Number of spans that begin before each entry and contain it.
        let mut changes = vec![0_i64; motions.len() + 1];
        for WaitSpan { wait, first, .. } in &spans {
            changes[first + 1] += 1;
            changes[wait.index()] -= 1;
        }
        let around: Vec<i64> = sums(&changes).collect();
        for WaitSpan { wait, first, before } in &spans {
            if before.is_some_and(|before| blends[before]) || around[*first] > 0 {
                return Err(ExportError::NotInSunrise {
                    motion: *wait,
                    key: "overlap",
                    why: "in Sunrise its time runs from where the first of the motions begins that \
                        are sent in one go; let it overlap all of them",
                });
            }
        }
        let in_step = spans.into_iter().map(|span| span.first).collect();
        Ok(Self { asynchronous, blends, in_step })
    }

    /// Returns true if a motion is sent without waiting for its end.
    pub(super) fn is_asynchronous(&self, index: usize) -> bool {
        self.asynchronous.get(index).is_some_and(|it| *it)
    }

    /// Returns true if a motion is blended into the next one.
    pub(super) fn blends(&self, index: usize) -> bool {
        self.blends.get(index).is_some_and(|it| *it)
    }

    /// Returns true if a motion is sent only when the previous one has ended.
    pub(super) fn is_in_step(&self, index: usize) -> bool {
        self.in_step.contains(&index)
    }
}

/// A wait and the motions that it overlaps.
struct WaitSpan {
    wait: MotionIndex,
    /// First of the overlapped motions.
    first: usize,
    /// Motion before the first one.
    before: Option<usize>,
}

/// Sums of the changes up to and including each of them.
fn sums(changes: &[i64]) -> impl Iterator<Item = i64> {
    changes.iter().scan(0, |sum, change| {
        *sum += change;
        Some(*sum)
    })
}

/// Returns true if a motion has a blend and another motion follows without a stop.
fn blends(motions: &[Motion], index: usize) -> bool {
    let has_blend = match &motions[index] {
        Motion::Ptp(ptp) => ptp.blend.is_some(),
        Motion::Cartesian(cartesian) => cartesian.blend.is_some(),
        Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => false,
    };
    let mut next = motions.iter().skip(index + 1);
    has_blend && next.find(|entry| !entry.is_overlapping_wait()).is_some_and(Motion::moves)
}

/// Duration of a sleep call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SleepCall {
    /// Duration in ms.
    Milliseconds(u64),
    /// Duration in ns, where ms are too coarse.
    Nanoseconds(u64),
}

impl SleepCall {
    /// Returns the call for a wait, and true if its duration differs from the wait's in the last
    /// bits.
    pub(super) fn of(seconds: f64) -> (Self, bool) {
        // Waits take at most a day (8.64e13 ns), below the clamp.
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
