//! A cell of a mesh.

use iiwa_program::{ByKind, LimitKind};

use crate::{geometry::Geometry, limited_segment::LimitedSegment, peaks::SHARES};

/// An interval of a segment's sigma on which x is a cubic.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Cell {
    /// Which segment it belongs to.
    pub segment: usize,
    /// sigma within the segment at its start, in rad.
    pub from: f64,
    /// Its length, in rad.
    pub length: f64,
    /// x = (dsigma/dt)^2 of the acceleration-limited stamps at its start.
    pub(crate) x: f64,
    /// The share of the segment's limits of jerk that holds in it.
    pub(crate) jerk_rel: f64,
}

impl Cell {
    /// Shares of the limits that hold in it, from shares of its segment's.
    #[inline(always)]
    pub(crate) fn shares(&self, mut of: ByKind<f64>) -> ByKind<f64> {
        of[LimitKind::Jerk] /= self.jerk_rel;
        of
    }

    /// The curve at [`SHARES`] of the cell's stretch between two shares of it.
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
