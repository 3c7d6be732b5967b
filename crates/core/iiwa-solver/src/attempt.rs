//! An attempt to solve the problem of a window.
//!
//! What the solver finds keeps all limits at some places of each cell. Where it exceeds them in between, the
//! limits of that cell are lowered and it is solved again, for the cells around only: the optimum is local.

use std::{ops::Range, sync::atomic::AtomicBool};

use iiwa_program::{ByKind, LimitKind};

use crate::{
    cell::Cell,
    cell_rows::RowParabolas,
    cells::{Lowering, has_row_at_end},
    error::SolveError,
    geometry::Places,
    lanes::dispatch,
    limited_segment::LimitedSegment,
    mesh::{Mesh, mesh},
    peaks::{Peak, SHARES, larger},
    settings::{AttemptSettings, RefinementSettings, SETTINGS, WarmStart, WindowSettings},
    solver::Solver,
    window::Window,
};

const REFINEMENT: RefinementSettings = SETTINGS.refinement;
const GAP: f64 = SETTINGS.interior_point.gap;

/// Where an attempt has come to.
pub(crate) struct Attempt {
    pub(crate) mesh: Mesh,
    pub(crate) solver: Solver,
    /// Share of all times by which it is slowed down.
    pub(crate) time_scale: f64,
    /// Largest duality gap with which cells were solved for, relative to their duration.
    gap: f64,
}

/// The cells whose limits were lowered, in order, and the largest share of a limit found there; 0 if there are none.
#[derive(Default)]
struct Lowered {
    cells: Vec<usize>,
    excess: f64,
}

/// The largest shares of the limits in a cell.
#[derive(Clone, Copy, Debug, Default)]
struct CellShares {
    of: ByKind<f64>,
    /// Of a further limit.
    row: f64,
    /// The largest share of what the offset of a further limit leaves of it.
    of_room: f64,
}

/// The shares of the limits that a cell may reach.
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
    /// Solves for `window`. None if it has no mesh.
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
        let scale = if is_safe { attempt.time_scale(segments).powi(-2) } else { REFINEMENT.start };
        attempt.solver.start(scale);
        match attempt.refine(segments, is_cautious, stop) {
            Ok(()) => {}
            // Whatever was found is good, as slow as it takes to keep the limits.
            Err(SolveError::NotConverged) => attempt.time_scale = attempt.time_scale(segments),
            Err(SolveError::Interrupted) => return Err(SolveError::Interrupted),
        }
        Ok(Some(attempt))
    }

    /// By which share it may take longer than the best, if it is as far from it as the solver fears.
    pub(crate) fn longer(&self) -> f64 {
        self.time_scale * (1.0 + self.gap)
    }

    /// Speed, acceleration and jerk of sigma at the share `f` of an inner cell, if it is not slowed down.
    #[inline(always)]
    pub(crate) fn rates(&self, cell: usize, f: f64) -> [f64; 3] {
        let [x, dx, ddx] = self.solver.at(cell, f);
        let speed = x.sqrt();
        [speed, 0.5 * dx, 0.5 * ddx * speed]
    }

    /// How slow an inner cell is: above 1, very much so.
    pub(crate) fn slowness(&self, segment: &LimitedSegment<'_>, cell: usize) -> f64 {
        let duration_s = mean(|f| 1.0 / self.solver.at(cell, f)[0].sqrt());
        duration_s * self.mesh.cells[cell].length / (REFINEMENT.slow * segment.least_build_up_s)
    }

    /// Time from the share `from` to the share `to` of an inner cell, if it is not slowed down.
    ///
    /// In the polynomial in time that meets both ends, an error of the time becomes one of jerk, 60 times as large and
    /// over the third power of the time. So quadrature is for what jerk adds to constant acceleration only, and for
    /// parts in which the speed changes by little.
    pub(crate) fn duration_s(&self, cell: usize, from: f64, to: f64) -> f64 {
        /// Largest change of the speed in a part, as a share of both speeds together.
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

    /// Solves and lowers limits until all are kept everywhere.
    fn refine(
        &mut self,
        segments: &[LimitedSegment<'_>],
        is_cautious: bool,
        stop: &AtomicBool,
    ) -> Result<(), SolveError> {
        let whole = 0..self.mesh.cells.len();
        match self.solve(SETTINGS.interior_point.first_gap, stop) {
            Ok(()) => {
                // Where limits will be exceeded is seen long before the end.
                let allowed = Allowed { of: REFINEMENT.early, row: REFINEMENT.rows.early };
                let early = self.lower(segments, allowed, whole.clone(), &[]);
                if early.excess > REFINEMENT.abrupt {
                    self.solver.restart(REFINEMENT.far);
                }
            }
            // Where a segment takes next to none of the time, x may not settle until the gap is below that. What
            // exceeds a limit before says nothing.
            Err(SolveError::NotConverged) => {}
            Err(error) => return Err(error),
        }
        match self.solve(GAP, stop) {
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

    /// Solves for the cells of one window after the other, for limits that have been lowered.
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
                // The rest is as near to the optimum as it was.
                self.gap = self.gap.max(before);
            }
            result
        })
    }

    /// The windows that are to be solved for anew where the limits of `cells` were lowered: the optimum changes
    /// there, and on the segments around.
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
            // How many of the cells on one side are part of the window.
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

    /// The share of all times that keeps the limits.
    fn time_scale(&self, segments: &[LimitedSegment<'_>]) -> f64 {
        let mut largest = ByKind::from_fn(|_| 1.0);
        largest[LimitKind::Jerk] = self.solver.rest_jerk();
        let mut row = 1.0;
        for shares in self.largest_shares(segments, 0..self.mesh.cells.len()) {
            raise(&mut largest, &shares.of);
            // What goes with speed and acceleration goes with the square of the time scale.
            row = larger(row, if shares.row > TOLERANCE.row { shares.of_room } else { 1.0 });
        }
        let slower = |(kind, share): (LimitKind, f64)| {
            (share / REFINEMENT.tolerance[kind]).powf(1.0 / f64::from(kind.order()))
        };
        let others = larger(row.sqrt(), self.solver.continuity_defect());
        largest.into_iter().map(slower).fold(larger(1.0, others), larger)
    }

    /// Lowers the limits of the cells in `window` that exceed them by more than the shares `allowed`. Of those that
    /// were lowered `before`, in vain, the end was not: it is the start of the next cell, which is lowered, too.
    fn lower(
        &mut self,
        segments: &[LimitedSegment<'_>],
        allowed: Allowed,
        window: Range<usize>,
        before: &[usize],
    ) -> Lowered {
        let first = window.start;
        let mut lowered = Lowered::default();
        let found = self.largest_shares(segments, window);
        let mut by: Vec<_> = found
            .into_iter()
            .zip(first..)
            .map(|(shares, cell)| {
                let mut by_share = |share: f64, allowed: f64, by: f64| {
                    if share > allowed || share.is_nan() {
                        lowered.excess = lowered.excess.max(share);
                        by
                    } else {
                        1.0
                    }
                };
                let of = ByKind::from_fn(|kind| {
                    let share = shares.of[kind];
                    by_share(share, allowed.of[kind], REFINEMENT.target[kind] / share)
                });
                let target = REFINEMENT.rows.target / shares.of_room;
                let by = Lowering { of, rows: by_share(shares.row, allowed.row, target) };
                if !by.is_none() {
                    lowered.cells.push(cell);
                }
                by
            })
            .collect();
        for cell in lowered.cells.iter().filter(|cell| before.binary_search(cell).is_ok()) {
            if let [own, next, ..] = &mut by[cell - first..] {
                for (kind, next) in next.of.iter_mut().filter(|(kind, _)| !has_row_at_end(*kind)) {
                    *next = next.min(own.of[kind]);
                }
                next.rows = next.rows.min(own.rows);
            }
        }
        if !lowered.cells.is_empty() {
            self.solver.lower(first, &by);
        }
        lowered
    }

    /// The largest shares of the limits in each cell of `window`.
    fn largest_shares(
        &self,
        segments: &[LimitedSegment<'_>],
        window: Range<usize>,
    ) -> Vec<CellShares> {
        dispatch(Check { attempt: self, segments, window })
    }

    /// The same in one cell, stretch by stretch if it is slow, or if the speed changes much: then most of the time is
    /// spent next to one end.
    #[inline(always)]
    fn largest_shares_in(&self, k: usize, segments: &[LimitedSegment<'_>]) -> CellShares {
        let cell = &self.mesh.cells[k];
        let segment = &segments[cell.segment];
        let [start, end] = [0.0, 1.0].map(|f| self.solver.at(k, f)[0]);
        let doublings = if end > start { end / start } else { start / end }.log2();
        let stretches = larger(self.slowness(segment, k), REFINEMENT.doublings * doublings);
        let mut stretches = stretches.ceil().clamp(1.0, REFINEMENT.stretches);
        if stretches == 1.0 {
            let rates = &self.rates_along(k, [0.0, 1.0]);
            let geometry = &self.mesh.geometry[k];
            let of = cell.shares(segment.largest_shares(geometry, rates));
            let finer = of_uneven_curve(&of, &cell.shares(segment.share_errors(geometry, rates)));
            if finer == 1.0 {
                let [row, of_room] = self.largest_rows(k, [0.0, 1.0], rates);
                return CellShares { of, row, of_room };
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

    /// The largest share of a further limit in the stretch between two shares of a cell, and the largest share of what the offset
    /// of one leaves of it; 0 without further limits. With the rates of sigma at [`SHARES`] of the stretch.
    #[inline(always)]
    fn largest_rows(&self, k: usize, [from, to]: [f64; 2], rates: &[Places; 3]) -> [f64; 2] {
        let near = self.mesh.rows.near(k);
        if near.is_empty() {
            return [0.0; 2];
        }
        let places = &self.mesh.rows.of(k);
        let [speeds, accelerations, _] = rates;
        let (mut row, mut of_room) = (Peak::default(), Peak::default());
        for j in (0..near.len()).filter(|j| near[*j]) {
            let RowParabolas { acceleration, square, offset } = &RowParabolas::new(places, j);
            let (mut shares, mut shares_of_room) = (Places::default(), Places::default());
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

    /// The shares of further limits at the share `f` of a cell, if all is `time_scale` times slower.
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

    /// Speed, acceleration and jerk of sigma at [`SHARES`] of the stretch between two shares of a cell.
    #[inline(always)]
    fn rates_along(&self, k: usize, [from, to]: [f64; 2]) -> [Places; 3] {
        let mut rates = [Places::default(); 3];
        for i in 0..SHARES.len() {
            let [speed, acceleration, jerk] = self.rates(k, from + SHARES[i] * (to - from));
            (rates[0][i], rates[1][i], rates[2][i]) = (speed, acceleration, jerk);
        }
        rates
    }
}

/// Number of stretches in which a cell on a curve is checked whose largest shares of the limits are `found`, but for these
/// `errors`: 1 where no limit is exceeded either way. Errors fall with the third power of a stretch's length.
fn of_uneven_curve(found: &ByKind<f64>, errors: &ByKind<f64>) -> f64 {
    let stretches = LimitKind::ALL.map(|kind| {
        let is_near = found[kind] + errors[kind] > REFINEMENT.early[kind];
        if is_near { (errors[kind] / REFINEMENT.missed).cbrt().ceil() } else { 1.0 }
    });
    stretches.into_iter().fold(1.0, f64::max).min(REFINEMENT.stretches)
}

/// Raises what is `largest` of each kind to the `shares`, where these are larger.
#[inline(always)]
fn raise(largest: &mut ByKind<f64>, shares: &ByKind<f64>) {
    for (kind, share) in shares {
        largest[kind] = larger(largest[kind], *share);
    }
}

/// The mean of a function over 0 to 1, by Gauss's quadrature.
#[inline(always)]
fn mean(at: impl Fn(f64) -> f64) -> f64 {
    const HALF_WIDTH: f64 = 0.387_298_334_620_741_7;
    (5.0 * (at(0.5 - HALF_WIDTH) + at(0.5 + HALF_WIDTH)) + 8.0 * at(0.5)) / 18.0
}

/// The check of the cells of a window, by the widest vector instructions that the machine has.
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
        window.map(|k| attempt.largest_shares_in(k, segments)).collect()
    }
}
