//! Nodes of a segment for the sweep, and the derivatives of the path there.
//!
//! The polynomials of blends are evaluated once for all blends.

use std::{
    borrow::Cow,
    f64::consts::TAU,
    sync::{Arc, Mutex, OnceLock, PoisonError},
};

use iiwa_kin::Joints;
use iiwa_path::{BlendBasis, BlendPolynomials, Continuity, PlanarGraph, Segment, ToolCoordinate};
use pulp::Simd;

/// Grid of N intervals over [0, 1], uniform in s, except on polynomial blends, where it is finer at
/// both ends. Curves of many pieces have more intervals than N.
#[derive(Debug)]
pub(crate) struct Grid {
    intervals: usize,
    blends: Arc<BlendTables>,
}

/// Polynomials of blends at the nodes of a grid, for each order of continuity.
type BlendTables = [OnceLock<BlendTable>; 3];

/// Tables of the most recent grids: they depend only on the number of intervals, and computing them
/// takes as long as the stamps of some motions.
static RECENT: Mutex<Vec<(usize, Arc<BlendTables>)>> = Mutex::new(Vec::new());

/// Number of tables that are kept.
const KEPT: usize = 4;

/// Node of a grid over one segment, in p, the share of the segment's sigma, 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct GridNode {
    /// Share of sigma, 0 to 1.
    pub(crate) p: f64,
    /// Distance to the next node in p; 1 at the last node.
    pub(crate) step: f64,
    /// ds/dp.
    pub(crate) slope: f64,
    /// d2s/dp2.
    pub(crate) bend: f64,
}

/// Share by which the intervals at a blend's ends are shorter in s than their mean, and those in
/// the middle longer.
const ENDS: f64 = 0.4;

/// Pieces of a curve per N intervals, and the bounds of the resulting factor of N.
const PIECES_A_GRID: usize = 4;
const MIN_GRIDS: usize = 2;
const MAX_GRIDS: usize = 8;

/// Minimum number of intervals of a curve of pieces, for any N: the jerk-limited solver starts from
/// the acceleration-limited stamps, and does not always converge from coarser ones.
const MIN_INTERVALS: usize = 200;

/// Minimum number of intervals of a curve with uneven TCP motion or rotation: between nodes, its
/// acceleration is not that of a cubic.
const MIN_INTERVALS_UNEVEN: usize = 300;

/// Nodes and polynomials of all blends of one order of continuity.
#[derive(Debug)]
struct BlendTable {
    nodes: Vec<GridNode>,
    /// First and second derivative of `s alpha` and of `beta` with respect to p.
    derivatives: Vec<[[f64; 2]; 2]>,
}

impl Grid {
    /// Creates a grid of `intervals` intervals, at least one, with one node more.
    #[must_use]
    pub(crate) fn new(intervals: usize) -> Self {
        let intervals = intervals.max(1);
        let mut recent = RECENT.lock().unwrap_or_else(PoisonError::into_inner);
        let cached = recent.iter().find(|(count, _)| *count == intervals);
        let blends = cached.map_or_else(Default::default, |(_, blends)| Arc::clone(blends));
        if cached.is_none() {
            if recent.len() == KEPT {
                // The oldest. Grids in use keep their tables.
                recent.remove(0);
            }
            recent.push((intervals, Arc::clone(&blends)));
        }
        Self { intervals, blends }
    }

    /// Returns the number of intervals.
    #[must_use]
    pub(crate) fn intervals(&self) -> usize {
        self.intervals
    }

    /// Returns the number of intervals on a segment; on a curve of pieces it grows with the number
    /// of pieces.
    pub(crate) fn intervals_on(&self, segment: &dyn Segment) -> usize {
        if let Some(inner) = segment.unsupervised() {
            // The flange speed changes along any segment.
            return self.intervals_on(inner.as_ref()).max(MIN_INTERVALS);
        }
        let [_, .., _] = segment.breaks() else { return self.intervals };
        let pieces = segment.breaks().len() - 1;
        let factor = pieces.div_ceil(PIECES_A_GRID).clamp(MIN_GRIDS, MAX_GRIDS);
        let min_intervals =
            if segment.has_even_tool_way() { MIN_INTERVALS } else { MIN_INTERVALS_UNEVEN };
        (self.intervals * factor).max(min_intervals)
    }

    /// Returns s at the nodes on a segment, from 0 to 1. On a curve of pieces, the density of nodes
    /// is half uniform and half that of the pieces: pieces are short where joints turn fast.
    pub(crate) fn s_on(&self, segment: &dyn Segment) -> Vec<f64> {
        let intervals = self.intervals_on(segment);
        if let Some(inner) = segment.unsupervised() {
            let nodes = self.s_on(inner.as_ref());
            return if nodes.len() > intervals { nodes } else { even(intervals).collect() };
        }
        let breaks @ [_, .., _] = segment.breaks() else { return even(intervals).collect() };
        let pieces = breaks.len() - 1;
        let mut index = 0;
        // Increases from 0 to 1 over the breaks.
        let at_break = |index: usize| 0.5 * (breaks[index] + index as f64 / pieces as f64);
        even(intervals)
            .map(|share| {
                while index + 1 < pieces && at_break(index + 1) <= share {
                    index += 1;
                }
                let [from, to] = [index, index + 1].map(at_break);
                let [start, end] = [breaks[index], breaks[index + 1]];
                (start + (share - from) / (to - from) * (end - start)).clamp(0.0, 1.0)
            })
            .collect()
    }

    /// Returns the nodes on a segment.
    pub(crate) fn nodes_on(&self, segment: &dyn Segment) -> Cow<'_, [GridNode]> {
        match segment.as_planar_graph().and_then(PlanarGraph::polynomials) {
            Some(blend) => Cow::Borrowed(&self.blend(blend.continuity).nodes),
            None => Cow::Owned(nodes(self.s_on(segment).into_iter(), |s| segment.sigma(s))),
        }
    }

    /// Sets the first and second derivatives of the joints with respect to p at every node on a
    /// segment, each joint times its `scale`.
    ///
    /// The eighth element of each row is zero: rows of eight fill vector registers.
    ///
    /// # Panics
    ///
    /// If `dq` or `ddq` has fewer rows than the segment has nodes.
    pub(crate) fn derivatives_on(
        &self,
        segment: &dyn Segment,
        scale: &Joints,
        dq: &mut [[f64; 8]],
        ddq: &mut [[f64; 8]],
    ) {
        if let Some(blend) = segment.as_planar_graph().and_then(PlanarGraph::polynomials) {
            let table = self.blend(blend.continuity);
            pulp::Arch::new().dispatch(BlendDerivatives { blend, table, scale, dq, ddq });
            return;
        }
        let s = self.s_on(segment);
        let nodes = self.nodes_on(segment);
        let rows = ..nodes.len();
        for ((s, node), (dq, ddq)) in
            std::iter::zip(s, nodes.iter()).zip(dq[rows].iter_mut().zip(&mut ddq[rows]))
        {
            let GridNode { slope, bend, .. } = *node;
            let derivatives = segment.at(s);
            for j in 0..7 {
                dq[j] = derivatives.dq[j] * slope * scale[j];
                ddq[j] = (derivatives.ddq[j] * slope * slope + derivatives.dq[j] * bend) * scale[j];
            }
            (dq[7], ddq[7]) = (0.0, 0.0);
        }
    }

    fn blend(&self, continuity: Continuity) -> &BlendTable {
        self.blends[continuity as usize].get_or_init(|| {
            let along = |s| BlendBasis::at(continuity, s).along;
            let nodes = nodes(self.blend_s(), along);
            let by_p = |node: &GridNode, [_, one, two, _]: [f64; 4]| {
                [one * node.slope, two * node.slope * node.slope + one * node.bend]
            };
            let derivatives = self.blend_s().zip(&nodes).map(|(s, node)| {
                let BlendBasis { across, bulge, .. } = BlendBasis::at(continuity, s);
                [by_p(node, across), by_p(node, bulge)]
            });
            BlendTable { derivatives: derivatives.collect(), nodes }
        })
    }

    /// Returns s at each node of a polynomial blend.
    ///
    /// Between nodes, the error of a sweep is proportional to the squared interval length times the
    /// third derivative of the path's direction with respect to p, which is largest within a tenth
    /// of s from either end, for any kappa.
    fn blend_s(&self) -> impl Iterator<Item = f64> + use<> {
        even(self.intervals).map(|t| t - ENDS * (TAU * t).sin() / TAU)
    }
}

/// Returns s at the nodes of `intervals` uniform intervals.
fn even(intervals: usize) -> impl Iterator<Item = f64> {
    (0..=intervals).map(move |i| i as f64 / intervals as f64)
}

/// Returns the nodes at `s` over a segment, from the values and derivatives of `sigma` at each
/// node.
fn nodes(s: impl Iterator<Item = f64>, sigma: impl Fn(f64) -> [f64; 4]) -> Vec<GridNode> {
    let [end, ..] = sigma(1.0);
    let mut nodes: Vec<_> = s
        .map(|s| {
            let [value, one, two, _] = sigma(s);
            let slope = 1.0 / one;
            let bend = -two * slope * slope / one;
            GridNode { p: value / end, step: 1.0, slope: slope * end, bend: bend * end * end }
        })
        .collect();
    for i in 1..nodes.len() {
        nodes[i - 1].step = nodes[i].p - nodes[i - 1].p;
    }
    nodes
}

/// Returns the first and second derivative of the tool coordinate with respect to p, at `s` of a
/// segment with the grid node `node` there.
pub(crate) fn tool_derivatives(
    tool: &ToolCoordinate,
    segment: &dyn Segment,
    s: f64,
    node: &GridNode,
) -> [f64; 2] {
    let [dw, ddw, _] = tool.derivatives(segment, s);
    [dw * node.slope, ddw * node.slope * node.slope + dw * node.bend]
}

/// Derivatives of a polynomial blend at the nodes of a grid, with the widest vector instructions of
/// the machine. The grid holds the polynomials: this costs three multiplications per joint.
///
/// A struct and not a closure: `pulp` calls closures through a shim that is not inlined into the
/// function with vector instructions, so they would be compiled without these.
struct BlendDerivatives<'a> {
    blend: BlendPolynomials,
    table: &'a BlendTable,
    scale: &'a Joints,
    dq: &'a mut [[f64; 8]],
    ddq: &'a mut [[f64; 8]],
}

impl pulp::WithSimd for BlendDerivatives<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let BlendDerivatives { blend, table, scale, dq, ddq } = self;
        // The range of sigma is 0 to 2 d0.
        let mut along = [0.0; 8];
        let mut turn = [0.0; 8];
        for j in 0..7 {
            along[j] = 2.0 * blend.arrival_rad[j] * scale[j];
            turn[j] = blend.turn_rad[j] * scale[j];
        }
        let table = &table.derivatives;
        let rows = ..table.len();
        for (([across, bulge], dq), ddq) in table.iter().zip(&mut dq[rows]).zip(&mut ddq[rows]) {
            let first = across[0] - blend.kappa * bulge[0];
            let second = across[1] - blend.kappa * bulge[1];
            for j in 0..8 {
                dq[j] = along[j] + first * turn[j];
                ddq[j] = second * turn[j];
            }
        }
    }
}
