//! Searches for the changes that save time.

use std::{
    collections::BTreeMap,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering::Relaxed},
    },
};

use iiwa_kin::Robot;
use iiwa_plan::PlanOptions;
use iiwa_program::{Motion, Program};
use iiwa_traj::{PlanError, TimingError, Trajectory};

use crate::{
    change::Change,
    change_search::{ChangeSearch, Rule},
    cycle_time::{CycleTimes, Version},
    elbow_runs::elbows_together,
    freedom::Freedom,
    ladder::{FastestElbows, fastest_elbows},
    results::{Advice, LowerBound, Optimum},
    search_settings::SearchSettings,
};

/// Searches for changes that make programs faster on one robot.
#[derive(Clone, Debug)]
pub struct Optimiser {
    pub(crate) settings: SearchSettings,
    budget: u64,
}

impl Optimiser {
    /// Creates an optimiser for a robot, for all changes of motions and blends of up to 50 mm.
    #[must_use]
    pub fn new(robot: Robot, options: PlanOptions) -> Self {
        let settings = SearchSettings {
            robot,
            options,
            freedom: Freedom::MOTIONS,
            max_blend_mm: 50.0,
            plans: Arc::default(),
            stop: Arc::default(),
        };
        Self { settings, budget: 50_000 }
    }

    /// Sets the kinds of changes.
    #[must_use]
    pub fn with_freedom(mut self, freedom: Freedom) -> Self {
        self.settings.freedom = freedom;
        self
    }

    /// Sets the largest radius of blends, in mm.
    #[must_use]
    pub fn with_max_blend_mm(mut self, max_blend_mm: f64) -> Self {
        self.settings.max_blend_mm = max_blend_mm;
        self
    }

    /// Sets the number of plans after which [`optimise`](Self::optimise) begins no further round of
    /// changes. The plans before these rounds, which turn elbow angles of several groups of motions
    /// together, do not count: at most 1500 turns, each the fastest of 16, or at most five times
    /// this number of groups and ways between them. The result does not depend on the speed of the
    /// machine.
    #[must_use]
    pub fn with_budget(self, plans: u64) -> Self {
        Self { budget: plans, ..self }
    }

    /// Ends a search soon after `stop` is set.
    #[must_use]
    pub fn interrupted_by(mut self, stop: Arc<AtomicBool>) -> Self {
        self.settings.stop = stop;
        self
    }

    /// The robot.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.settings.robot
    }

    /// Number of plans of this optimiser and its clones so far, also while a search runs.
    #[must_use]
    pub fn plan_count(&self) -> Arc<AtomicU64> {
        Arc::clone(&self.settings.plans)
    }

    /// Plans a whole program.
    ///
    /// # Errors
    ///
    /// If the program cannot be planned.
    pub fn plan(&self, program: &Program) -> Result<Trajectory, PlanError> {
        self.settings.cycle_times(&AtomicU64::new(0)).plan(program)
    }

    /// Searches for changes of `program` that save at least a millisecond each.
    ///
    /// # Errors
    ///
    /// If the program cannot be planned as it is, or if the search is interrupted.
    pub fn advise(&self, program: &Program) -> Result<Advice, PlanError> {
        self.advice(program, None)
    }

    /// As [`advise`](Self::advise), with only those changes after which `rule` accepts the whole
    /// trajectory: for example because the arm keeps its distance from obstacles.
    ///
    /// # Errors
    ///
    /// As for [`advise`](Self::advise).
    pub fn advise_within(
        &self,
        program: &Program,
        rule: &(dyn Fn(&Trajectory) -> bool + Sync),
    ) -> Result<Advice, PlanError> {
        self.advice(program, Some(rule))
    }

    fn advice(&self, program: &Program, rule: Rule<'_>) -> Result<Advice, PlanError> {
        let plans = AtomicU64::new(0);
        let mut times = self.settings.cycle_times(&plans);
        let version = times.version(program)?;
        let cycle_time_s = version.cycle_time_s;
        let search =
            ChangeSearch { settings: &self.settings, version: &version, rule, plans: &plans };
        let (rows, changed) = search.round(&mut times, None);
        self.check_stop()?;
        let changed = changed.unwrap_or(version);
        Ok(Advice {
            cycle_time_s,
            rows,
            changed_cycle_time_s: changed.cycle_time_s,
            program: changed.program,
        })
    }

    /// Searches for a faster version of `program`: tries all changes, makes those that save time,
    /// and tries again, until no single change saves a millisecond more. Where the elbow angles of
    /// all groups can be compared, it begins with the fastest of them.
    ///
    /// # Errors
    ///
    /// If the program cannot be planned as it is, or if the search is interrupted.
    pub fn optimise(&self, program: &Program) -> Result<Optimum, PlanError> {
        self.optimum(program, None)
    }

    /// As [`optimise`](Self::optimise), with only those changes after which `rule` accepts the
    /// whole trajectory.
    ///
    /// # Errors
    ///
    /// As for [`optimise`](Self::optimise).
    pub fn optimise_within(
        &self,
        program: &Program,
        rule: &(dyn Fn(&Trajectory) -> bool + Sync),
    ) -> Result<Optimum, PlanError> {
        self.optimum(program, Some(rule))
    }

    fn optimum(&self, program: &Program, rule: Rule<'_>) -> Result<Optimum, PlanError> {
        let plans = AtomicU64::new(0);
        let mut times = self.settings.cycle_times(&plans);
        let mut version = times.version(program)?;
        let unchanged = version.clone();
        let mut changes = Vec::new();
        let mut lower_bound = None;
        if self.settings.freedom.elbows {
            let search =
                ChangeSearch { settings: &self.settings, version: &version, rule, plans: &plans };
            let (turned, bound) = self.turned(&search, &mut times);
            lower_bound = bound;
            if let Some((turns, changed)) = turned {
                version = changed;
                changes = turns;
            }
        }
        let before_rounds = plans.load(Relaxed);
        // All motions at first, then those whose surroundings have changed, and all at the end.
        let mut tried = None;
        let mut is_complete = false;
        while !is_complete && plans.load(Relaxed) - before_rounds < self.budget {
            self.check_stop()?;
            let search =
                ChangeSearch { settings: &self.settings, version: &version, rule, plans: &plans };
            let (rows, changed) = search.round(&mut times, tried.as_deref());
            is_complete = rows.is_empty() && tried.is_none();
            let made: Vec<_> = rows.into_iter().map(|row| row.change).collect();
            tried = (!made.is_empty()).then(|| surroundings(program, &made));
            version = changed.unwrap_or(version);
            changes.extend(made);
        }
        self.check_stop()?;
        let changes = merged(changes);
        // Without the changes that later ones have undone.
        let search =
            ChangeSearch { settings: &self.settings, version: &unchanged, rule, plans: &plans };
        let version = search.with_all(&mut times, &changes);
        self.check_stop()?;
        let (changes, version) = match version {
            Some(version) => (changes, version),
            None => (Vec::new(), unchanged.clone()),
        };
        Ok(Optimum {
            cycle_time_s: unchanged.cycle_time_s,
            changed_cycle_time_s: version.cycle_time_s,
            program: version.program,
            changes,
            plans: plans.load(Relaxed),
            lower_bound: lower_bound.and_then(|bound| bound.below(version.cycle_time_s)),
            is_complete,
        })
    }

    /// Turns the elbow angles of several groups together. Returns the turns and the version with
    /// them, if they save time, and the lower bound, if it is known.
    fn turned(
        &self,
        search: &ChangeSearch<'_>,
        times: &mut CycleTimes<'_>,
    ) -> (Option<(Vec<Change>, Version)>, Option<LowerBound>) {
        // The bound does not hold if something else may change as well.
        let is_alone = self.settings.freedom == Freedom::ELBOWS;
        let ladder = is_alone.then(|| fastest_elbows(search, times, self.budget)).flatten();
        let Some(FastestElbows { turned, lower_bound, is_proven }) = ladder else {
            return (elbows_together(search, times), None);
        };
        // The ladder knows no rule: it may reject the fastest turns.
        if is_proven && (search.rule.is_none() || turned.is_some()) {
            return (turned, Some(lower_bound));
        }
        let others = [turned, elbows_together(search, times)].into_iter().flatten();
        let fastest = others.min_by(|(_, a), (_, b)| a.cycle_time_s.total_cmp(&b.cycle_time_s));
        (fastest, Some(lower_bound))
    }

    /// To the search, a plan that was interrupted is a change that is not possible.
    pub(crate) fn check_stop(&self) -> Result<(), PlanError> {
        if self.settings.stop.load(Relaxed) { Err(TimingError::Interrupted.into()) } else { Ok(()) }
    }
}

/// Marks the motions between the stops before and after each change. What a change of any other
/// motion saves depends little on it.
fn surroundings(program: &Program, changes: &[Change]) -> Vec<bool> {
    let ends_in_stop = |entry: &Motion| entry.blend().is_none();
    let mut marked = vec![false; program.motions.len()];
    for change in changes {
        let (first, last) = (change.motion.index(), change.last().index());
        let before = program.motions[..first].iter().rposition(ends_in_stop);
        // The motion after the last one starts with another elbow angle.
        let after = (last + 1).min(marked.len() - 1);
        let to_stop = program.motions[after..].iter().position(ends_in_stop);
        let end = to_stop.map_or(marked.len(), |more| after + more + 1);
        marked[before.unwrap_or(0)..end].fill(true);
    }
    marked
}

/// Merges changes that were made one after the other: each motion has at most one of each kind.
fn merged(changes: Vec<Change>) -> Vec<Change> {
    let mut all: BTreeMap<_, Change> = BTreeMap::new();
    for change in changes {
        let key = (change.motion, change.property());
        match all.remove(&key) {
            None => all.insert(key, change),
            Some(earlier) => earlier.followed_by(change).and_then(|both| all.insert(key, both)),
        };
    }
    all.into_values().collect()
}
