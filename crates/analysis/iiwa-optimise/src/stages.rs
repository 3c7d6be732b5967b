//! Parts of a program between the stops of its groups of motions.
//!
//! If the arm stops at the first and at the last target of each group, and if all motions between
//! groups are point-to-point motions from stop to stop, the cycle time is a sum of two kinds of
//! terms: times within a group, which depend on its E1 alone, and times from one group to the next,
//! which depend on the E1 of both.

use std::ops::{Range, RangeInclusive};

use iiwa_kin::{Joint, Joints, Robot};
use iiwa_program::{Motion, Program, Start};
use iiwa_traj::Trajectory;

use crate::{change::Change, cycle_time::CycleTimes, elbows::ElbowGroup, part::part};

/// The groups of a program as stages, with gaps before, between and after them.
pub(crate) struct Stages<'a> {
    program: &'a Program,
    groups: Vec<StageGroup>,
}

/// A group that turns.
struct StageGroup {
    group: ElbowGroup,
    /// E1 of the first target, in rad.
    e1_rad: f64,
    /// A program of this group alone, from the start of the whole program.
    alone: Program,
}

/// A group with another E1.
pub(crate) struct TurnedGroup {
    /// Difference from the E1 of the program, in degrees.
    pub(crate) by_deg: i16,
    /// The first motion.
    first: Motion,
    /// Time from the end of the first motion to that of the last one, in s.
    pub(crate) within_s: f64,
    /// Joint positions at these ends, in rad.
    pub(crate) ends_rad: [Joints; 2],
}

impl<'a> Stages<'a> {
    /// Divides a program; `None` if its cycle time is not such a sum.
    pub(crate) fn new(program: &'a Program) -> Option<Self> {
        let groups = ElbowGroup::all(program).into_iter().map(|(group, e1_rad)| {
            let motions = &program.motions[entries(group)];
            let alone = part(program, program.start.clone(), motions.to_vec());
            StageGroup { group, e1_rad, alone }
        });
        let stages = Self { program, groups: groups.collect() };
        let is_stop = |entry: &Motion| entry.moves() && entry.blend().is_none();
        let are_groups_fixed = stages.groups.iter().all(|stage| {
            let motions = &stage.alone.motions;
            let ends = motions.first().zip(motions.last());
            ends.is_some_and(|(first, last)| {
                program.is_independent(first) && is_stop(first) && is_stop(last)
            })
        });
        let are_gaps_lines = (0..=stages.count()).all(|gap| {
            let line = |entry: &Motion| matches!(entry, Motion::Ptp(_)) && is_stop(entry);
            stages.gap(gap).iter().all(|entry| line(entry) || !entry.moves())
        });
        let overlaps = program.motions.iter().any(Motion::is_overlapping_wait);
        let is_sum = stages.count() > 0 && are_groups_fixed && are_gaps_lines && !overlaps;
        is_sum.then_some(stages)
    }

    /// Number of groups.
    pub(crate) fn count(&self) -> usize {
        self.groups.len()
    }

    /// Returns the change of a group by an angle in degrees.
    pub(crate) fn turn(&self, stage: usize, by_deg: i16) -> Change {
        let StageGroup { group, e1_rad, .. } = &self.groups[stage];
        group.turned_by(*e1_rad, f64::from(by_deg))
    }

    /// Returns the whole degrees by which E1 at the first target of a group can change.
    pub(crate) fn range_deg(&self, stage: usize, robot: &Robot) -> RangeInclusive<i16> {
        const ROUNDING_DEG: f64 = 1e-9;

        let e1_deg = self.groups[stage].e1_rad.to_degrees();
        let [low, high] = robot.limits().range_rad(Joint::A3).map(f64::to_degrees);
        #[expect(clippy::cast_possible_truncation, reason = "angles of joints are below 360 deg")]
        let whole = |deg: f64| deg as i16;
        // No turn is within the range, also at its ends.
        whole((low - e1_deg - ROUNDING_DEG).ceil())..=whole((high - e1_deg + ROUNDING_DEG).floor())
    }

    /// Returns a group with another E1; `None` if the robot cannot execute it.
    pub(crate) fn turned(
        &self,
        times: &mut CycleTimes<'_>,
        stage: usize,
        by_deg: i16,
    ) -> Option<TurnedGroup> {
        let StageGroup { group, alone, .. } = &self.groups[stage];
        let turn = self.turn(stage, by_deg).at_start();
        let mut motions = turn.apply(alone)?.motions.into_iter();
        let first = motions.next()?;
        // Its target does not depend on the start, which the arm may never leave for it.
        let to_first = part(self.program, self.program.start.clone(), vec![first.clone()]);
        let first_rad = times.last_rad(&to_first)?;
        let rest: Vec<Motion> = motions.collect();
        let (within_s, last_rad) = if rest.is_empty() {
            (0.0, first_rad)
        } else {
            let after_first = group.first().index() + 1;
            times.end(&part_at(self.program, first_rad.into(), after_first, rest))?
        };
        Some(TurnedGroup { by_deg, first, within_s, ends_rad: [first_rad, last_rad] })
    }

    /// Plans the motions of a gap, which is before the stage with this index, up to the first
    /// motion of `after`. `before` and `after` are the groups around it. There has to be an entry.
    pub(crate) fn plan_gap(
        &self,
        times: &mut CycleTimes<'_>,
        gap: usize,
        before: Option<&TurnedGroup>,
        after: Option<&TurnedGroup>,
    ) -> Option<Trajectory> {
        let start = before.map_or_else(|| self.program.start.clone(), |it| it.ends_rad[1].into());
        let entries = self.gap(gap).iter().chain(after.map(|after| &after.first));
        let first = self.gap_entries(gap).start;
        times.plan(&part_at(self.program, start, first, entries.cloned().collect())).ok()
    }

    /// Entries of a gap.
    pub(crate) fn gap(&self, gap: usize) -> &'a [Motion] {
        &self.program.motions[self.gap_entries(gap)]
    }

    fn gap_entries(&self, gap: usize) -> Range<usize> {
        let group = |stage: usize| self.groups.get(stage).map(|stage| entries(stage.group));
        let before = gap.checked_sub(1).and_then(group);
        let start = before.map_or(0, |entries| entries.end);
        start..group(gap).map_or(self.program.motions.len(), |entries| entries.start)
    }
}

fn entries(group: ElbowGroup) -> Range<usize> {
    group.first().index()..group.last().index() + 1
}

/// Returns a program of some entries of `program`, with the payload before its entry at `index`.
fn part_at(program: &Program, start: Start, index: usize, entries: Vec<Motion>) -> Program {
    let is_load = |entry: &&Motion| matches!(entry, Motion::Load(_));
    let load = program.motions[..index].iter().rev().find(is_load);
    part(program, start, load.cloned().into_iter().chain(entries).collect())
}
