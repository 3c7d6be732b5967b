//! Elbow angles of all groups together.
//!
//! Two groups that follow each other may have to turn together: each of them alone would only make
//! the motion between them longer. Turns in coarse steps are therefore tried for each group and for
//! each pair of neighbours, and a dynamic program finds the fastest combination, as if the cycle
//! time depended on neighbours alone. It does so where motions end in stops; with blends, the plan
//! of the combination decides. A turn that saves less than a millisecond is not made.

use iiwa_program::Motion;
use rayon::prelude::*;

use crate::{
    change::Change,
    change_search::{ChangeSearch, LEAST_S},
    cycle_time::{CycleTimes, Version},
    elbows::ElbowGroup,
};

/// Turns that are tried, in degrees; the first one is none.
const TURNS_DEG: [f64; 7] = [0.0, -90.0, -60.0, -30.0, 30.0, 60.0, 90.0];

/// Changes of the cycle time by the turn of one group, in s, plus the least saving of a turn.
type Alone = [f64; TURNS_DEG.len()];

/// Changes of the cycle time by the turns of two groups that none of them causes alone, in s.
type Together = [Alone; TURNS_DEG.len()];

/// Returns the changes of the fastest combination, and the version with them, if that saves time.
pub(crate) fn elbows_together(
    search: &ChangeSearch<'_>,
    times: &mut CycleTimes<'_>,
) -> Option<(Vec<Change>, Version)> {
    let groups = ElbowGroup::all(&search.version.program);
    let turns: Vec<_> = groups
        .iter()
        .map(|(group, e1_rad)| TURNS_DEG.map(|by_deg| group.turned_by(*e1_rad, by_deg)))
        .collect();
    let alone: Vec<Alone> = turns
        .par_iter()
        .map_init(
            || search.cycle_times(),
            |times, turns| {
                let mut alone = [0.0; TURNS_DEG.len()];
                for (more_s, turn) in alone.iter_mut().zip(turns).skip(1) {
                    *more_s = more_s_by(search, times, &[turn], true) + LEAST_S;
                }
                alone
            },
        )
        .collect();
    let pairs: Vec<Together> = (1..groups.len())
        .into_par_iter()
        .map_init(
            || search.cycle_times(),
            |times, second| {
                let mut together = Together::default();
                if !is_neighbour(search, &groups[second - 1].0, &groups[second].0) {
                    return together;
                }
                for a in 1..TURNS_DEG.len() {
                    for b in 1..TURNS_DEG.len() {
                        let sum_s = alone[second - 1][a] + alone[second][b] - 2.0 * LEAST_S;
                        if sum_s.is_finite() {
                            let both = [&turns[second - 1][a], &turns[second][b]];
                            together[a][b] = more_s_by(search, times, &both, false) - sum_s;
                        }
                    }
                }
                together
            },
        )
        .collect();
    let changes: Vec<Change> = fastest(&alone, &pairs)
        .into_iter()
        .zip(&turns)
        .filter(|(turn, _)| *turn > 0)
        .map(|(turn, turns)| turns[turn].clone())
        .collect();
    let turned = search.with_all(times, &changes)?;
    Some((changes, turned))
}

/// Returns true if no motion to joints separates two groups.
fn is_neighbour(search: &ChangeSearch<'_>, first: &ElbowGroup, second: &ElbowGroup) -> bool {
    let between = first.last().index() + 1..second.first().index();
    !search.version.program.motions[between].iter().any(|entry| matches!(entry, Motion::Ptp(_)))
}

/// Change of the cycle time by turns, in s; infinite if they are not possible.
fn more_s_by(
    search: &ChangeSearch<'_>,
    times: &mut CycleTimes<'_>,
    turns: &[&Change],
    is_checked: bool,
) -> f64 {
    let Some((program, cycle_time_s)) = times.changed(search.version, turns) else {
        return f64::INFINITY;
    };
    if is_checked && !search.allows(times, &program) {
        return f64::INFINITY;
    }
    cycle_time_s - search.version.cycle_time_s
}

/// Returns the turn of each group with which the sum of all changes is smallest.
fn fastest(alone: &[Alone], pairs: &[Together]) -> Vec<usize> {
    let Some(mut sums) = alone.first().copied() else { return Vec::new() };
    let mut before: Vec<[usize; TURNS_DEG.len()]> = Vec::new();
    for (alone, together) in alone[1..].iter().zip(pairs) {
        let mut best_before = [0; TURNS_DEG.len()];
        let mut next = *alone;
        for (turn, sum) in next.iter_mut().enumerate() {
            let with = |earlier: &usize| sums[*earlier] + together[*earlier][turn];
            let best = (0..TURNS_DEG.len()).min_by(|a, b| with(a).total_cmp(&with(b)));
            best_before[turn] = best.unwrap_or(0);
            *sum += with(&best_before[turn]);
        }
        sums = next;
        before.push(best_before);
    }
    let last = (0..TURNS_DEG.len()).min_by(|a, b| sums[*a].total_cmp(&sums[*b]));
    let mut chosen = vec![last.unwrap_or(0)];
    for best_before in before.iter().rev() {
        chosen.push(best_before[chosen[chosen.len() - 1]]);
    }
    chosen.reverse();
    chosen
}
