//! Fastest elbow angles of all groups together, and a lower bound of the cycle time.
//!
//! The elbow angles of a group are the nodes of a rung of a ladder graph, and the ways from one
//! group to the next its edges: the fastest program is a shortest path. An edge is planned only if
//! it may belong to a faster program than the fastest known one; until then, its time is a lower
//! bound. The shortest path with these times is a lower bound of the cycle time.

use std::ops::RangeInclusive;

use rayon::prelude::*;

use crate::{
    change::Change,
    change_search::ChangeSearch,
    cycle_time::{CycleTimes, Version},
    gap_bound::GapBound,
    results::LowerBound,
    stages::{Stages, TurnedGroup},
};

/// Steps between the elbow angles that are tried, in degrees: the finest one with which the ladder
/// is not too large.
const STEPS_DEG: [i16; 4] = [1, 2, 5, 10];

/// Largest number of edges.
const MOST_EDGES: usize = 5_000_000;

/// Number of edges that are planned at first; then it doubles.
const FIRST_EDGES: usize = 1000;

/// Largest number of nodes and edges that are planned, as a multiple of the budget of plans: most
/// edges are single motions.
const EDGES_PER_PLAN: u64 = 5;

/// Difference between times that counts as none, in s.
const EQUAL_S: f64 = 1e-6;

/// The fastest elbow angles.
pub(crate) struct FastestElbows {
    /// The turns, and the version with them; `None` if no turns save a millisecond.
    pub(crate) turned: Option<(Vec<Change>, Version)>,
    pub(crate) lower_bound: LowerBound,
    /// `false` if other turns in steps of a degree may be faster.
    pub(crate) is_proven: bool,
}

/// Rungs and edges of the search.
struct Ladder<'a> {
    stages: &'a Stages<'a>,
    search: &'a ChangeSearch<'a>,
    rungs: Vec<Vec<TurnedGroup>>,
    gaps: Vec<Edges>,
}

/// Edges between two rungs. The start and the end of the program are rungs of one node.
struct Edges {
    /// Times of the edges from the first node before the gap, then from the second, in s.
    times_s: Vec<f64>,
    /// `true` where the time is planned, not a bound.
    is_planned: Vec<bool>,
    /// Number of nodes after the gap.
    after: usize,
}

impl Edges {
    /// Nodes before and after the gap that an edge connects.
    fn ends(&self, edge: usize) -> [usize; 2] {
        [edge / self.after, edge % self.after]
    }
}

/// An edge of a gap, and the bound of the cycle time with it.
struct OpenEdge {
    bound_s: f64,
    gap: usize,
    edge: usize,
}

/// Searches for the fastest elbow angles, with a budget of plans; `None` if the program does not
/// divide into stages.
pub(crate) fn fastest_elbows(
    search: &ChangeSearch<'_>,
    times: &mut CycleTimes<'_>,
    budget: u64,
) -> Option<FastestElbows> {
    let stages = Stages::new(&search.version.program)?;
    let mut budget = usize::try_from(EDGES_PER_PLAN.saturating_mul(budget)).unwrap_or(usize::MAX);
    let (mut ladder, step_deg) = Ladder::new(&stages, search, &mut budget)?;
    let mut fastest_s = search.version.cycle_time_s;
    let mut turns_deg = None;
    let mut count = FIRST_EDGES;
    let (cycle_time_s, is_proven) = loop {
        let to_nodes = ladder.times_to_nodes(false);
        let mut open = ladder.open_edges(&to_nodes, fastest_s - EQUAL_S);
        if open.is_empty() || budget == 0 || search.is_interrupted() {
            let [bound_s] = to_nodes.last()?[..] else { return None };
            break (bound_s.min(fastest_s), open.is_empty() && step_deg == 1);
        }
        let planned = count.min(budget);
        if open.len() > planned {
            open.select_nth_unstable_by(planned, |a, b| a.bound_s.total_cmp(&b.bound_s));
            open.truncate(planned);
        }
        ladder.plan(&open);
        budget -= open.len();
        count *= 2;
        let to_nodes = ladder.times_to_nodes(true);
        let [planned_s] = to_nodes.last()?[..] else { return None };
        if planned_s < fastest_s - EQUAL_S {
            fastest_s = planned_s;
            turns_deg = Some(ladder.turns_to_end(&to_nodes));
        }
    };
    let turned = turns_deg.and_then(|turns_deg| {
        let turns = turns_deg.into_iter().enumerate().filter(|(_, by_deg)| *by_deg != 0);
        let turns = turns.map(|(stage, by_deg)| stages.turn(stage, by_deg)).collect();
        search.with_needed(times, turns)
    });
    Some(FastestElbows { turned, lower_bound: LowerBound { cycle_time_s, step_deg }, is_proven })
}

impl<'a> Ladder<'a> {
    /// Creates the ladder, and returns the step between its elbow angles, in degrees. `None` if it
    /// has more nodes than `budget`, which is reduced by their number.
    fn new(
        stages: &'a Stages<'a>,
        search: &'a ChangeSearch<'a>,
        budget: &mut usize,
    ) -> Option<(Self, i16)> {
        let robot = &search.settings.robot;
        let ranges: Vec<_> =
            (0..stages.count()).map(|stage| stages.range_deg(stage, robot)).collect();
        // No turn is one of the turns.
        let turns = |range: &RangeInclusive<i16>, step_deg: i16| {
            range.clone().filter(move |by_deg| by_deg % step_deg == 0)
        };
        let counts = |step_deg: i16| -> Vec<usize> {
            ranges.iter().map(|range| turns(range, step_deg).count()).collect()
        };
        let edges = |step_deg: i16| -> usize {
            counts(step_deg).windows(2).map(|pair| pair[0] * pair[1]).sum()
        };
        let step_deg = STEPS_DEG.into_iter().find(|step_deg| edges(*step_deg) <= MOST_EDGES)?;
        *budget = budget.checked_sub(counts(step_deg).iter().sum())?;
        let rungs = ranges.iter().enumerate().map(|(stage, range)| {
            let turns: Vec<i16> = turns(range, step_deg).collect();
            let turned = turns.into_par_iter().map_init(
                || search.cycle_times(),
                |times, by_deg| {
                    let is_needed = !search.is_interrupted();
                    is_needed.then(|| stages.turned(times, stage, by_deg)).flatten()
                },
            );
            turned.flatten().collect()
        });
        let mut ladder = Self { stages, search, rungs: rungs.collect(), gaps: Vec::new() };
        let mut times = search.cycle_times();
        ladder.gaps =
            (0..=stages.count()).map(|gap| ladder.edges(&mut times, gap)).collect::<Option<_>>()?;
        Some((ladder, step_deg))
    }

    /// Returns the edges of a gap, with lower bounds of their times; `None` if the robot cannot
    /// execute the program without turns.
    fn edges(&self, times: &mut CycleTimes<'_>, gap: usize) -> Option<Edges> {
        let [before, after] = self.rungs_around(gap);
        let unturned = |rung: &[Option<&'_ TurnedGroup>]| {
            rung.iter().position(|node| node.is_none_or(|node| node.by_deg == 0))
        };
        let [from, to] = [before[unturned(&before)?], after[unturned(&after)?]];
        let entries = self.stages.gap(gap);
        if entries.is_empty() && to.is_none() {
            let (times_s, is_planned) = (vec![0.0; before.len()], vec![true; before.len()]);
            return Some(Edges { times_s, is_planned, after: 1 });
        }
        let moves = entries.iter().filter(|entry| entry.moves()).count();
        let plan = self.stages.plan_gap(times, gap, from, to)?;
        let bound = GapBound::new(&plan, moves + usize::from(to.is_some()));
        let times_s: Vec<f64> = before
            .iter()
            .flat_map(|from| {
                let from_rad = from.map(|from| &from.ends_rad[1]);
                let time_s = |to: Option<&TurnedGroup>| {
                    let to_rad = to.map(|to| &to.ends_rad[0]);
                    bound.as_ref().map_or(0.0, |bound| bound.time_s(from_rad, to_rad))
                };
                after.iter().copied().map(time_s).collect::<Vec<_>>()
            })
            .collect();
        let is_planned = vec![false; times_s.len()];
        Some(Edges { times_s, is_planned, after: after.len() })
    }

    /// Nodes before and after a gap; `None` for the start and the end of the program.
    fn rungs_around(&self, gap: usize) -> [Vec<Option<&TurnedGroup>>; 2] {
        let rung = |index: Option<usize>| match index.and_then(|index| self.rungs.get(index)) {
            Some(rung) => rung.iter().map(Some).collect(),
            None => vec![None],
        };
        [rung(gap.checked_sub(1)), rung(Some(gap))]
    }

    /// Plans edges.
    fn plan(&mut self, open: &[OpenEdge]) {
        let planned = open.par_iter().map_init(
            || self.search.cycle_times(),
            |times, OpenEdge { gap, edge, .. }| {
                let [before, after] = self.gaps[*gap].ends(*edge);
                let before = gap.checked_sub(1).map(|rung| &self.rungs[rung][before]);
                let after = self.rungs.get(*gap).map(|rung| &rung[after]);
                let plan = self.stages.plan_gap(times, *gap, before, after);
                plan.map_or(f64::INFINITY, |plan| plan.cycle_time_s())
            },
        );
        let planned: Vec<f64> = planned.collect();
        for (OpenEdge { gap, edge, .. }, planned_s) in open.iter().zip(planned) {
            let Edges { times_s, is_planned, .. } = &mut self.gaps[*gap];
            debug_assert!(
                planned_s > times_s[*edge] - EQUAL_S,
                "{planned_s} s, {}",
                times_s[*edge]
            );
            (times_s[*edge], is_planned[*edge]) = (planned_s, true);
        }
    }

    /// Returns the shortest times from the start to the nodes of each rung, the last one the end,
    /// with all edges or with planned ones alone.
    fn times_to_nodes(&self, planned_only: bool) -> Vec<Vec<f64>> {
        let mut all = vec![vec![0.0]];
        for (gap, edges) in self.gaps.iter().enumerate() {
            let mut next = vec![f64::INFINITY; edges.after];
            for (edge, time_s) in edges.times_s.iter().enumerate() {
                if edges.is_planned[edge] || !planned_only {
                    let [from, to] = edges.ends(edge);
                    next[to] = next[to].min(all[gap][from] + time_s);
                }
            }
            for (sum_s, node) in next.iter_mut().zip(self.rungs.get(gap).into_iter().flatten()) {
                *sum_s += node.within_s;
            }
            all.push(next);
        }
        all
    }

    /// Returns the shortest times from the nodes of each rung to the end, the first one the start,
    /// with all edges.
    fn times_from_nodes(&self) -> Vec<Vec<f64>> {
        let mut all = vec![vec![0.0]];
        for (gap, edges) in self.gaps.iter().enumerate().rev() {
            let after = &all[all.len() - 1];
            let rows = edges.times_s.chunks(edges.after);
            let best = rows.map(|row| {
                let sums = row.iter().zip(after).map(|(time_s, rest_s)| time_s + rest_s);
                sums.fold(f64::INFINITY, f64::min)
            });
            let mut before: Vec<f64> = best.collect();
            let nodes = gap.checked_sub(1).and_then(|rung| self.rungs.get(rung));
            for (sum_s, node) in before.iter_mut().zip(nodes.into_iter().flatten()) {
                *sum_s += node.within_s;
            }
            all.push(before);
        }
        all.reverse();
        all
    }

    /// Returns the edges that are not planned and may belong to a program that takes less than
    /// `below_s`.
    fn open_edges(&self, to_nodes: &[Vec<f64>], below_s: f64) -> Vec<OpenEdge> {
        let from_nodes = self.times_from_nodes();
        let mut open = Vec::new();
        for (gap, edges) in self.gaps.iter().enumerate() {
            for (edge, time_s) in edges.times_s.iter().enumerate() {
                let [from, to] = edges.ends(edge);
                let bound_s = to_nodes[gap][from] + time_s + from_nodes[gap + 1][to];
                if !edges.is_planned[edge] && bound_s < below_s {
                    open.push(OpenEdge { bound_s, gap, edge });
                }
            }
        }
        open
    }

    /// Returns the turns on the shortest path of planned edges, in degrees.
    fn turns_to_end(&self, to_nodes: &[Vec<f64>]) -> Vec<i16> {
        let mut turns = Vec::new();
        let mut to = 0;
        for (gap, edges) in self.gaps.iter().enumerate().skip(1).rev() {
            let time_s = |from: &usize| {
                let edge = from * edges.after + to;
                let time_s =
                    if edges.is_planned[edge] { edges.times_s[edge] } else { f64::INFINITY };
                to_nodes[gap][*from] + time_s
            };
            let best = (0..to_nodes[gap].len()).min_by(|a, b| time_s(a).total_cmp(&time_s(b)));
            to = best.unwrap_or(0);
            turns.push(self.rungs[gap - 1][to].by_deg);
        }
        turns.reverse();
        turns
    }
}
