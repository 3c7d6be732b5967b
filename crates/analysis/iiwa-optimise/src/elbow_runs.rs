//! Elbow angles of neighbouring groups, turned together.
//!
//! Two groups that follow each other may have to turn together: each of them alone would only make
//! the motion between them longer. Runs of neighbouring groups are therefore turned by the same
//! angle, single groups first, and the fastest turn of each run is made before the next run is
//! tried. A turn that saves less than a millisecond is not made.

use std::ops::Range;

use iiwa_program::Motion;
use rayon::prelude::*;

use crate::{
    change::Change,
    change_search::{ChangeSearch, LEAST_S},
    cycle_time::{CycleTimes, Version},
    elbows::ElbowGroup,
};

/// Turns that are tried in both directions, in degrees.
const TURNS_DEG: [f64; 8] = [1.0, 2.0, 4.0, 8.0, 15.0, 30.0, 60.0, 90.0];

/// Number of runs up to which there are long ones: with more than 75 groups, runs have two at most.
const MOST_RUNS: usize = 150;

/// Number of runs that are turned, some of them several times, with 16 plans each. Most programs
/// need fewer than 300.
const MOST_TURNED: usize = 1500;

/// Returns the changes, in the order in which they are made, and the version with them, if they
/// save time.
pub(crate) fn elbows_together(
    search: &ChangeSearch<'_>,
    times: &mut CycleTimes<'_>,
) -> Option<(Vec<Change>, Version)> {
    let runs = runs(search);
    let mut turned = search.version.clone();
    let mut changes = Vec::new();
    let mut unchanged = 0;
    for run in runs.iter().cycle().take(MOST_TURNED) {
        if search.is_interrupted() {
            return None;
        }
        let search = ChangeSearch { version: &turned, ..*search };
        match fastest_turn(&search, times, run.clone()) {
            Some((turns, version)) => {
                changes.extend(turns);
                turned = version;
                unchanged = 0;
            }
            None => unchanged += 1,
        }
        if unchanged == runs.len() {
            break;
        }
    }
    (!changes.is_empty()).then_some((changes, turned))
}

/// Returns runs of groups that no motion to joints separates, short ones first.
fn runs(search: &ChangeSearch<'_>) -> Vec<Range<usize>> {
    let program = &search.version.program;
    let groups = ElbowGroup::all(program);
    let is_run = |run: &Range<usize>| {
        let entries = groups[run.start].0.first().index()..groups[run.end - 1].0.last().index();
        !program.motions[entries].iter().any(|entry| matches!(entry, Motion::Ptp(_)))
    };
    let count = groups.len();
    let longest = (MOST_RUNS / count.max(1)).max(2).min(count);
    let all = (1..=longest)
        .flat_map(|length| (0..=count - length).map(move |start| start..start + length));
    all.filter(is_run).collect()
}

/// Returns the fastest turn of a run of groups that the rule accepts, if it saves time, and the
/// version with it.
fn fastest_turn(
    search: &ChangeSearch<'_>,
    times: &mut CycleTimes<'_>,
    run: Range<usize>,
) -> Option<(Vec<Change>, Version)> {
    let groups = &ElbowGroup::all(&search.version.program)[run];
    let turns = TURNS_DEG.iter().flat_map(|by_deg| [*by_deg, -by_deg]).map(|by_deg| {
        groups.iter().map(|(group, e1_rad)| group.turned_by(*e1_rad, by_deg)).collect()
    });
    let turns: Vec<Vec<Change>> = turns.collect();
    let timed = turns.into_par_iter().map_init(
        || search.cycle_times(),
        |times, turn| {
            let (_, cycle_time_s) =
                times.changed(search.version, &turn.iter().collect::<Vec<_>>())?;
            Some((cycle_time_s, turn))
        },
    );
    let mut timed: Vec<_> = timed.flatten().collect();
    timed.sort_by(|(a_s, _), (b_s, _)| a_s.total_cmp(b_s));
    let is_faster =
        |(cycle_time_s, _): &(f64, _)| search.version.cycle_time_s - cycle_time_s >= LEAST_S;
    timed.into_iter().take_while(is_faster).find_map(|(_, turn)| {
        let version = search.with_all(times, &turn)?;
        Some((turn, version))
    })
}
