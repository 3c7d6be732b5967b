//! What the torques in the cells of a mesh are made of.

use iiwa_kin::PathTorques;

use crate::{cell::Cell, geometry::Geometry, limited_segment::LimitedSegment};

/// The torques in the cells of segments that have limits of them, as shares of these.
#[derive(Clone, Debug, Default)]
pub(crate) struct CellTorques {
    limited: Vec<TorqueCell>,
    /// For each cell its place among them; none at all if no segment has limits.
    of_cell: Vec<Option<usize>>,
}

/// The torques in a cell.
#[derive(Clone, Debug)]
struct TorqueCell {
    /// At its start, in its middle and at its end.
    places: [PathTorques; 3],
    /// The joints that can come near to their limits in it.
    near: [bool; 7],
}

impl CellTorques {
    /// The torques in `cells`, whose curves are `geometry`.
    pub(crate) fn new(
        segments: &[LimitedSegment<'_>],
        cells: &[Cell],
        geometry: &[Geometry],
    ) -> Self {
        let mut torques = Self::default();
        if segments.iter().all(|segment| !segment.limits_torque()) {
            return torques;
        }
        for cells in cells.chunk_by(|a, b| a.segment == b.segment) {
            let segment = &segments[cells[0].segment];
            let (first, geometry) = (torques.limited.len(), &geometry[torques.of_cell.len()..]);
            // The end of a cell is the start of the next.
            let sigma = |cell: &Cell| [cell.from, cell.from + 0.5 * cell.length];
            let last = cells.last().map(|cell| cell.from + cell.length);
            let sigma: Vec<_> = cells.iter().flat_map(sigma).chain(last).collect();
            let shares = segment.torque_shares(&sigma);
            let places = shares.windows(3).step_by(2).map(|at| [at[0], at[1], at[2]]);
            let limited = places.zip(geometry);
            torques
                .limited
                .extend(limited.map(|(places, own)| TorqueCell::new(segment, &places, own)));
            let place = |k| (!shares.is_empty()).then_some(first + k);
            torques.of_cell.extend((0..cells.len()).map(place));
        }
        torques
    }

    fn limited(&self, cell: usize) -> Option<&TorqueCell> {
        self.of_cell.get(cell).copied().flatten().map(|place| &self.limited[place])
    }

    /// Those at the start, in the middle and at the end of a cell, if it has limits.
    pub(crate) fn of(&self, cell: usize) -> Option<&[PathTorques; 3]> {
        self.limited(cell).map(|limited| &limited.places)
    }

    /// The joints that can come near to their limits in a cell: none if it has no limits.
    pub(crate) fn near(&self, cell: usize) -> [bool; 7] {
        self.limited(cell).map_or([false; 7], |limited| limited.near)
    }
}

impl TorqueCell {
    fn new(segment: &LimitedSegment<'_>, places: &[PathTorques; 3], geometry: &Geometry) -> Self {
        // The start, the middle and the end among the places of a geometry.
        let near = [(0, &places[0]), (3, &places[1]), (6, &places[2])].map(|(place, shares)| {
            segment.near_torque_limits(&segment.derivatives_at(geometry, place), shares)
        });
        let near = std::array::from_fn(|j| near.iter().any(|near| near[j]));
        Self { places: *places, near }
    }
}

/// The parabola through three values in a cell, by its share: a cell is short against the way on which the arm's inertia
/// changes.
pub(crate) struct Parabola {
    start: f64,
    slope: f64,
    bend: f64,
}

impl Parabola {
    /// Through what `of` is at the start, in the middle and at the end.
    #[inline(always)]
    pub(crate) fn through(
        [start, middle, end]: &[PathTorques; 3],
        of: impl Fn(&PathTorques) -> f64,
    ) -> Self {
        let (start, middle, end) = (of(start), of(middle), of(end));
        Self {
            start,
            slope: 4.0 * middle - 3.0 * start - end,
            bend: 2.0 * (start - 2.0 * middle + end),
        }
    }

    /// Its value at the share `f` of the cell.
    #[inline(always)]
    pub(crate) fn at(&self, f: f64) -> f64 {
        self.start + f * (self.slope + f * self.bend)
    }
}

/// The torques at the share `f` of a cell, from those at its start, in its middle and at its end.
pub(crate) fn interpolated(places: &[PathTorques; 3], f: f64) -> PathTorques {
    PathTorques {
        acceleration: std::array::from_fn(|j| {
            Parabola::through(places, |at| at.acceleration[j]).at(f)
        }),
        speed: std::array::from_fn(|j| Parabola::through(places, |at| at.speed[j]).at(f)),
        gravity: std::array::from_fn(|j| Parabola::through(places, |at| at.gravity[j]).at(f)),
    }
}
