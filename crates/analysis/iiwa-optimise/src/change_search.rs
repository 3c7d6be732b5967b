//! Search for single changes of one version of a program.

use std::{
    ops::Range,
    sync::atomic::{AtomicU64, Ordering::Relaxed},
};

use iiwa_program::Program;
use iiwa_traj::Trajectory;
use rayon::prelude::*;

use crate::{
    blends::{awaited, blends},
    change::Change,
    cycle_time::{CycleTimes, Version},
    elbows::{ElbowGroup, RANGE_DEG, STEPS_DEG},
    results::AdviceRow,
    search_settings::SearchSettings,
    speeds::full_speeds,
    waits::waits_at_rest,
};

/// Smallest saving of a change, in s.
pub(crate) const LEAST_S: f64 = 1e-3;

/// Share of the largest saving of a blend from which on a smaller radius is preferred: it stays
/// nearer to the corner.
const ENOUGH: f64 = 0.95;

/// Rule that the trajectory of a changed program has to satisfy.
pub(crate) type Rule<'a> = Option<&'a (dyn Fn(&Trajectory) -> bool + Sync)>;

/// Search for changes of one version of a program.
pub(crate) struct ChangeSearch<'a> {
    pub(crate) settings: &'a SearchSettings,
    pub(crate) version: &'a Version,
    pub(crate) rule: Rule<'a>,
    /// Number of plans of this search.
    pub(crate) plans: &'a AtomicU64,
}

/// A question of the search: alternatives of which at most one is kept.
enum Alternatives {
    /// Another E1 for a group, which has this one, in rad.
    Elbow(ElbowGroup, f64),
    /// Changes in order of preference: a later one is kept only if it saves more.
    List(Vec<Change>),
}

impl Alternatives {
    /// Returns the indices of the motions that change.
    fn motions(&self) -> Range<usize> {
        match self {
            Self::Elbow(group, _) => group.first().index()..group.last().index() + 1,
            Self::List(changes) => changes
                .first()
                .map_or(0..0, |change| change.motion.index()..change.last().index() + 1),
        }
    }
}

impl ChangeSearch<'_> {
    /// Tries changes, of all motions or only of marked ones, and makes those that save time, the
    /// largest saving first. Returns no version if nothing changes.
    pub(crate) fn round(
        &self,
        times: &mut CycleTimes<'_>,
        motions: Option<&[bool]>,
    ) -> (Vec<AdviceRow>, Option<Version>) {
        let mut found = self.best_changes(motions);
        found
            .sort_by(|(a, a_s), (b, b_s)| b_s.total_cmp(a_s).then_with(|| a.motion.cmp(&b.motion)));
        let mut rows = Vec::new();
        let mut changed: Option<Version> = None;
        for (change, saved_s) in found {
            let version = changed.as_ref().unwrap_or(self.version);
            let search = ChangeSearch { version, ..*self };
            let Some(saved_on_top_s) = search.saved_s(times, &[&change]) else { continue };
            let program = change.apply(&version.program);
            let Some(Ok(next)) = program.map(|program| times.version(&program)) else { continue };
            let mut rests_on = Vec::new();
            for text in [version, &next].into_iter().flat_map(|it| it.assumptions_about(&change)) {
                if !rests_on.contains(&text) {
                    rests_on.push(text);
                }
            }
            changed = Some(next);
            rows.push(AdviceRow { change, saved_s, saved_on_top_s, rests_on });
        }
        (rows, changed)
    }

    /// Returns the version with all changes; `None` if they save less than a millisecond, or are
    /// not possible.
    pub(crate) fn with_all(
        &self,
        times: &mut CycleTimes<'_>,
        changes: &[Change],
    ) -> Option<Version> {
        let apply = |program: Program, change: &Change| change.apply(&program);
        let program = changes.iter().try_fold(self.version.program.clone(), apply)?;
        let version = times.version(&program).ok()?;
        let is_faster = self.version.cycle_time_s - version.cycle_time_s >= LEAST_S;
        (is_faster && self.allows(times, &version.program)).then_some(version)
    }

    /// Leaves out changes that save less than a millisecond beside all others. Returns the changes
    /// that are left, and the version with them; `None` if they save less than a millisecond, or
    /// are not possible.
    pub(crate) fn with_needed(
        &self,
        times: &mut CycleTimes<'_>,
        mut changes: Vec<Change>,
    ) -> Option<(Vec<Change>, Version)> {
        let mut cycle_time_s = |changes: &[Change]| {
            let changed = times.changed(self.version, &changes.iter().collect::<Vec<_>>());
            changed.map_or(f64::INFINITY, |(_, cycle_time_s)| cycle_time_s)
        };
        let mut changed_s = cycle_time_s(&changes);
        for index in (0..changes.len()).rev() {
            let mut others = changes.clone();
            others.remove(index);
            let others_s = cycle_time_s(&others);
            if others_s - changed_s < LEAST_S {
                (changes, changed_s) = (others, others_s);
            }
        }
        let version = self.with_all(times, &changes)?;
        Some((changes, version))
    }

    /// Returns the best change of each kind at each place, or only at marked motions, with the time
    /// that it saves, in s.
    fn best_changes(&self, motions: Option<&[bool]>) -> Vec<(Change, f64)> {
        let freedom = self.settings.freedom;
        let program = &self.version.program;
        let mut all = Vec::new();
        if freedom.elbows {
            let groups = ElbowGroup::all(program).into_iter();
            all.extend(groups.map(|(group, e1_rad)| Alternatives::Elbow(group, e1_rad)));
        }
        let single = |change: Change| Alternatives::List(vec![change]);
        if freedom.blends {
            let radii = blends(program, self.settings.max_blend_mm).into_iter();
            all.extend(radii.map(Alternatives::List));
            all.extend(awaited(program).into_iter().map(single));
        }
        if freedom.speeds {
            all.extend(full_speeds(program).into_iter().map(single));
        }
        if freedom.waits {
            all.extend(waits_at_rest(program).into_iter().map(single));
        }
        if let Some(motions) = motions {
            all.retain(|alternatives| alternatives.motions().any(|motion| motions[motion]));
        }
        let best = all.into_par_iter().map_init(
            || self.cycle_times(),
            |times, alternatives| match alternatives {
                Alternatives::Elbow(group, e1_rad) => self.best_elbow(times, group, e1_rad),
                Alternatives::List(changes) => self.best_of(times, changes),
            },
        );
        best.flatten().collect()
    }

    /// Returns true if the search has to end soon.
    pub(crate) fn is_interrupted(&self) -> bool {
        self.settings.stop.load(Relaxed)
    }

    pub(crate) fn cycle_times(&self) -> CycleTimes<'_> {
        self.settings.cycle_times(self.plans)
    }

    /// Time that changes save together, in s; `None` if it is less than a millisecond, or if they
    /// are not possible.
    pub(crate) fn saved_s(&self, times: &mut CycleTimes<'_>, changes: &[&Change]) -> Option<f64> {
        let (program, cycle_time_s) = times.changed(self.version, changes)?;
        let saved_s = self.version.cycle_time_s - cycle_time_s;
        (saved_s >= LEAST_S && self.allows(times, &program)).then_some(saved_s)
    }

    /// Returns true if the rule accepts the plan of a program.
    pub(crate) fn allows(&self, times: &mut CycleTimes<'_>, program: &Program) -> bool {
        self.rule.is_none_or(|rule| times.plan(program).is_ok_and(|trajectory| rule(&trajectory)))
    }

    /// Returns the first change that saves nearly as much as the best one.
    fn best_of(&self, times: &mut CycleTimes<'_>, changes: Vec<Change>) -> Option<(Change, f64)> {
        let saved =
            |change: Change| self.saved_s(times, &[&change]).map(|saved_s| (change, saved_s));
        let all: Vec<_> = changes.into_iter().filter_map(saved).collect();
        let most_s = all.iter().map(|(_, saved_s)| *saved_s).fold(f64::MIN, f64::max);
        all.into_iter().find(|(_, saved_s)| *saved_s >= ENOUGH * most_s)
    }

    /// Returns the best E1 of a group: of coarse steps first, then of finer ones about the best.
    fn best_elbow(
        &self,
        times: &mut CycleTimes<'_>,
        group: ElbowGroup,
        e1_rad: f64,
    ) -> Option<(Change, f64)> {
        let mut best = (0.0, 0.0);
        let mut range_deg = RANGE_DEG;
        for step_deg in STEPS_DEG {
            let center_deg = best.0;
            let steps = (range_deg / step_deg).round();
            let mut by_deg = center_deg - steps * step_deg;
            while by_deg <= center_deg + steps * step_deg + 1e-9 {
                if by_deg.abs() <= RANGE_DEG {
                    let change = group.turned_by(e1_rad, by_deg);
                    let saved_s = self.saved_s(times, &[&change]).unwrap_or(f64::MIN);
                    if saved_s > best.1 {
                        best = (by_deg, saved_s);
                    }
                }
                by_deg += step_deg;
            }
            range_deg = step_deg;
        }
        (best.1 > 0.0).then(|| (group.turned_by(e1_rad, best.0), best.1))
    }
}
