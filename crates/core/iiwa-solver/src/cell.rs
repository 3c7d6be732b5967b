//! Cells of a mesh, and the rows of further limits in them.

use iiwa_program::{ByKind, LimitKind};

use crate::{
    geometry::Geometry, limited_segment::LimitedSegment, peaks::SHARES, row_limit::PathRow,
};

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

/// Rows in the cells of segments with further limits.
#[derive(Clone, Debug, Default)]
pub(crate) struct CellRows {
    /// Rows at the start and in the middle of each cell, and at the end of the last cell of a
    /// segment.
    rows: Vec<PathRow>,
    /// `true` for each row of each cell that can come near its limit there.
    near: Vec<bool>,
    /// Location of the rows of each cell; empty if no segment has further limits.
    cells: Vec<RowsOfCell>,
}

/// Location of the rows of a cell.
#[derive(Clone, Copy, Debug)]
struct RowsOfCell {
    /// Number of rows at a place.
    count: usize,
    /// Index of the first row at the start of the cell.
    first: usize,
    /// Index of the mark of the first row in `near`.
    near: usize,
}

impl CellRows {
    /// Computes the rows in `cells`, whose curves are `geometry`.
    pub(crate) fn new(
        segments: &[LimitedSegment<'_>],
        cells: &[Cell],
        geometry: &[Geometry],
    ) -> Self {
        let mut all = Self::default();
        if segments.iter().all(|segment| !segment.has_rows()) {
            return all;
        }
        for cells in cells.chunk_by(|a, b| a.segment == b.segment) {
            let segment = &segments[cells[0].segment];
            let geometry = &geometry[all.cells.len()..];
            // The end of a cell is the start of the next one.
            let sigma = |cell: &Cell| [cell.from, cell.from + 0.5 * cell.length];
            let last = cells.last().map(|cell| cell.from + cell.length);
            let sigma: Vec<_> = cells.iter().flat_map(sigma).chain(last).collect();
            let (before, count) = (all.rows.len(), segment.row_count());
            all.rows.extend(segment.rows(&sigma));
            for (k, geometry) in (0..cells.len()).zip(geometry) {
                let cell =
                    RowsOfCell { count, first: before + 2 * k * count, near: all.near.len() };
                all.near.resize(cell.near + count, false);
                // Indices of the start, the middle and the end among the places of a geometry.
                for (rows, place) in cell.places(&all.rows).into_iter().zip([0, 3, 6]) {
                    let derivatives = segment.derivatives_at(geometry, place);
                    let near = &mut all.near[cell.near..];
                    segment.mark_near(&derivatives, rows, near);
                }
                all.cells.push(cell);
            }
        }
        all
    }

    /// Rows at the start, in the middle and at the end of a cell.
    pub(crate) fn of(&self, cell: usize) -> [&[PathRow]; 3] {
        self.cells.get(cell).map_or_else(Default::default, |cell| cell.places(&self.rows))
    }

    /// Marks of the rows that can come near their limit in a cell.
    pub(crate) fn near(&self, cell: usize) -> &[bool] {
        let marks = |cell: &RowsOfCell| &self.near[cell.near..cell.near + cell.count];
        self.cells.get(cell).map_or(&[], marks)
    }
}

impl RowsOfCell {
    fn places<'a>(&self, rows: &'a [PathRow]) -> [&'a [PathRow]; 3] {
        let Self { count, first, .. } = *self;
        [0, 1, 2].map(|place| &rows[first + place * count..first + (place + 1) * count])
    }
}

/// Parabola through three values in a cell, as a function of its share: the coefficients change
/// little along a cell.
pub(crate) struct Parabola {
    start: f64,
    slope: f64,
    bend: f64,
}

impl Parabola {
    /// Returns the parabola through the values at the start, in the middle and at the end.
    #[inline(always)]
    pub(crate) fn through([start, middle, end]: [f64; 3]) -> Self {
        Self {
            start,
            slope: 4.0 * middle - 3.0 * start - end,
            bend: 2.0 * (start - 2.0 * middle + end),
        }
    }

    /// Value at the share `f` of the cell.
    #[inline(always)]
    pub(crate) fn at(&self, f: f64) -> f64 {
        self.start + f * (self.slope + f * self.bend)
    }
}

/// Parabolas through the coefficients of a row.
pub(crate) struct RowParabolas {
    pub(crate) acceleration: Parabola,
    pub(crate) square: Parabola,
    pub(crate) offset: Parabola,
}

impl RowParabolas {
    /// Returns the parabolas of the row `j` from the rows at the start, in the middle and at the
    /// end of a cell.
    #[inline(always)]
    pub(crate) fn new(places: &[&[PathRow]; 3], j: usize) -> Self {
        let rows = places.map(|rows| rows[j]);
        Self {
            acceleration: Parabola::through(rows.map(|row| row.acceleration)),
            square: Parabola::through(rows.map(|row| row.square)),
            offset: Parabola::through(rows.map(|row| row.offset)),
        }
    }

    /// The row at the share `f` of the cell.
    pub(crate) fn at(&self, f: f64) -> PathRow {
        PathRow {
            acceleration: self.acceleration.at(f),
            square: self.square.at(f),
            offset: self.offset.at(f),
        }
    }
}
