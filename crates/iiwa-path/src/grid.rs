//! Uniform grids over s, with the polynomials of blends evaluated once for all blends.

use std::sync::OnceLock;

use crate::continuity::{Basis, Continuity};

/// A uniform grid of N intervals over s in [0, 1].
#[derive(Debug)]
pub struct Grid {
    intervals: usize,
    basis: [OnceLock<Vec<Basis>>; 3],
}

impl Grid {
    /// A grid of `intervals` intervals, at least one, and one node more.
    #[must_use]
    pub fn new(intervals: usize) -> Self {
        Self { intervals: intervals.max(1), basis: Default::default() }
    }

    /// The number of intervals.
    #[must_use]
    pub fn intervals(&self) -> usize {
        self.intervals
    }

    pub(crate) fn basis(&self, continuity: Continuity) -> &[Basis] {
        let n = self.intervals as f64;
        self.basis[continuity as usize].get_or_init(|| {
            (0..=self.intervals).map(|i| Basis::at(continuity, i as f64 / n)).collect()
        })
    }
}
