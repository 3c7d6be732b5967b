//! Chain of stages that the Riccati recursion solves, and its cost-to-go.

use std::ops::Range;

use crate::cell_functions::{CellState, Quadratic};

/// The stages and their boundary conditions.
#[derive(Clone)]
pub(crate) struct StageChain<'a> {
    /// Cells that are stages; all others are fixed.
    pub(crate) stages: Range<usize>,
    pub(crate) lengths: &'a [f64],
    /// `true` where W0 and W1 of a cell are free; elsewhere both are zero.
    pub(crate) free: &'a [bool],
    pub(crate) quadratics: &'a [Quadratic],
    pub(crate) states: &'a [CellState],
    /// V over x at the start, if the first stage follows a rest; else both are fixed.
    pub(crate) slope_from_rest: Option<f64>,
    /// Row of the last cell that has to be zero for x to come to rest. Used if that cell is a
    /// stage.
    pub(crate) to_rest: CellState,
}

/// Cost-to-go, a quadratic function of the step of (x, V) at a stage.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CostToGo {
    /// Second derivatives by (x, x), (x, V), (V, V).
    pub(crate) p: [f64; 3],
    /// First derivatives.
    pub(crate) g: [f64; 2],
}

impl CostToGo {
    /// Returns the nearest convex function: rounding can make a cost-to-go indefinite.
    #[inline(always)]
    pub(crate) fn convex([xx, xv, vv]: [f64; 3], g: [f64; 2]) -> Self {
        let is_convex = !(xx < 0.0 || vv < 0.0 || xv * xv > xx * vv);
        Self { p: if is_convex { [xx, xv, vv] } else { convex([xx, xv, vv]) }, g }
    }
}

/// Returns the second derivatives of the nearest convex function.
#[cold]
fn convex([xx, xv, vv]: [f64; 3]) -> [f64; 3] {
    let (xx, vv) = (xx.max(0.0), vv.max(0.0));
    let bound = (xx * vv).sqrt();
    [xx, if xv * xv > xx * vv { bound.copysign(xv) } else { xv }, vv]
}
