//! Limits in blocks of eight cells, and their contributions to a Newton step.
//!
//! In each cell, x = (dsigma/dt)^2 is a cubic polynomial in f, which runs from 0 at the start of
//! the cell to 1 at its end. Its second derivative by f is linear, from W0 to W1:
//! `x(f) = x + V f + W0 (f^2/2 - f^3/6) + W1 f^3/6`,
//! with x and V = dx/df at the start of the cell. The state of a cell is (x, V, W0, W1). Limits
//! apply
//! - to velocity, at three of the four control points of the cubic; the fourth is the first one of
//!   the next cell. Since x stays in the hull of the control points, this is sufficient where
//!   dq/dsigma is constant; elsewhere, places in between are checked afterwards;
//! - to acceleration, at the start and in the middle of the cell; on straight lines, at the start
//!   and at the second of the three control points of dx/df;
//! - to jerk, at both ends and in the middle;
//! - to further quantities, such as torques, at the start and in the middle.
//!
//! Each limit becomes a row, which is divided by the value of the limit, so that its bound is 1.
//! Jerk is the exception: it is sqrt(x) times a linear function of the state, so that its row is
//! this linear function, and the bound of the row is `x^(-1/2)`. A row has a lower and an upper
//! bound, each with a slack s and a dual z.

use std::ops::Range;

use iiwa_path::Coordinates;
use iiwa_program::{ByKind, LimitKind};
use pulp::Simd;

use crate::{
    bounded_rows::BoundedRow,
    cell::Cell,
    cell_functions::{
        CellState, ControlV, EndV, EndW, EndX, MiddleV, MiddleW, MiddleX, Quadratic,
        SecondControlX, StartV, StartW, StartX, Terms, ThirdControlX,
    },
    geometry::{Geometry, SigmaDerivatives},
    jerk_rows::JerkRow,
    lanes::{LANES, Lanes, Vector, columns, registers},
    limited_segment::LimitedSegment,
    limiting_joints::LimitingJoints,
    mesh::Mesh,
    settings::InteriorPointSettings,
    slack_pair::{Decreases, InteriorStart, InteriorStep, InteriorSteps, SlackStart},
    velocity_rows::VelocityRows,
};

const SETTINGS: InteriorPointSettings = crate::settings::SETTINGS.interior_point;

/// Sums over all limits.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LimitSums {
    /// Sum of the products of slacks and duals.
    pub(crate) gap: f64,
    /// Largest residual of a row, as a share of its bound.
    pub(crate) residual: f64,
}

/// Factors by which the limits of a cell are tightened; 1 keeps a limit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lowering {
    pub(crate) of: ByKind<f64>,
    /// Factor on further limits, after subtraction of their offsets.
    pub(crate) rows: f64,
}

impl Default for Lowering {
    fn default() -> Self {
        Self { of: ByKind::from_array([1.0; 3]), rows: 1.0 }
    }
}

impl Lowering {
    /// True if all limits are kept.
    pub(crate) fn is_none(&self) -> bool {
        self.rows == 1.0 && self.of.values().all(|by| *by == 1.0)
    }
}

/// Largest relative decreases of slacks, duals and x in a full step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LargestDecreases {
    pub(crate) slack: f64,
    /// Not computed where it cannot exceed `irrelevant_dual`.
    pub(crate) dual: f64,
    pub(crate) x: f64,
    /// Decrease of duals that does not shorten a step: smaller decreases need not be computed.
    pub(crate) irrelevant_dual: f64,
}

/// Eight cells with at most `J` rows of each kind at a place; with one row, they are on lines.
#[derive(Clone, Debug)]
pub(crate) struct CellBlock<const J: usize> {
    /// Indices of the cells. The last block may repeat a cell, which has no effect.
    cells: [usize; LANES],
    /// Half the length: the weight of `x^(-1/2)` at both ends in the duration.
    weight: Lanes,
    velocities: [VelocityRows; 3],
    accelerations: [[BoundedRow; J]; 2],
    jerks: [[JerkRow; J]; 3],
    /// Rows of further limits at the start and in the middle that can be active in any of the
    /// cells.
    others: [Vec<BoundedRow>; 2],
}

/// A block with any number of rows: its functions are compiled once for lines and once for curves,
/// instead of once per number of rows. Each of them is compiled separately for the registers of
/// `S`.
struct AnyBlock<'a> {
    cells: &'a [usize; LANES],
    weight: &'a mut Lanes,
    velocities: &'a mut [VelocityRows; 3],
    accelerations: [&'a mut [BoundedRow]; 2],
    jerks: [&'a mut [JerkRow]; 3],
    others: [&'a mut Vec<BoundedRow>; 2],
}

/// Index of the tool coordinate.
const TOOL: usize = 7;

/// Kinds with a row at the start of a cell but not at its end. Where two segments meet, the smaller
/// of their limits applies.
const AT_STARTS: [LimitKind; 2] = [LimitKind::Velocity, LimitKind::Acceleration];

/// True if limits of this kind have a row at the end of a cell.
pub(crate) fn has_row_at_end(kind: LimitKind) -> bool {
    !AT_STARTS.contains(&kind)
}

/// A cell with the limits at its start and along it.
pub(crate) struct LimitedCell<'a, 'b> {
    pub(crate) cell: &'a Cell,
    pub(crate) segment: &'a LimitedSegment<'b>,
    geometry: &'a Geometry,
    /// The segment that ends at the start of the cell.
    before: Option<&'a LimitedSegment<'b>>,
}

impl<'a, 'b> LimitedCell<'a, 'b> {
    pub(crate) fn new(segments: &'a [LimitedSegment<'b>], mesh: &'a Mesh, k: usize) -> Self {
        let cell = &mesh.cells[k];
        let starts_segment = match k.checked_sub(1) {
            Some(before) => mesh.cells[before].segment != cell.segment,
            None => mesh.from_rest.is_none_or(|rest| rest.segment != cell.segment),
        };
        let before = if starts_segment { cell.segment.checked_sub(1) } else { None };
        let before = before.map(|before| &segments[before]);
        Self { cell, segment: &segments[cell.segment], geometry: &mesh.geometry[k], before }
    }

    /// Reciprocals of the velocity and acceleration limits at the start: for each limit, the
    /// smaller one of both segments. Also returns the derivatives with respect to sigma to which
    /// they apply, if these differ from those of the segment alone.
    fn at_start(&self) -> ([Coordinates; 2], Option<SigmaDerivatives>) {
        let current = AT_STARTS.map(|kind| self.segment.inverse[kind]);
        let Some(before) = self.before else { return (current, None) };
        let other = AT_STARTS.map(|kind| before.inverse[kind]);
        let lower = |k: usize| std::array::from_fn(|j| current[k][j].max(other[k][j]));
        let mut lower: [Coordinates; 2] = [lower(0), lower(1)];
        if !before.has_tool() {
            return (lower, None);
        }
        // The tool coordinate differs from segment to segment: the coordinate of this segment gets
        // the smaller limits of both, in its own unit.
        let mut derivatives = self.segment.derivatives_at(self.geometry, 0);
        let at_end = before.derivatives(1.0);
        let [rate, rate_before] = [derivatives[0][TOOL], at_end[0][TOOL]];
        let ratio = if self.segment.has_tool() && rate > 0.0 {
            rate_before / rate
        } else {
            std::iter::zip(&mut derivatives, at_end).for_each(|(to, from)| to[TOOL] = from[TOOL]);
            1.0
        };
        for k in 0..2 {
            lower[k][TOOL] = current[k][TOOL].max(ratio * other[k][TOOL]);
        }
        (lower, Some(derivatives))
    }

    /// Coordinates that can be at their acceleration limit at the start, from the reciprocals of
    /// these limits there.
    fn limiting_at_start(&self, inverse: &Coordinates) -> &LimitingJoints {
        let kind = LimitKind::Acceleration;
        if *inverse == self.segment.inverse[kind] {
            &self.segment.limiting[kind]
        } else if inverse[TOOL] > 0.0 {
            &LimitingJoints::ALL
        } else {
            &LimitingJoints::JOINTS
        }
    }

    /// Number of rows of each kind that the cell needs at a place.
    pub(crate) fn rows(&self) -> usize {
        if self.segment.is_line() {
            return 1;
        }
        let ([_, at_start], _) = self.at_start();
        let [_, acceleration, jerk] = self.segment.limiting.as_array();
        let limiting = [self.limiting_at_start(&at_start), acceleration, jerk];
        limiting.map(|limiting| limiting.get().len()).into_iter().fold(0, usize::max)
    }
}

impl<const J: usize> Default for CellBlock<J> {
    fn default() -> Self {
        Self {
            cells: [0; LANES],
            weight: Lanes::default(),
            velocities: [VelocityRows::default(); 3],
            accelerations: [[BoundedRow::default(); J]; 2],
            jerks: [[JerkRow::default(); J]; 3],
            others: Default::default(),
        }
    }
}

impl<const J: usize> CellBlock<J> {
    /// Number of sides of the velocity, acceleration and jerk limits in a block.
    const SIDES: usize =
        LANES * (3 * VelocityRows::SIDES + J * (2 * BoundedRow::SIDES + 3 * JerkRow::SIDES));

    /// Number of sides of all limits.
    pub(crate) fn sides(&self) -> usize {
        let others: usize = self.others.iter().map(Vec::len).sum();
        Self::SIDES + LANES * BoundedRow::SIDES * others
    }

    /// Sets the rows of at most eight cells. The block may have been used before: its slacks and
    /// duals have no meaning until [`start`](Self::start) resets them.
    pub(crate) fn set(&mut self, segments: &[LimitedSegment<'_>], mesh: &Mesh, cells: &[usize]) {
        self.cells = std::array::from_fn(|l| cells[l.min(cells.len() - 1)]);
        for rows in &mut self.accelerations {
            BoundedRow::set_bounds(rows);
        }
        let mut block = self.any();
        for (lane, k) in block.cells.iter().enumerate() {
            block.set_cell(lane, &LimitedCell::new(segments, mesh, *k));
        }
        block.set_others(mesh);
    }

    /// True if a cell of the block is in `window`.
    #[inline(always)]
    pub(crate) fn is_in(&self, window: &Range<usize>) -> bool {
        self.cells.iter().any(|cell| window.contains(cell))
    }

    /// Tightens the limits in the cells from `first` on.
    pub(crate) fn lower(&mut self, first: usize, by: &[Lowering]) {
        self.any().lower(first, by);
    }

    fn any(&mut self) -> AnyBlock<'_> {
        let Self { cells, weight, velocities, accelerations, jerks, others } = self;
        AnyBlock {
            cells,
            weight,
            velocities,
            accelerations: accelerations.each_mut().map(<[_; J]>::as_mut_slice),
            jerks: jerks.each_mut().map(<[_; J]>::as_mut_slice),
            others: others.each_mut(),
        }
    }

    /// Sets the slacks to the distances from the limits, and the duals accordingly.
    pub(crate) fn start<S: Simd>(&mut self, simd: S, states: &[CellState], start: SlackStart) {
        let block = self.any();
        if J == 1 {
            block.start::<true, S>(simd, states, start);
        } else {
            block.start::<false, S>(simd, states, start);
        }
    }

    /// Applies the last step to slacks and duals, then writes the contributions of the duration and
    /// the limits to the quadratic function that the next step minimises.
    pub(crate) fn assemble<S: Simd>(
        &mut self,
        simd: S,
        states: &[CellState],
        steps: [InteriorStep; 2],
        quadratics: &mut [Quadratic],
        sums: &mut LimitSums,
    ) {
        let block = self.any();
        if J == 1 {
            block.assemble::<true, S>(simd, states, steps, quadratics, sums);
        } else {
            block.assemble::<false, S>(simd, states, steps, quadratics, sums);
        }
    }

    /// Finds the steps of the slacks that correspond to the steps `state_steps` of the states.
    pub(crate) fn find_slack_steps<S: Simd>(
        &mut self,
        simd: S,
        states: &[CellState],
        state_steps: &[CellState],
        mu: f64,
        largest: &mut LargestDecreases,
    ) {
        let block = self.any();
        if J == 1 {
            block.find_slack_steps::<true, S>(simd, states, state_steps, mu, largest);
        } else {
            block.find_slack_steps::<false, S>(simd, states, state_steps, mu, largest);
        }
    }
}

impl AnyBlock<'_> {
    /// Sets the rows of one cell.
    #[inline(never)]
    fn set_cell(&mut self, lane: usize, limited: &LimitedCell<'_, '_>) {
        let segment = limited.segment;
        let length = limited.cell.length;
        self.weight.0[lane] = 0.5 * length;
        if let (Some(shares), None) = (segment.line_shares, limited.before) {
            return self.set_on_line(lane, limited.cell, &shares);
        }
        // At the start, one third, the middle, two thirds and the end.
        let [start, third, middle, two_thirds, end] =
            [0, 2, 3, 4, 6].map(|place| segment.derivatives_at(limited.geometry, place));
        let ([start_velocity, start_acceleration], both) = &limited.at_start();
        let both_start = both.as_ref().unwrap_or(&start);
        let [velocity, acceleration, full_jerk] = LimitKind::ALL.map(|kind| &segment.inverse[kind]);
        let jerk = &full_jerk.map(|inverse| inverse / limited.cell.jerk_rel);
        let start_limiting = limited.limiting_at_start(start_acceleration);
        let [_, acceleration_limiting, jerk_limiting] = segment.limiting.as_array();

        let [first, second, third_control] = self.velocities;
        first.set(lane, &both_start[0], start_velocity);
        second.set(lane, &third[0], velocity);
        third_control.set(lane, &two_thirds[0], velocity);

        let [at_start, in_middle] = &mut self.accelerations;
        BoundedRow::set_accelerations(
            at_start,
            lane,
            start_limiting.get(),
            both_start,
            length,
            start_acceleration,
        );
        let along = acceleration_limiting.get();
        BoundedRow::set_accelerations(in_middle, lane, along, &middle, length, acceleration);

        // On curves, jerk within its limit at both ends may overshoot a little in the middle.
        let bound = if self.jerks[0].len() > 1 { SETTINGS.mid_jerk } else { 1.0 };
        let in_middle = jerk.map(|inverse| inverse / bound);
        for (rows, (place, inverse)) in
            self.jerks.iter_mut().zip([(&start, jerk), (&end, jerk), (&middle, &in_middle)])
        {
            JerkRow::set(rows, lane, jerk_limiting.get(), place, length, inverse);
        }
    }

    /// Sets the rows of a cell on a line, all of whose limits are those of the segment, from its
    /// [`shares`](LimitedSegment::line_shares).
    fn set_on_line(&mut self, lane: usize, cell: &Cell, shares: &ByKind<f64>) {
        let [velocity, acceleration, jerk] = shares.into_array();
        for row in self.velocities.iter_mut() {
            row.set_on_line(lane, velocity);
        }
        for row in self.accelerations.iter_mut().flat_map(|rows| rows.iter_mut()) {
            row.set_on_line(lane, acceleration, cell.length);
        }
        for row in self.jerks.iter_mut().flat_map(|rows| rows.iter_mut()) {
            row.set_on_line(lane, jerk / cell.jerk_rel, cell.length);
        }
    }

    /// Sets the rows of further limits. Cells in which no row can be active keep rows with zero
    /// coefficients, which are always feasible.
    fn set_others(&mut self, mesh: &Mesh) {
        let max_count = self.cells.iter().map(|k| mesh.rows.near(*k).len()).max().unwrap_or(0);
        let is_near = |j: &usize| {
            self.cells.iter().any(|k| mesh.rows.near(*k).get(*j).is_some_and(|near| *near))
        };
        let near: Vec<usize> = (0..max_count).filter(is_near).collect();
        for (place, others) in self.others.iter_mut().enumerate() {
            others.clear();
            others.resize(near.len(), BoundedRow::default());
            BoundedRow::set_bounds(others);
            for (lane, k) in self.cells.iter().enumerate() {
                let rows = mesh.rows.of(*k)[place];
                for (other, j) in others.iter_mut().zip(&near) {
                    if let Some(row) = rows.get(*j) {
                        other.set(lane, row, mesh.cells[*k].length);
                    }
                }
            }
        }
    }

    #[inline(never)]
    fn lower(&mut self, first: usize, by: &[Lowering]) {
        for (lane, cell) in self.cells.iter().enumerate() {
            let by = cell.checked_sub(first).and_then(|k| by.get(k));
            let Some(by) = by.filter(|by| !by.is_none()) else { continue };
            let [velocity, acceleration, jerk] = by.of.into_array();
            self.others
                .iter_mut()
                .for_each(|rows| rows.iter_mut().for_each(|row| row.scale(lane, by.rows)));
            self.velocities.iter_mut().for_each(|rows| rows.scale(lane, velocity));
            self.accelerations
                .iter_mut()
                .for_each(|rows| rows.iter_mut().for_each(|row| row.scale(lane, acceleration)));
            self.jerks
                .iter_mut()
                .for_each(|rows| rows.iter_mut().for_each(|row| row.scale(lane, jerk)));
        }
    }

    /// True if the block has rows of further limits; most blocks have no such rows.
    #[inline(always)]
    fn has_others(&self) -> bool {
        let [at_start, _] = &self.others;
        !at_start.is_empty()
    }

    /// Raises the largest decrease of duals to that of all rows, after their steps are known.
    #[inline(always)]
    fn raise_dual_decreases<S: Simd>(&self, r: usize, mu: Vector<S>, decreases: &mut Decreases<S>) {
        for row in self.velocities.iter() {
            row.sides.raise_dual_decrease(r, mu, decreases);
        }
        for rows in &self.accelerations {
            for row in rows.iter() {
                row.sides.raise_dual_decrease(r, mu, decreases);
            }
        }
        for rows in &self.others {
            for row in rows.iter() {
                row.sides.raise_dual_decrease(r, mu, decreases);
            }
        }
        for rows in &self.jerks {
            for row in rows.iter() {
                row.sides.raise_dual_decrease(r, mu, decreases);
            }
        }
    }

    /// State of a cell.
    #[inline(always)]
    fn of<'b>(&self, lane: usize, states: &'b [CellState]) -> &'b CellState {
        &states[self.cells[lane]]
    }

    #[inline(never)]
    fn start<const LINE: bool, S: Simd>(self, simd: S, states: &[CellState], start: SlackStart) {
        simd.vectorize(
            #[inline(always)]
            move || {
                // Moved in, so that the closure itself is inlined instead of called through a shim.
                let mut block = self;
                let has_others = block.has_others();
                for register in 0..registers::<S>() {
                    let y = &columns(simd, register, |lane| block.of(lane, states));
                    let start = &InteriorStart::new(simd, register, start);
                    let [first, second, third] = block.velocities;
                    first.start::<StartX, S>(start, y);
                    second.start::<SecondControlX, S>(start, y);
                    third.start::<ThirdControlX, S>(start, y);
                    let [at_start, in_middle] = &mut block.accelerations;
                    BoundedRow::start::<LINE, StartX, StartV, S>(at_start, start, y);
                    if LINE {
                        BoundedRow::start::<LINE, MiddleX, ControlV, S>(in_middle, start, y);
                    } else {
                        BoundedRow::start::<LINE, MiddleX, MiddleV, S>(in_middle, start, y);
                    }
                    if has_others {
                        let [at_start, in_middle] = &mut block.others;
                        BoundedRow::start::<false, StartX, StartV, S>(at_start, start, y);
                        BoundedRow::start::<false, MiddleX, MiddleV, S>(in_middle, start, y);
                    }
                    let [at_start, at_end, in_middle] = &mut block.jerks;
                    JerkRow::start::<LINE, StartX, StartV, StartW, S>(at_start, start, y);
                    JerkRow::start::<LINE, EndX, EndV, EndW, S>(at_end, start, y);
                    JerkRow::start::<LINE, MiddleX, MiddleV, MiddleW, S>(in_middle, start, y);
                }
            },
        );
    }

    #[inline(never)]
    fn assemble<const LINE: bool, S: Simd>(
        self,
        simd: S,
        states: &[CellState],
        [last, next]: [InteriorStep; 2],
        quadratics: &mut [Quadratic],
        sums: &mut LimitSums,
    ) {
        simd.vectorize(
            #[inline(always)]
            move || {
                // Moved in, so that the closure itself is inlined instead of called through a shim.
                let mut block = self;
                let mut h = [Lanes::default(); 10];
                let mut g = [Lanes::default(); 4];
                let mut gap = Lanes::default();
                let has_others = block.has_others();
                for r in 0..registers::<S>() {
                    let y = &columns(simd, r, |lane| block.of(lane, states));
                    let sum = &mut Terms::new(simd);
                    let steps = &InteriorSteps::new(simd, r, last, next);
                    let weight = block.weight.load(simd, r);
                    let [first, second, third] = block.velocities;
                    first.add::<StartX, S>(steps, y, sum);
                    second.add::<SecondControlX, S>(steps, y, sum);
                    third.add::<ThirdControlX, S>(steps, y, sum);
                    let [at_start, in_middle] = &mut block.accelerations;
                    BoundedRow::add::<LINE, StartX, StartV, S>(at_start, steps, y, sum);
                    if LINE {
                        BoundedRow::add::<LINE, MiddleX, ControlV, S>(in_middle, steps, y, sum);
                    } else {
                        BoundedRow::add::<LINE, MiddleX, MiddleV, S>(in_middle, steps, y, sum);
                    }
                    if has_others {
                        let [at_start, in_middle] = &mut block.others;
                        BoundedRow::add::<false, StartX, StartV, S>(at_start, steps, y, sum);
                        BoundedRow::add::<false, MiddleX, MiddleV, S>(in_middle, steps, y, sum);
                    }
                    // The trapezoidal rule for the duration evaluates both ends.
                    let [at_start, at_end, in_middle] = &mut block.jerks;
                    JerkRow::add::<LINE, StartX, StartV, StartW, S>(
                        at_start, steps, y, weight, sum,
                    );
                    JerkRow::add::<LINE, EndX, EndV, EndW, S>(at_end, steps, y, weight, sum);
                    let zero = Vector::splat(simd, 0.0);
                    JerkRow::add::<LINE, MiddleX, MiddleV, MiddleW, S>(
                        in_middle, steps, y, zero, sum,
                    );
                    for i in 0..10 {
                        h[i].store(r, sum.h[i]);
                    }
                    for a in 0..4 {
                        g[a].store(r, sum.g[a]);
                    }
                    gap.store(r, sum.gap);
                    sums.residual = sums.residual.max(sum.residual.largest());
                }
                sums.gap = gap.add_to(sums.gap);
                for lane in 0..LANES {
                    // Entry by entry: a new `Quadratic` would be copied once more.
                    let Quadratic { h: to_h, g: to_g } = &mut quadratics[block.cells[lane]];
                    for i in 0..10 {
                        to_h[i] = h[i].0[lane];
                    }
                    for a in 0..4 {
                        to_g[a] = g[a].0[lane];
                    }
                }
            },
        );
    }

    #[inline(never)]
    fn find_slack_steps<const LINE: bool, S: Simd>(
        self,
        simd: S,
        states: &[CellState],
        state_steps: &[CellState],
        mu: f64,
        largest: &mut LargestDecreases,
    ) {
        simd.vectorize(
            #[inline(always)]
            move || {
                // Moved in, so that the closure itself is inlined instead of called through a shim.
                let mut block = self;
                let has_others = block.has_others();
                let mu = Vector::splat(simd, mu);
                for r in 0..registers::<S>() {
                    let before = &columns(simd, r, |lane| block.of(lane, states));
                    let mut after = columns(simd, r, |lane| block.of(lane, state_steps));
                    for a in 0..4 {
                        after[a] = before[a] + after[a];
                    }
                    let after = &after;
                    let decreases = &mut Decreases::new(simd);
                    let [first, second, third] = block.velocities;
                    first.find_steps::<StartX, S>(r, after, decreases);
                    second.find_steps::<SecondControlX, S>(r, after, decreases);
                    third.find_steps::<ThirdControlX, S>(r, after, decreases);
                    let [at_start, in_middle] = &mut block.accelerations;
                    BoundedRow::find_steps::<LINE, StartX, StartV, S>(
                        at_start, r, after, decreases,
                    );
                    if LINE {
                        BoundedRow::find_steps::<LINE, MiddleX, ControlV, S>(
                            in_middle, r, after, decreases,
                        );
                    } else {
                        BoundedRow::find_steps::<LINE, MiddleX, MiddleV, S>(
                            in_middle, r, after, decreases,
                        );
                    }
                    if has_others {
                        let [at_start, in_middle] = &mut block.others;
                        BoundedRow::find_steps::<false, StartX, StartV, S>(
                            at_start, r, after, decreases,
                        );
                        BoundedRow::find_steps::<false, MiddleX, MiddleV, S>(
                            in_middle, r, after, decreases,
                        );
                    }
                    let [at_start, at_end, in_middle] = &mut block.jerks;
                    let both = [before, after];
                    JerkRow::find_steps::<LINE, StartX, StartV, StartW, S>(
                        at_start, r, both, decreases,
                    );
                    JerkRow::find_steps::<LINE, EndX, EndV, EndW, S>(at_end, r, both, decreases);
                    JerkRow::find_steps::<LINE, MiddleX, MiddleV, MiddleW, S>(
                        in_middle, r, both, decreases,
                    );
                    largest.slack = largest.slack.max(decreases.slack());
                    largest.x = largest.x.max(decreases.x.largest());
                    // False for NaN, so that this case is not passed over.
                    let is_irrelevant =
                        decreases.dual_bound() <= largest.dual.max(largest.irrelevant_dual);
                    if !is_irrelevant {
                        block.raise_dual_decreases(r, mu, decreases);
                        largest.dual = largest.dual.max(decreases.dual.largest());
                    }
                }
            },
        );
    }
}
