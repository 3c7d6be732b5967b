//! One attempt to solve the problem of a window.
//!
//! A solution satisfies all limits at a few places of each cell. Where it exceeds a limit in
//! between, the limits of that cell are tightened and the cells around it are solved again: the
//! optimum is local.

use std::{ops::Range, sync::atomic::AtomicBool};

use iiwa_program::{ByKind, LimitKind};

use crate::{
    cell::{Cell, RowParabolas},
    cells::{Lowering, has_row_at_end},
    geometry::PlaceValues,
    lanes::dispatch,
    limited_segment::LimitedSegment,
    mesh::{Mesh, mesh},
    peaks::{Peak, SHARES, larger},
    settings::{AttemptSettings, RefinementSettings, SETTINGS, WarmStart, WindowSettings},
    solver::{SolveError, Solver},
};

/// Segments that are solved together. A start or an end at rest is on a line.
#[derive(Clone)]
pub struct Window<'a, 'b> {
    /// All segments of a section.
    pub segments: &'a [LimitedSegment<'b>],
    /// Indices of the segments to solve for, at least one.
    pub range: Range<usize>,
    /// x (rad^2/s^2) and dx/dsigma (rad/s^2) at the start; `None` at rest.
    pub entry: Option<[f64; 2]>,
    /// x (rad^2/s^2) and dx/dsigma (rad/s^2) at the end; `None` at rest.
    pub exit: Option<[f64; 2]>,
}

const REFINEMENT: RefinementSettings = SETTINGS.refinement;
const GAP: f64 = SETTINGS.interior_point.gap;

/// State of an attempt.
pub(crate) struct Attempt {
    pub(crate) mesh: Mesh,
    pub(crate) solver: Solver,
    /// Factor on all times by which the solution is slowed down to satisfy the limits.
    pub(crate) time_scale: f64,
    /// Largest duality gap of the cells at their last solution, relative to the duration.
    gap: f64,
}

/// Cells whose limits were tightened, in order, and the largest share of a limit found in them; 0
/// without such cells.
#[derive(Default)]
struct Lowered {
    cells: Vec<usize>,
    excess: f64,
}

/// Largest shares of the limits in a cell.
#[derive(Clone, Copy, Debug, Default)]
struct CellShares {
    of: ByKind<f64>,
    /// Largest share of a further limit.
    row: f64,
    /// Largest value of moving part / (limit - offset) of a further limit.
    of_room: f64,
}

/// Shares of the limits that a cell may reach.
#[derive(Clone, Copy)]
struct Allowed {
    of: ByKind<f64>,
    row: f64,
}

const TOLERANCE: Allowed = Allowed { of: REFINEMENT.tolerance, row: REFINEMENT.rows.tolerance };

impl Lowered {
    fn add(&mut self, other: Self) {
        self.cells.extend(other.cells);
        self.excess = self.excess.max(other.excess);
    }
}

impl Attempt {
    /// Solves for `window`. Returns `None` if it has no mesh.
    pub(crate) fn run(
        window: &Window<'_, '_>,
        settings: AttemptSettings,
        stop: &AtomicBool,
    ) -> Result<Option<Self>, SolveError> {
        let Window { segments, ref range, entry, exit } = *window;
        let AttemptSettings { refinement, is_safe, is_cautious } = settings;
        let rests = [entry.is_none(), exit.is_none()];
        let Some(mesh) = mesh(segments, range.clone(), rests, refinement) else {
            return Ok(None);
        };
        let solver = Solver::new(segments, &mesh, [entry, exit], is_cautious);
        let mut attempt = Self { mesh, solver, time_scale: 1.0, gap: f64::INFINITY };
        // x is the square of a speed, so a time scale divides it by the square of the scale.
        let scale = if is_safe { attempt.time_scale(segments).powi(-2) } else { REFINEMENT.start };
        attempt.solver.start(scale);
        match attempt.refine(segments, is_cautious, stop) {
            Ok(()) => {}
            // The iterate is still usable, slowed down until it satisfies the limits.
            Err(SolveError::NotConverged) => attempt.time_scale = attempt.time_scale(segments),
            Err(SolveError::Interrupted) => return Err(SolveError::Interrupted),
        }
        Ok(Some(attempt))
    }

    /// Upper bound on the duration over that of the optimum, by the duality gap.
    pub(crate) fn longer(&self) -> f64 {
        self.time_scale * (1.0 + self.gap)
    }

    /// Speed, acceleration and jerk of sigma at the share `f` of an inner cell, without the time
    /// scale.
    #[inline(always)]
    pub(crate) fn rates(&self, cell: usize, f: f64) -> [f64; 3] {
        let [x, dx, ddx] = self.solver.at(cell, f);
        let speed = x.sqrt();
        [speed, 0.5 * dx, 0.5 * ddx * speed]
    }

    /// Duration of an inner cell, relative to that of a slow one: a cell above 1 needs a finer
    /// check.
    pub(crate) fn slowness(&self, segment: &LimitedSegment<'_>, cell: usize) -> f64 {
        let duration_s = mean(|f| 1.0 / self.solver.at(cell, f)[0].sqrt());
        duration_s * self.mesh.cells[cell].length / (REFINEMENT.slow * segment.min_build_up_s)
    }

    /// Time from the share `from` to the share `to` of an inner cell, in s, without the time scale.
    ///
    /// A polynomial in time between both ends turns a time error into a jerk error: 60 times as
    /// large, over the third power of the time. Quadrature is therefore used only for what jerk
    /// adds to constant acceleration, and only on parts in which the speed changes by little.
    pub(crate) fn duration_s(&self, cell: usize, from: f64, to: f64) -> f64 {
        /// Largest change of speed in a part, as a share of the sum of both speeds.
        const CHANGE: f64 = 0.1;
        let x = |f: f64| self.solver.at(cell, f)[0];
        let [start, end] = [x(from), x(to)];
        let [slow, fast] = [start.sqrt(), end.sqrt()];
        let middle = f64::midpoint(from, to);
        if (fast - slow).abs() > CHANGE * (fast + slow) && from < middle && middle < to {
            return self.duration_s(cell, from, middle) + self.duration_s(cell, middle, to);
        }
        let by_jerk = mean(|f| {
            let steady = start + f * (end - start);
            1.0 / x(from + f * (to - from)).sqrt() - 1.0 / steady.sqrt()
        });
        (2.0 / (slow + fast) + by_jerk) * (to - from) * self.mesh.cells[cell].length
    }

    /// Solves and tightens limits until all of them are satisfied everywhere.
    fn refine(
        &mut self,
        segments: &[LimitedSegment<'_>],
        is_cautious: bool,
        stop: &AtomicBool,
    ) -> Result<(), SolveError> {
        let whole = 0..self.mesh.cells.len();
        match self.solve(SETTINGS.interior_point.first_gap, stop) {
            Ok(()) => {
                // Excesses show long before convergence.
                let allowed = Allowed { of: REFINEMENT.early, row: REFINEMENT.rows.early };
                let early = self.lower(segments, allowed, whole.clone(), &[]);
                if early.excess > REFINEMENT.abrupt {
                    self.solver.restart(REFINEMENT.far);
                }
            }
            // If a segment takes a tiny share of the time, x in it may not settle until the gap is
            // below that share. Excesses found before are meaningless.
            Err(SolveError::NotConverged) => {}
            Err(error) => return Err(error),
        }
        match self.solve(GAP, stop) {
            // A segment that takes a tiny share of the time settles at a smaller gap only.
            Err(SolveError::NotConverged) => self.solve(SETTINGS.interior_point.last_gap, stop)?,
            result => result?,
        }
        let mut windows = vec![whole.clone()];
        let mut before = Vec::new();
        for _ in 0..REFINEMENT.rounds {
            let mut lowered = Lowered::default();
            for window in windows {
                lowered.add(self.lower(segments, TOLERANCE, window, &before));
            }
            if lowered.cells.is_empty() {
                return Ok(());
            }
            let is_abrupt = lowered.excess > REFINEMENT.abrupt;
            let start = match (is_abrupt, is_cautious) {
                (true, _) => REFINEMENT.far,
                (false, true) => REFINEMENT.cautious,
                (false, false) => REFINEMENT.close,
            };
            windows = if is_abrupt || is_cautious {
                vec![whole.clone()]
            } else {
                self.windows_around(segments, &lowered.cells)
            };
            match self.solve_again(&windows, start, stop) {
                Ok(()) => {}
                Err(SolveError::NotConverged) if windows != [whole.clone()] => {
                    windows = vec![whole.clone()];
                    self.solve_again(&windows, REFINEMENT.far, stop)?;
                }
                Err(error) => return Err(error),
            }
            before = lowered.cells;
        }
        Err(SolveError::NotConverged)
    }

    fn solve(&mut self, gap: f64, stop: &AtomicBool) -> Result<(), SolveError> {
        let result = self.solver.solve(gap, stop);
        self.gap = self.solver.gap;
        result
    }

    /// Solves the windows one after the other, after their limits have been tightened.
    fn solve_again(
        &mut self,
        windows: &[Range<usize>],
        start: WarmStart,
        stop: &AtomicBool,
    ) -> Result<(), SolveError> {
        let before = self.gap;
        let whole = 0..self.mesh.cells.len();
        windows.iter().try_for_each(|window| {
            self.solver.select(window.clone());
            self.solver.restart(start);
            let result = self.solve(GAP, stop);
            if *window != whole {
                // The other cells are as near to the optimum as they were.
                self.gap = self.gap.max(before);
            }
            result
        })
    }

    /// Windows to solve again after the limits of the `lowered` cells were tightened: the optimum
    /// changes in them and on the segments around.
    fn windows_around(
        &self,
        segments: &[LimitedSegment<'_>],
        lowered: &[usize],
    ) -> Vec<Range<usize>> {
        let WindowSettings { around, stops } = SETTINGS.window;
        let cells = &self.mesh.cells;
        let mut windows: Vec<Range<usize>> = Vec::new();
        for &cell in lowered {
            let segment = cells[cell].segment;
            let far = stops * segments[segment].stop_rad(None);
            // Number of cells on one side that belong to the window.
            let count = |side: &mut dyn Iterator<Item = &Cell>| {
                let mut way = 0.0;
                side.take_while(|cell| {
                    let is_near = way < far || cell.segment.abs_diff(segment) <= around;
                    way += cell.length;
                    is_near
                })
                .count()
            };
            let start = cell - count(&mut cells[..cell].iter().rev());
            let end = cell + 1 + count(&mut cells[cell + 1..].iter());
            let window = self.solver.window_of(start..end);
            match windows.last_mut() {
                Some(last) if last.end >= window.start => {
                    *last = last.start.min(window.start)..last.end.max(window.end);
                }
                _ => windows.push(window),
            }
        }
        windows
    }

    /// Factor on all times that makes the solution satisfy the limits.
    fn time_scale(&self, segments: &[LimitedSegment<'_>]) -> f64 {
        let mut largest = ByKind::from_fn(|_| 1.0);
        largest[LimitKind::Jerk] = self.solver.rest_jerk();
        let mut row = 1.0;
        for shares in self.largest_shares(segments, 0..self.mesh.cells.len()) {
            raise(&mut largest, &shares.of);
            // The share of the room depends on speed^2 and acceleration: it scales with the inverse
            // square of time.
            row = larger(row, if shares.row > TOLERANCE.row { shares.of_room } else { 1.0 });
        }
        let slower = |(kind, share): (LimitKind, f64)| {
            (share / REFINEMENT.tolerance[kind]).powf(1.0 / f64::from(kind.order()))
        };
        // Infinite if cells do not join, which no time scale mends: the attempt is then discarded.
        let others = larger(row.sqrt(), self.solver.continuity_defect());
        largest.into_iter().map(slower).fold(larger(1.0, others), larger)
    }

    /// Tightens the limits of the cells in `window` that exceed them by more than the shares
    /// `allowed`. A cell that was tightened `before` in vain exceeds its limit at its end, where it
    /// has no row: the row is at the start of the next cell, which is tightened as well.
    fn lower(
        &mut self,
        segments: &[LimitedSegment<'_>],
        allowed: Allowed,
        window: Range<usize>,
        before: &[usize],
    ) -> Lowered {
        let first = window.start;
        let mut lowered = Lowered::default();
        let largest = self.largest_shares(segments, window);
        let mut by = Vec::with_capacity(largest.len());
        for (shares, cell) in largest.into_iter().zip(first..) {
            // Not within the limit if it is NaN: numbers are out of range.
            let mut by_share = |share: f64, allowed: f64, by: f64| {
                if share <= allowed {
                    return 1.0;
                }
                lowered.excess = lowered.excess.max(share);
                by
            };
            let mut lowering = Lowering::default();
            for kind in LimitKind::ALL {
                let share = shares.of[kind];
                lowering.of[kind] =
                    by_share(share, allowed.of[kind], REFINEMENT.target[kind] / share);
            }
            let target = REFINEMENT.rows.target / shares.of_room;
            lowering.rows = by_share(shares.row, allowed.row, target);
            if !lowering.is_none() {
                lowered.cells.push(cell);
            }
            by.push(lowering);
        }
        for cell in lowered.cells.iter().filter(|cell| before.binary_search(cell).is_ok()) {
            if let [current, next, ..] = &mut by[cell - first..] {
                for (kind, next) in next.of.iter_mut().filter(|(kind, _)| !has_row_at_end(*kind)) {
                    *next = next.min(current.of[kind]);
                }
                next.rows = next.rows.min(current.rows);
            }
        }
        if !lowered.cells.is_empty() {
            self.solver.lower(first, &by);
        }
        lowered
    }

    /// Largest shares of the limits in each cell of `window`.
    fn largest_shares(
        &self,
        segments: &[LimitedSegment<'_>],
        window: Range<usize>,
    ) -> Vec<CellShares> {
        dispatch(Check { attempt: self, segments, window })
    }

    /// Largest shares of the limits in cell `k`. A slow cell is checked in several stretches, and
    /// so is a cell with a large change of speed, because most of its time is spent next to one
    /// end.
    #[inline(always)]
    fn largest_shares_in(&self, k: usize, segments: &[LimitedSegment<'_>]) -> CellShares {
        let cell = &self.mesh.cells[k];
        let segment = &segments[cell.segment];
        let [start, end] = [0.0, 1.0].map(|f| self.solver.at(k, f)[0]);
        let ratio = if end > start { end / start } else { start / end };
        let by_ratio = REFINEMENT.ratios.iter().filter(|limit| ratio > **limit).count();
        let stretches = larger(self.slowness(segment, k), by_ratio as f64 + 1.0);
        let mut stretches = stretches.ceil().clamp(1.0, REFINEMENT.stretches);
        if stretches == 1.0 {
            let rates = &self.rates_along(k, [0.0, 1.0]);
            let geometry = &self.mesh.geometry[k];
            let shares = cell.shares(segment.largest_shares(geometry, rates));
            let finer =
                of_uneven_curve(&shares, &cell.shares(segment.share_errors(geometry, rates)));
            if finer == 1.0 {
                let [row, of_room] = self.largest_rows(k, [0.0, 1.0], rates);
                return CellShares { of: shares, row, of_room };
            }
            stretches = finer;
        }
        let mut largest = CellShares::default();
        let mut from = 0.0;
        while from < stretches {
            let stretch = [from / stretches, (from + 1.0) / stretches];
            let geometry = cell.geometry(segments, stretch);
            let rates = &self.rates_along(k, stretch);
            raise(&mut largest.of, &cell.shares(segment.largest_shares(&geometry, rates)));
            let [row, of_room] = self.largest_rows(k, stretch, rates);
            largest.row = larger(largest.row, row);
            largest.of_room = larger(largest.of_room, of_room);
            from += 1.0;
        }
        largest
    }

    /// Largest share of a further limit in the stretch between two shares of cell `k`, and largest
    /// value of moving part / (limit - offset); both are 0 without further limits. `rates` are the
    /// rates of sigma at [`SHARES`] of the stretch.
    #[inline(always)]
    fn largest_rows(&self, k: usize, [from, to]: [f64; 2], rates: &[PlaceValues; 3]) -> [f64; 2] {
        let near = self.mesh.rows.near(k);
        if near.is_empty() {
            return [0.0; 2];
        }
        let places = &self.mesh.rows.of(k);
        let [speeds, accelerations, _] = rates;
        let (mut row, mut of_room) = (Peak::default(), Peak::default());
        for j in (0..near.len()).filter(|j| near[*j]) {
            let RowParabolas { acceleration, square, offset } = &RowParabolas::new(places, j);
            let (mut shares, mut shares_of_room) = (PlaceValues::default(), PlaceValues::default());
            for i in 0..SHARES.len() {
                let f = from + SHARES[i] * (to - from);
                let moving =
                    acceleration.at(f) * accelerations[i] + square.at(f) * speeds[i] * speeds[i];
                let offset = offset.at(f);
                let room = if moving > 0.0 { 1.0 - offset } else { 1.0 + offset };
                shares[i] = moving + offset;
                shares_of_room[i] = moving / room;
            }
            row.add(&shares);
            of_room.add(&shares_of_room);
        }
        [row.get(), of_room.get()]
    }

    /// Shares of further limits at the share `f` of cell `k`, slowed down by `time_scale`.
    pub(crate) fn row_shares(
        &self,
        k: usize,
        f: f64,
        time_scale: f64,
    ) -> impl Iterator<Item = f64> {
        let places = self.mesh.rows.of(k);
        let count = places[0].len();
        let rates = (count > 0).then(|| self.rates(k, f));
        rates.into_iter().flat_map(move |[speed, acceleration, _]| {
            let [speed, acceleration] = [speed / time_scale, acceleration / time_scale.powi(2)];
            (0..count).map(move |j| RowParabolas::new(&places, j).at(f).at(speed, acceleration))
        })
    }

    /// Speed, acceleration and jerk of sigma at [`SHARES`] of the stretch between two shares of
    /// cell `k`.
    #[inline(always)]
    fn rates_along(&self, k: usize, [from, to]: [f64; 2]) -> [PlaceValues; 3] {
        let mut rates = [PlaceValues::default(); 3];
        for i in 0..SHARES.len() {
            let [speed, acceleration, jerk] = self.rates(k, from + SHARES[i] * (to - from));
            (rates[0][i], rates[1][i], rates[2][i]) = (speed, acceleration, jerk);
        }
        rates
    }
}

/// Number of stretches in which to check a cell on a curve, from the largest shares of the limits
/// `found` and their `errors`: 1 if no limit is exceeded either way. Errors are proportional to the
/// third power of the stretch length.
fn of_uneven_curve(shares: &ByKind<f64>, errors: &ByKind<f64>) -> f64 {
    let stretches = LimitKind::ALL.map(|kind| {
        let is_near = shares[kind] + errors[kind] > REFINEMENT.early[kind];
        if is_near { (errors[kind] / REFINEMENT.missed).cbrt().ceil() } else { 1.0 }
    });
    stretches.into_iter().fold(1.0, f64::max).min(REFINEMENT.stretches)
}

/// Raises the `largest` share of each kind to that in `shares`, if larger.
#[inline(always)]
fn raise(largest: &mut ByKind<f64>, shares: &ByKind<f64>) {
    for (kind, share) in shares {
        largest[kind] = larger(largest[kind], *share);
    }
}

/// Mean of a function over [0, 1], by three-point Gauss quadrature.
#[inline(always)]
fn mean(value_at: impl Fn(f64) -> f64) -> f64 {
    const HALF_WIDTH: f64 = 0.387_298_334_620_741_7;
    (5.0 * (value_at(0.5 - HALF_WIDTH) + value_at(0.5 + HALF_WIDTH)) + 8.0 * value_at(0.5)) / 18.0
}

/// Check of the cells of a window, run with the widest vector instructions of the machine.
struct Check<'a, 'b> {
    attempt: &'a Attempt,
    segments: &'a [LimitedSegment<'b>],
    window: Range<usize>,
}

impl pulp::WithSimd for Check<'_, '_> {
    type Output = Vec<CellShares>;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        let Check { attempt, segments, window } = self;
        // A closure that an iterator calls would be compiled without the vector registers of `S`.
        let mut shares = Vec::with_capacity(window.len());
        for k in window {
            shares.push(attempt.largest_shares_in(k, segments));
        }
        shares
    }
}
