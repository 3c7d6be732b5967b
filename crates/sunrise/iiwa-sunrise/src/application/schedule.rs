//! Motions and waits that an application commands, in order.

use iiwa_java::SourceLine;
use iiwa_kin::Load;
use iiwa_program::{IoEntry, Motion};

/// Motions and waits of an application so far.
#[derive(Debug, Default)]
pub(crate) struct Schedule {
    entries: Vec<ScheduleEntry>,
    /// Number of motions sent since the program last waited for standstill.
    under_way: usize,
    /// Number of motions sent in total.
    sent: usize,
    /// Hold that the program has started, and has neither awaited nor ended.
    hold: Option<Hold>,
}

/// Hold in progress: its wait, and the time that the program has slept since its start.
#[derive(Debug)]
struct Hold {
    entry: usize,
    slept_s: f64,
    /// `true` if the duration was given as an answer: the program does not end the hold early.
    is_fixed: bool,
}

#[derive(Debug)]
struct ScheduleEntry {
    motion: Motion,
    place: SourceLine,
    /// `true` if the program waits for standstill at its end.
    is_awaited: bool,
}

impl Schedule {
    /// Adds a motion that the program does not wait for.
    pub(crate) fn send(&mut self, motion: Motion, place: SourceLine) {
        // The motion begins at the end of a hold.
        self.hold = None;
        self.entries.push(ScheduleEntry { motion, place, is_awaited: false });
        self.under_way += 1;
        self.sent += 1;
    }

    /// Returns the number of motions sent so far.
    pub(crate) fn sent(&self) -> usize {
        self.sent
    }

    /// Returns the number of motions sent since the program last waited for standstill.
    pub(crate) fn under_way(&self) -> usize {
        self.under_way
    }

    /// Returns true if the robot may still be moving.
    pub(crate) fn is_under_way(&self) -> bool {
        self.under_way > 0
    }

    /// Waits until the robot is at rest.
    pub(crate) fn await_all(&mut self) {
        self.hold = None;
        // Motions that were awaited before are not searched again.
        if std::mem::take(&mut self.under_way) == 0 {
            return;
        }
        if let Some(last) = self.entries.iter_mut().rev().find(|entry| moves(&entry.motion)) {
            last.is_awaited = true;
        }
    }

    /// Holds the robot's position for a number of seconds while the program continues.
    pub(crate) fn hold(&mut self, seconds: f64, is_fixed: bool, place: SourceLine) {
        self.hold = Some(Hold { entry: self.entries.len(), slept_s: 0.0, is_fixed });
        self.sent += 1;
        let motion = Motion::Wait { seconds, overlap: 0 };
        self.entries.push(ScheduleEntry { motion, place, is_awaited: true });
    }

    /// Returns true if the program has started a hold, and has neither awaited nor ended it.
    pub(crate) fn is_holding(&self) -> bool {
        self.hold.is_some()
    }

    /// Ends the hold in progress; its duration is the time that the program has slept since its
    /// start.
    pub(crate) fn end_hold(&mut self) {
        let Some(Hold { entry, slept_s, is_fixed: false }) = self.hold.take() else { return };
        if let Some(ScheduleEntry { motion: Motion::Wait { seconds, .. }, .. }) =
            self.entries.get_mut(entry)
        {
            *seconds = slept_s;
        }
    }

    /// Returns the part of a sleep that exceeds the hold in progress; all of it without a hold.
    fn beyond_hold(&mut self, seconds: f64) -> f64 {
        let Some(Hold { entry, slept_s, .. }) = &mut self.hold else { return seconds };
        let Some(ScheduleEntry { motion: Motion::Wait { seconds: held, .. }, .. }) =
            self.entries.get(*entry)
        else {
            return seconds;
        };
        let left = (*held - *slept_s).max(0.0);
        *slept_s += seconds.min(left);
        if seconds > left {
            self.hold = None;
        }
        seconds - seconds.min(left)
    }

    /// Adds a wait of a number of seconds during which the robot continues its motions.
    pub(crate) fn wait(&mut self, seconds: f64, place: SourceLine) {
        let seconds = match self.beyond_hold(seconds) {
            0.0 if seconds > 0.0 => return,
            beyond => beyond,
        };
        let motion = Motion::Wait { seconds, overlap: self.under_way };
        self.entries.push(ScheduleEntry { motion, place, is_awaited: true });
    }

    /// Adds a change of the payload. Of consecutive changes, the last one is kept.
    pub(crate) fn load(&mut self, load: Option<Load>, place: SourceLine) {
        // A hold in progress continues after the load change.
        let rest = self.rest_of_hold();
        self.await_all();
        if let Some(ScheduleEntry { motion: Motion::Load(_), .. }) = self.entries.last() {
            self.entries.pop();
        }
        let motion = Motion::Load(load.map(Into::into));
        self.entries.push(ScheduleEntry { motion, place, is_awaited: true });
        if let Some((seconds, is_fixed, place)) = rest {
            self.hold = Some(Hold { entry: self.entries.len(), slept_s: 0.0, is_fixed });
            let motion = Motion::Wait { seconds, overlap: 0 };
            self.entries.push(ScheduleEntry { motion, place, is_awaited: true });
        }
    }

    /// Adds an input or output, while the robot continues its motions.
    pub(crate) fn io(&mut self, entry: IoEntry, place: SourceLine) {
        // A hold in progress continues after an output. A wait for an input is part of the hold.
        let waits_s = entry.seconds();
        let rest = if self.hold.is_some() { self.rest_of_hold() } else { None };
        let overlap = self.under_way;
        let motion = Motion::Io(IoEntry { overlap, ..entry });
        self.entries.push(ScheduleEntry { motion, place, is_awaited: true });
        if let Some((seconds, is_fixed, place)) = rest
            && seconds > waits_s
        {
            self.hold = Some(Hold { entry: self.entries.len(), slept_s: 0.0, is_fixed });
            let motion = Motion::Wait { seconds: seconds - waits_s, overlap: 0 };
            self.entries.push(ScheduleEntry { motion, place, is_awaited: true });
        }
    }

    /// Ends the hold in progress at the current time, and returns its remaining time.
    fn rest_of_hold(&mut self) -> Option<(f64, bool, SourceLine)> {
        let Hold { entry, slept_s, is_fixed } = self.hold.take()?;
        let ScheduleEntry { motion: Motion::Wait { seconds, .. }, place, .. } =
            self.entries.get_mut(entry)?
        else {
            return None;
        };
        let rest = *seconds - slept_s;
        *seconds = slept_s;
        Some((rest, is_fixed, place.clone()))
    }

    /// Returns all entries. Blends are kept only before a motion that is sent in time, and trailing
    /// load changes are removed. A motion whose end the program waits for is blocking.
    pub(crate) fn finish(mut self) -> Vec<(Motion, SourceLine)> {
        while let Some(ScheduleEntry { motion: Motion::Load(_), .. }) = self.entries.last() {
            self.entries.pop();
        }
        // Remove holds that were ended at once.
        self.entries.retain(
            |entry| !matches!(entry.motion, Motion::Wait { seconds, overlap: 0 } if seconds <= 0.0),
        );
        let mut is_followed = false;
        for entry in self.entries.iter_mut().rev() {
            match &mut entry.motion {
                waiting if waiting.is_overlapping_wait() => continue,
                Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => {
                    is_followed = false;
                    continue;
                }
                Motion::Ptp(ptp) => {
                    ptp.blocking = entry.is_awaited;
                    ptp.blend = ptp.blend.filter(|_| is_followed && !entry.is_awaited);
                }
                Motion::Cartesian(cartesian) => {
                    cartesian.blocking = entry.is_awaited;
                    cartesian.blend = cartesian.blend.filter(|_| is_followed && !entry.is_awaited);
                }
            }
            is_followed = true;
        }
        self.entries.into_iter().map(|entry| (entry.motion, entry.place)).collect()
    }
}

fn moves(motion: &Motion) -> bool {
    matches!(motion, Motion::Ptp(_) | Motion::Cartesian(_))
}

#[cfg(test)]
mod tests {
    use std::rc::Rc;

    use iiwa_program::{Blend, Ptp};

    use super::*;

    fn place(line: u32) -> SourceLine {
        SourceLine { file: Rc::from("src/A.java"), line }
    }

    fn blended() -> Motion {
        Motion::Ptp(Ptp::to([0.1; 7]).blend(Blend::CartMm(20.0)))
    }

    fn is_blocking(entry: &(Motion, SourceLine)) -> bool {
        entry.0.is_blocking()
    }

    fn has_blend(entry: &(Motion, SourceLine)) -> bool {
        matches!(&entry.0, Motion::Ptp(Ptp { blend: Some(_), .. }))
    }

    #[test]
    fn blends_need_a_follower_that_is_known() {
        let mut schedule = Schedule::default();
        schedule.send(blended(), place(1));
        schedule.wait(0.2, place(2));
        schedule.send(blended(), place(3));
        schedule.await_all();
        schedule.send(blended(), place(4));
        schedule.load(None, place(5));
        schedule.send(blended(), place(6));
        let entries = schedule.finish();
        let blends: Vec<bool> = entries.iter().map(has_blend).collect();
        assert_eq!(blends, [true, false, false, false, false, false]);
        let blocking: Vec<bool> = entries.iter().map(is_blocking).collect();
        assert_eq!(blocking, [false, false, true, true, false, false]);
        assert_eq!(entries[1].0, Motion::Wait { seconds: 0.2, overlap: 1 });
    }

    #[test]
    fn a_wait_overlaps_all_that_is_under_way() {
        let mut schedule = Schedule::default();
        schedule.wait(1.0, place(1));
        schedule.send(blended(), place(2));
        schedule.send(blended(), place(3));
        schedule.wait(0.7, place(4));
        schedule.await_all();
        schedule.wait(0.3, place(5));
        let overlaps: Vec<usize> = schedule
            .finish()
            .iter()
            .filter_map(|(motion, _)| match motion {
                Motion::Wait { overlap, .. } => Some(*overlap),
                _ => None,
            })
            .collect();
        assert_eq!(overlaps, [0, 2, 0]);
    }

    fn waits(schedule: Schedule) -> Vec<(f64, u32)> {
        let entries = schedule.finish();
        let waits = entries.iter().filter_map(|(motion, place)| match motion {
            Motion::Wait { seconds, .. } => Some((*seconds, place.line)),
            _ => None,
        });
        waits.collect()
    }

    #[test]
    fn sleeps_run_during_a_hold() {
        let mut schedule = Schedule::default();
        schedule.hold(3.0, false, place(1));
        schedule.wait(1.0, place(2));
        schedule.wait(4.0, place(3));
        schedule.wait(0.5, place(4));
        assert_eq!(waits(schedule), [(3.0, 1), (2.0, 3), (0.5, 4)]);
        let mut schedule = Schedule::default();
        schedule.hold(3.0, false, place(1));
        schedule.wait(1.0, place(2));
        schedule.end_hold();
        schedule.hold(3.0, false, place(4));
        schedule.end_hold();
        schedule.hold(2.0, false, place(6));
        schedule.wait(0.5, place(7));
        schedule.load(Some(Load { mass_kg: 1.0, ..Load::default() }), place(8));
        schedule.wait(0.5, place(9));
        schedule.send(blended(), place(10));
        assert_eq!(waits(schedule), [(1.0, 1), (0.5, 6), (1.5, 6)]);
    }

    #[test]
    fn only_the_last_of_several_loads_counts() {
        let mut schedule = Schedule::default();
        schedule.send(blended(), place(1));
        schedule.load(Some(Load { mass_kg: 1.0, ..Load::default() }), place(2));
        schedule.load(None, place(3));
        schedule.send(blended(), place(4));
        schedule.load(None, place(5));
        let lines: Vec<u32> = schedule.finish().iter().map(|(_, place)| place.line).collect();
        assert_eq!(lines, [1, 3, 4]);
    }
}
