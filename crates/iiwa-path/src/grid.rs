//! Grids over a segment, with the polynomials of blends evaluated once for all blends.

use std::{
    f64::consts::TAU,
    sync::{Arc, Mutex, OnceLock, PoisonError},
};

use crate::{
    continuity::{Basis, Continuity},
    sigma::by_sigma,
};

/// A grid of N intervals over [0, 1], uniform in s, except on polynomial blends, where it is finer at both ends.
#[derive(Debug)]
pub struct Grid {
    intervals: usize,
    blends: Arc<BlendTables>,
}

/// The polynomials of blends at the nodes of a grid, of each order of continuity.
type BlendTables = [OnceLock<BlendTable>; 3];

/// Those of the grids that were asked for last: they depend on the number of intervals alone, and take as long to make as
/// the stamps of some motions.
static RECENT: Mutex<Vec<(usize, Arc<BlendTables>)>> = Mutex::new(Vec::new());

/// How many of them are kept.
const KEPT: usize = 4;

/// A node of a grid over one segment, in p: its share of the segment's sigma, 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GridNode {
    /// Share of sigma, 0 to 1.
    pub p: f64,
    /// Distance to the next node in p; of the last node, 1.
    pub step: f64,
    /// ds/dp.
    pub slope: f64,
    /// d2s/dp2.
    pub bend: f64,
}

/// By which share the intervals at a blend's ends are shorter in s than their mean, and those in the middle longer.
const ENDS: f64 = 0.4;

/// What all blends of one order of continuity share.
#[derive(Debug)]
pub(crate) struct BlendTable {
    pub(crate) nodes: Vec<GridNode>,
    /// First and second derivative by p of `s alpha` and of `beta`.
    pub(crate) derivatives: Vec<[[f64; 2]; 2]>,
}

impl Grid {
    /// A grid of `intervals` intervals, at least one, and one node more.
    #[must_use]
    pub fn new(intervals: usize) -> Self {
        let intervals = intervals.max(1);
        let mut recent = RECENT.lock().unwrap_or_else(PoisonError::into_inner);
        let found = recent.iter().find(|(own, _)| *own == intervals);
        let blends = found.map_or_else(Default::default, |(_, blends)| Arc::clone(blends));
        if found.is_none() {
            if recent.len() == KEPT {
                recent.remove(0);
            }
            recent.push((intervals, Arc::clone(&blends)));
        }
        Self { intervals, blends }
    }

    /// The number of intervals.
    #[must_use]
    pub fn intervals(&self) -> usize {
        self.intervals
    }

    /// s at each node of so many even intervals.
    pub(crate) fn even(intervals: usize) -> impl Iterator<Item = f64> {
        (0..=intervals).map(move |i| i as f64 / intervals as f64)
    }

    /// s at each node of a polynomial blend.
    ///
    /// Between nodes, a sweep's error goes with the square of an interval's length times the third derivative
    /// of the path's direction by p, and that is largest within a tenth of s from either end, whatever the blend's kappa.
    fn blend_s(&self) -> impl Iterator<Item = f64> + use<> {
        Self::even(self.intervals).map(|t| t - ENDS * (TAU * t).sin() / TAU)
    }

    /// The nodes at `s` over a segment whose sigma is `sigma`, from the values and derivatives at each node.
    pub(crate) fn nodes(
        s: impl Iterator<Item = f64>,
        sigma: impl Fn(f64) -> [f64; 4],
    ) -> Vec<GridNode> {
        let [end, ..] = sigma(1.0);
        let mut nodes: Vec<_> = s
            .map(|s| {
                let at = sigma(s);
                let [slope, bend, _] = by_sigma(at, 1.0);
                GridNode { p: at[0] / end, step: 1.0, slope: slope * end, bend: bend * end * end }
            })
            .collect();
        for i in 1..nodes.len() {
            nodes[i - 1].step = nodes[i].p - nodes[i - 1].p;
        }
        nodes
    }

    pub(crate) fn blend(&self, continuity: Continuity) -> &BlendTable {
        self.blends[continuity as usize].get_or_init(|| {
            let along = |s| Basis::at(continuity, s).along;
            let nodes = Self::nodes(self.blend_s(), along);
            let by_p = |node: &GridNode, [_, one, two, _]: [f64; 4]| {
                [one * node.slope, two * node.slope * node.slope + one * node.bend]
            };
            let derivatives = self.blend_s().zip(&nodes).map(|(s, node)| {
                let Basis { across, bulge, .. } = Basis::at(continuity, s);
                [by_p(node, across), by_p(node, bulge)]
            });
            BlendTable { derivatives: derivatives.collect(), nodes }
        })
    }
}
