//! A cell of a mesh.

use iiwa_program::{ByKind, LimitKind};

use crate::{geometry::Geometry, limited_segment::LimitedSegment, peaks::SHARES};

/// An interval of a segment's sigma on which x is a cubic.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Cell {
    /// Index of the segment that contains the cell.
    pub segment: usize,
    /// sigma at the start of the cell, from the start of the segment, in rad.
    pub from: f64,
    /// Length, in rad.
    pub length: f64,
    /// x = (dsigma/dt)^2 of the acceleration-limited stamps at the start of the cell.
    pub(crate) x: f64,
    /// Share of the jerk limits of the segment that applies in the cell.
    pub(crate) jerk_rel: f64,
}

impl Cell {
    /// Converts shares of the limits of the segment into shares of those of the cell.
    #[inline(always)]
    pub(crate) fn shares(&self, mut shares: ByKind<f64>) -> ByKind<f64> {
        shares[LimitKind::Jerk] /= self.jerk_rel;
        shares
    }

    /// The curve at [`SHARES`] of the stretch between two shares of the cell.
    #[inline(always)]
    pub(crate) fn geometry(
        &self,
        segments: &[LimitedSegment<'_>],
        [from, to]: [f64; 2],
    ) -> Geometry {
        let share = |f: f64| from + f * (to - from);
        segments[self.segment].geometry(&SHARES.map(|f| self.from + share(f) * self.length))
    }
}
