//! Search for the changes that save time.

use std::{
    cmp::Ordering,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering::Relaxed},
    },
};

use iiwa_kin::Robot;
use iiwa_plan::PlanOptions;
use iiwa_program::Program;
use iiwa_traj::{TimingError, Trajectory};
use rayon::prelude::*;

use crate::{
    blends::{awaited, blends},
    change::Change,
    cycle_time::{AdviseError, CycleTimes, Version},
    elbows::{ElbowGroup, RANGE_DEG, STEPS_DEG},
    speeds::full_speeds,
};

/// Smallest saving of a row, in s.
const LEAST_S: f64 = 1e-3;

/// Share of the largest saving of a blend from which on a smaller radius is preferred: it stays
/// nearer to the corner.
const ENOUGH: f64 = 0.95;

/// Changes of a program that save time.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Advice {
    /// Cycle time of the program as it is, in s.
    pub cycle_time_s: f64,
    /// Changes, the largest saving first.
    pub rows: Vec<AdviceRow>,
    /// Program with all changes.
    pub program: Program,
    /// Its cycle time, in s.
    pub changed_cycle_time_s: f64,
}

/// A change, and the time that it saves.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct AdviceRow {
    /// The change.
    pub change: Change,
    /// Time that the change saves alone, in s.
    pub saved_s: f64,
    /// Time that it saves after all changes before it, in s.
    pub saved_on_top_s: f64,
}

/// Searches for changes that make programs faster on one robot.
#[derive(Clone, Debug)]
pub struct Adviser {
    robot: Robot,
    options: PlanOptions,
    max_blend_mm: f64,
    stop: Arc<AtomicBool>,
}

/// Rule that the trajectory of a changed program has to satisfy.
type Rule<'a> = Option<&'a (dyn Fn(&Trajectory) -> bool + Sync)>;

impl Adviser {
    /// Creates an adviser for a robot, with blends of up to 50 mm.
    #[must_use]
    pub fn new(robot: Robot, options: PlanOptions) -> Self {
        Self { robot, options, max_blend_mm: 50.0, stop: Arc::default() }
    }

    /// Sets the largest radius of blends, in mm.
    #[must_use]
    pub fn with_max_blend_mm(self, max_blend_mm: f64) -> Self {
        Self { max_blend_mm, ..self }
    }

    /// Ends a search soon after `stop` is set.
    #[must_use]
    pub fn interrupted_by(self, stop: Arc<AtomicBool>) -> Self {
        Self { stop, ..self }
    }

    /// Plans a whole program.
    ///
    /// # Errors
    ///
    /// If the program cannot be planned.
    pub fn plan(&self, program: &Program) -> Result<Trajectory, AdviseError> {
        self.cycle_times().plan(program)
    }

    /// Searches for changes of `program` that save at least a millisecond each.
    ///
    /// # Errors
    ///
    /// If the program cannot be planned as it is, or if the search is interrupted.
    pub fn advise(&self, program: &Program) -> Result<Advice, AdviseError> {
        self.search(program, None)
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
    ) -> Result<Advice, AdviseError> {
        self.search(program, Some(rule))
    }

    fn search(&self, program: &Program, rule: Rule<'_>) -> Result<Advice, AdviseError> {
        let mut times = self.cycle_times();
        let version = times.version(program)?;
        let cycle_time_s = version.cycle_time_s;
        let mut found = ChangeSearch { adviser: self, version: &version, rule }.best_changes();
        found.sort_by(|(a, a_s), (b, b_s)| {
            let by_saving = b_s.partial_cmp(a_s).unwrap_or(Ordering::Equal);
            by_saving.then_with(|| a.motion.cmp(&b.motion))
        });
        let mut rows = Vec::new();
        let mut version = version;
        for (change, saved_s) in found {
            let search = ChangeSearch { adviser: self, version: &version, rule };
            let Some(saved_on_top_s) = search.saved_s(&mut times, &change) else { continue };
            let changed = change.apply(&version.program);
            let Some(Ok(changed)) = changed.map(|changed| times.version(&changed)) else {
                continue;
            };
            version = changed;
            rows.push(AdviceRow { change, saved_s, saved_on_top_s });
        }
        // To the search, a plan that was interrupted is a change that is not possible.
        if self.stop.load(Relaxed) {
            return Err(TimingError::Interrupted.into());
        }
        Ok(Advice {
            cycle_time_s,
            rows,
            changed_cycle_time_s: version.cycle_time_s,
            program: version.program,
        })
    }

    fn cycle_times(&self) -> CycleTimes<'_> {
        CycleTimes::new(&self.robot, &self.options, &self.stop)
    }
}

/// Search for single changes of one program.
struct ChangeSearch<'a> {
    adviser: &'a Adviser,
    version: &'a Version,
    rule: Rule<'a>,
}

/// A question of the search: alternatives of which at most one is kept.
enum Alternatives {
    /// Another E1 for a group, which has this one, in rad.
    Elbow(ElbowGroup, f64),
    /// Changes in order of preference: a later one is kept only if it saves more.
    List(Vec<Change>),
}

impl ChangeSearch<'_> {
    /// Returns the best change of each kind at each place, with its saving in s.
    fn best_changes(&self) -> Vec<(Change, f64)> {
        let elbows = ElbowGroup::all(&self.version.program);
        let elbows = elbows.into_iter().map(|(group, e1_rad)| Alternatives::Elbow(group, e1_rad));
        let blends = blends(&self.version.program, self.adviser.max_blend_mm);
        let blends = blends.into_iter().map(Alternatives::List);
        let program = &self.version.program;
        let single = full_speeds(program).into_iter().chain(awaited(program));
        let single = single.map(|change| Alternatives::List(vec![change]));
        let all: Vec<_> = elbows.chain(blends).chain(single).collect();
        let best = all.into_par_iter().map_init(
            || self.adviser.cycle_times(),
            |times, alternatives| match alternatives {
                Alternatives::Elbow(group, e1_rad) => self.best_elbow(times, group, e1_rad),
                Alternatives::List(changes) => self.best_of(times, changes),
            },
        );
        best.flatten().collect()
    }

    /// Time that a change saves, in s; `None` if it saves less than a millisecond, or is not
    /// possible.
    fn saved_s(&self, times: &mut CycleTimes<'_>, change: &Change) -> Option<f64> {
        let (program, cycle_time_s) = times.changed(self.version, change)?;
        let saved_s = self.version.cycle_time_s - cycle_time_s;
        let mut is_allowed = || match self.rule {
            Some(rule) => times.plan(&program).is_ok_and(|trajectory| rule(&trajectory)),
            None => true,
        };
        (saved_s >= LEAST_S && is_allowed()).then_some(saved_s)
    }

    /// Returns the first change that saves nearly as much as the best one.
    fn best_of(&self, times: &mut CycleTimes<'_>, changes: Vec<Change>) -> Option<(Change, f64)> {
        let saved = |change: Change| self.saved_s(times, &change).map(|saved_s| (change, saved_s));
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
        let e1_deg = e1_rad.to_degrees();
        let change = |by_deg: f64| group.turned(e1_rad, (e1_deg + by_deg).to_radians());
        let mut best = (0.0, 0.0);
        let mut range_deg = RANGE_DEG;
        for step_deg in STEPS_DEG {
            let center_deg = best.0;
            let steps = (range_deg / step_deg).round();
            let mut by_deg = center_deg - steps * step_deg;
            while by_deg <= center_deg + steps * step_deg + 1e-9 {
                if by_deg.abs() <= RANGE_DEG {
                    let saved_s = self.saved_s(times, &change(by_deg)).unwrap_or(f64::MIN);
                    if saved_s > best.1 {
                        best = (by_deg, saved_s);
                    }
                }
                by_deg += step_deg;
            }
            range_deg = step_deg;
        }
        (best.1 > 0.0).then(|| (change(best.0), best.1))
    }
}
