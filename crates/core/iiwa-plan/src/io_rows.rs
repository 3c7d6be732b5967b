//! Inputs and outputs of a section, and their times. An output takes no time, and a wait for an
//! input may end while the robot moves: neither then has a piece of the trajectory, but it has a
//! row of zero length in the figures, at the time at which the output is set or the input is
//! assumed to have its value.

use iiwa_path::Step;
use iiwa_program::{IoEntry, MotionIndex, OverlappingWait};
use iiwa_traj::Section;

/// Returns all inputs and outputs from the end of the section before to the end of `section`, in
/// order. `has_row` reports entries that have a row already.
pub(crate) fn entries(
    section: &Section,
    has_row: impl Fn(MotionIndex) -> bool,
) -> Vec<(MotionIndex, &IoEntry)> {
    let Some(last) = last_entry(section) else { return Vec::new() };
    let first_moved = section.pieces().first().map(|piece| piece.motion);
    let is_of_before =
        |motion: MotionIndex| first_moved.is_some_and(|first| motion < first) && has_row(motion);
    let up_to_last = section.path().io_entries_to(last).rev();
    let mut entries: Vec<_> = up_to_last.take_while(|(motion, _)| !is_of_before(*motion)).collect();
    entries.reverse();
    entries
}

/// Last entry of the program before the next section.
fn last_entry(section: &Section) -> Option<MotionIndex> {
    let last = section.pieces().last();
    let after = &section.path().steps()[last.map_or(0, |piece| piece.step + 1)..];
    let rests = after.iter().take_while(|step| !step.moves());
    rests.map(Step::motion).last().max(last.map(|piece| piece.motion))
}

/// Clock of the waits, inputs and outputs that overlap motions, over all sections.
#[derive(Clone, Debug, Default)]
pub(crate) struct OverlapClock {
    /// Number of waits so far.
    waits: usize,
    /// End of the last wait of more than zero duration, in s.
    over_s: f64,
    /// End of the last wait, in s.
    end_s: f64,
}

/// The clock is the state of a calculation and not a figure: all clocks are equal.
impl PartialEq for OverlapClock {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl OverlapClock {
    /// Advances to an entry that overlaps motions, and returns the time of its end.
    fn advance(
        &mut self,
        waits: &[OverlappingWait],
        motion: MotionIndex,
        start_s: impl Fn(MotionIndex) -> Option<f64>,
    ) -> f64 {
        let next = waits.iter().skip(self.waits).take_while(|wait| wait.motion <= motion);
        for wait in next {
            self.waits += 1;
            let since_s = start_s(wait.since).unwrap_or(self.over_s);
            self.end_s = since_s.max(self.over_s) + wait.seconds;
            // An entry of zero duration delays nothing.
            if wait.seconds > 0.0 {
                self.over_s = self.end_s;
            }
        }
        self.end_s
    }
}

/// Time at which an output is set, or an input is assumed to have its value, in s. The entries of
/// the program are passed in order. `start_s` returns the start of an earlier motion.
pub(crate) fn time_s(
    clock: &mut OverlapClock,
    section: &Section,
    motion: MotionIndex,
    entry: &IoEntry,
    start_s: impl Fn(MotionIndex) -> Option<f64>,
) -> f64 {
    if entry.overlap > 0 {
        return clock.advance(section.path().overlapping_waits(), motion, start_s);
    }
    // The robot is at rest.
    let (path, pieces) = (section.path(), section.pieces());
    let before = pieces.partition_point(|piece| path.steps()[piece.step].motion() < motion);
    before.checked_sub(1).map_or(section.start_s(), |before| pieces[before].end_s)
}
