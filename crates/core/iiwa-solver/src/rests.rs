//! Cells that touch rest, in which jerk is constant.

use std::ops::Range;

use crate::{cell::Cell, cell_functions::CellState, limited_segment::LimitedSegment, riccati};

/// A cell that touches rest, described by x at its other end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RestCell {
    pub(crate) length: f64,
    /// The adjacent cell, and its row of x at the common end.
    pub(crate) cell: usize,
    pub(crate) row: CellState,
    /// Largest x at the common end that jerk and further limits allow.
    pub(crate) cap: f64,
    pub(crate) slack: ScalarSlackPair,
}

/// The cells that touch rest.
pub(crate) struct Rests {
    /// `None` if the section starts at `entry`.
    pub(crate) from: Option<RestCell>,
    /// `None` if the section ends at `exit`.
    pub(crate) to: Option<RestCell>,
}

impl Rests {
    pub(crate) fn iter(&self) -> impl Iterator<Item = &RestCell> {
        self.from.iter().chain(&self.to)
    }

    /// Rests adjacent to one of `cells`.
    pub(crate) fn within(&self, cells: &Range<usize>) -> impl Iterator<Item = &RestCell> {
        self.iter().filter(|rest| cells.contains(&rest.cell))
    }

    pub(crate) fn within_mut(
        &mut self,
        cells: &Range<usize>,
    ) -> impl Iterator<Item = &mut RestCell> {
        let rests = self.from.iter_mut().chain(&mut self.to);
        rests.filter(|rest| cells.contains(&rest.cell))
    }
}

/// Slack and dual of a limit, and their steps.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ScalarSlackPair {
    pub(crate) s: f64,
    pub(crate) z: f64,
    pub(crate) ds: f64,
    pub(crate) dz: f64,
}

impl RestCell {
    /// Creates the rest at `s` of its segment: at the start or at the end.
    pub(crate) fn new(
        rest: &Cell,
        segment: &LimitedSegment<'_>,
        s: f64,
        cell: usize,
        row: CellState,
    ) -> Self {
        let [_, _, jerk] = segment.straight(s);
        let length = rest.length;
        // sigma = j t^3 / 6 and x = (j t^2 / 2)^2, so that the acceleration j t is two thirds of x
        // / sigma.
        let u = 2.0 / (3.0 * length);
        let by_rows = if s == 0.0 {
            segment.row_cap(rest.from + length, u)
        } else {
            segment.row_cap(rest.from, -u)
        };
        let cap = (4.5 * length * length * jerk).powf(2.0 / 3.0).min(by_rows);
        Self { length, cell, row, cap, slack: ScalarSlackPair::default() }
    }

    /// x at the common end with the adjacent cell.
    pub(crate) fn x(&self, states: &[CellState]) -> f64 {
        riccati::dot(&self.row, &states[self.cell])
    }

    /// Time from rest to the common end, or from there to rest, in s.
    pub(crate) fn duration_s(&self, states: &[CellState]) -> f64 {
        // The integral of x^(-1/2) with x = c sigma^(4/3).
        3.0 * self.length / self.x(states).sqrt()
    }
}
