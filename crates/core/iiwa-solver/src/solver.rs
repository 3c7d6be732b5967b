//! Primal-dual interior-point method for the time-optimal x(sigma) over the cells of a section,
//! where sigma is the path parameter and x = (dsigma/dt)^2.
//!
//! The duration, `sum of length / 2 (x_start^(-1/2) + x_end^(-1/2))`, is minimised over the states
//! of the cells, subject to their limits. In each cell, x is a cubic polynomial in f, which runs
//! from 0 at the start of the cell to 1 at its end. The state of a cell is (x, V, W0, W1): x and V
//! = dx/df at its start, and W0 and W1, the values of d2x/df2 at its two ends. A Newton step is a
//! linear-quadratic control problem: x and dx/dsigma (V divided by the length of the cell) are
//! continuous from cell to cell, and W0 and W1 are the controls. A backward recursion over 2x2
//! matrices (Riccati) solves it in time linear in the number of cells. Neighbouring cells can
//! differ in length by a factor of thousands; one banded system for all x would lose precision
//! there, but the recursion does not.
//!
//! Iterates may be infeasible in two ways. First, slacks need not match their constraints (rows),
//! which allows long steps. Second, each cell stores its own x and V, so that the end of a cell
//! need not match the start of the next one until the method has converged. If x were computed from
//! cell to cell instead, its small values would inherit the rounding errors of its large ones (x
//! falls from 20 to 1e-7 within a section).
//!
//! After the limits of a few cells have changed, only a window of cells around them is solved
//! again, because the change affects the optimum only nearby.
//!
//! A section starts and ends at rest. If only a part of it is solved, x and dx/dsigma are given at
//! each end of the part that is not at rest. In cells that touch rest, x is not a cubic polynomial:
//! jerk is constant there, so that x is proportional to s^(4/3), where s is the distance in sigma
//! from the point of rest.

use std::{
    ops::Range,
    sync::atomic::{AtomicBool, Ordering},
};

use pulp::{Scalar, Simd};
use thiserror::Error;

use crate::{
    blocks::{Blocks, for_each_block},
    cell::Cell,
    cell_functions::{CellState, EndV, EndX, Functional, Quadratic, StartX},
    cells::{LargestDecreases, LimitSums, Lowering},
    lanes::{LANES, Lanes, columns, dispatch, registers},
    limited_segment::LimitedSegment,
    mesh::Mesh,
    rests::{RestCell, Rests, ScalarSlackPair},
    riccati::{self, Gains, NotConvex},
    settings::{InteriorPointSettings, WarmStart},
    slack_pair::{InteriorStep, SlackStart},
    stage_chain::StageChain,
};

/// An error of the solver: it returns no solution.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum SolveError {
    /// No attempt came near enough to the optimum.
    #[error("no attempt came near enough to the optimum")]
    NotConverged,
    /// The stop flag of the caller was set.
    #[error("interrupted")]
    Interrupted,
}

/// The problem of one section, with the current iterate.
pub(crate) struct Solver {
    /// Lengths of the cells, without the two that touch rest ([`Rests`]).
    lengths: Vec<f64>,
    /// `true` where W0 and W1 of a cell are free; elsewhere both are zero.
    free: Vec<bool>,
    rests: Rests,
    /// x and V at the entry of the section, if it does not start at rest.
    entry: [f64; 2],
    blocks: Blocks,
    states: Vec<CellState>,
    /// The Newton step of the states.
    steps: Vec<CellState>,
    quadratics: Vec<Quadratic>,
    gains: Gains,
    /// Duality gap relative to the duration: the share that further steps could gain.
    pub(crate) gap: f64,
    /// Target of the next step for the product of each slack and its dual.
    mu: f64,
    /// `true` if a step ends as soon as any slack or dual reaches its boundary. If `false`, steps
    /// may go further, and each slack and dual stops at its own boundary.
    is_cautious: bool,
    /// The cells that are solved for; all others are fixed.
    window: Range<usize>,
    /// The last step, not yet applied to the slacks and duals of the cells.
    last: InteriorStep,
}

impl Drop for Solver {
    fn drop(&mut self) {
        // The next solver of this thread reuses the memory.
        std::mem::take(&mut self.blocks).spare();
    }
}

impl From<NotConvex> for SolveError {
    fn from(NotConvex: NotConvex) -> Self {
        Self::NotConverged
    }
}

/// Header of the iteration table: the duration, the gap relative to it, the largest residual of a
/// row as a share of its bound, the target for the products of slacks and duals, and the primal and
/// dual step lengths.
const ITERATIONS: &str = "step     duration s      gap residual       mu  primal    dual";

const SETTINGS: InteriorPointSettings = crate::settings::SETTINGS.interior_point;

impl Solver {
    /// Creates the problem, with the acceleration-limited motion as the first guess.
    ///
    /// The section starts and ends at rest, or with the x and dx/dsigma of `entry` and `exit`. If
    /// `is_cautious`, a step ends as soon as any slack or dual reaches its boundary.
    pub(crate) fn new(
        segments: &[LimitedSegment<'_>],
        mesh: &Mesh,
        [entry, exit]: [Option<[f64; 2]>; 2],
        is_cautious: bool,
    ) -> Self {
        let cells = &mesh.cells;
        let n = cells.len();
        let lengths: Vec<_> = cells.iter().map(|cell| cell.length).collect();
        let from_rest = mesh.from_rest.as_ref();
        let from_rest =
            from_rest.map(|rest| RestCell::new(rest, &segments[rest.segment], 0.0, 0, StartX::ROW));
        let to_rest = mesh.to_rest.as_ref();
        let to_rest =
            to_rest.map(|rest| RestCell::new(rest, &segments[rest.segment], 1.0, n - 1, EndX::ROW));
        let [x, dx] = entry.unwrap_or_default();
        let mut free = vec![true; n];
        let mut limited = Vec::with_capacity(n);
        for k in 0..n {
            let segment = cells[k].segment;
            if !segments[segment].is_line() {
                limited.push(k);
                continue;
            }
            // A short line between two blends has no rows, and its W0 and W1 are fixed at zero.
            let differs =
                |other: Option<&Cell>| other.is_some_and(|other| other.segment != segment);
            let alone = k > 0 && differs(cells.get(k - 1)) && differs(cells.get(k + 1));
            let sliver = k > 0
                && k + 1 < n
                && lengths[k] < SETTINGS.sliver * lengths[k - 1].min(lengths[k + 1]);
            if alone && sliver {
                free[k] = false;
            } else {
                limited.push(k);
            }
        }
        let mut solver = Self {
            free,
            rests: Rests { from: from_rest, to: to_rest },
            entry: [x, dx * lengths[0]],
            blocks: Blocks::new(segments, mesh, &limited),
            states: vec![[0.0; 4]; n],
            steps: vec![[0.0; 4]; n],
            quadratics: vec![Quadratic::default(); n],
            gains: Gains::default(),
            gap: f64::INFINITY,
            mu: 0.0,
            is_cautious,
            window: 0..n,
            last: InteriorStep::default(),
            lengths,
        };
        let last = mesh.to_rest.as_ref().map(|cell| cell.x).or(exit.map(|[x, _]| x));
        let mut x: Vec<_> = cells.iter().map(|cell| cell.x).chain(last).collect();
        if let Some(to_rest) = &mesh.to_rest {
            // The acceleration-limited motion does not always come to rest at this end.
            let [_, acceleration, _] = segments[to_rest.segment].straight(1.0);
            let mut way = to_rest.length;
            for (x, length) in x.iter_mut().rev().zip(solver.lengths.iter().rev().chain([&0.0])) {
                *x = x.min(2.0 * acceleration * way);
                way += length;
            }
        }
        lower_to_jerk(segments, mesh, &mut x);
        solver.guess(&x);
        if let Some([x, dx]) = exit {
            // A fixed cell beyond the last one holds the exit state that the last cell has to meet.
            let length = solver.lengths[n - 1];
            solver.lengths.push(length);
            solver.free.push(false);
            solver.states.push([x, dx * length, 0.0, 0.0]);
            solver.steps.push([0.0; 4]);
            solver.quadratics.push(Quadratic::default());
        }
        solver
    }

    /// Starts from the current x times `scale`.
    pub(crate) fn start(&mut self, scale: f64) {
        let inner = &mut self.states[self.window.clone()];
        inner.as_flattened_mut().iter_mut().for_each(|value| *value *= scale);
        // The entry state is given, so it is not scaled.
        if self.rests.from.is_none() {
            self.states[0][..2].copy_from_slice(&self.entry);
        }
        self.restart(SETTINGS.cold);
    }

    /// Sets the states to a quadratic B-spline close to `x`. `x` has n + 1 values, one at each
    /// boundary of the n cells; the two cells that touch rest are not among them.
    fn guess(&mut self, x: &[f64]) {
        let n = self.lengths.len();
        let length = |k: usize| if k == 0 || k > n { 0.0 } else { self.lengths[k - 1] };
        let mut control = vec![0.0; n + 2];
        for i in 1..=n {
            control[i] = 0.5 * (x[i - 1] + x[i]);
        }
        (control[0], control[n + 1]) = (x[0], x[n]);
        for _ in 0..3 {
            let before = control.clone();
            for i in 1..=n {
                control[i] = 0.25 * before[i - 1] + 0.5 * before[i] + 0.25 * before[i + 1];
            }
        }
        // The slopes at both ends match those of the cells that touch rest.
        let rest = |k: usize, rest: &RestCell| 1.0 / (1.0 + length(k) / (1.5 * rest.length));
        if let Some(from_rest) = &self.rests.from {
            control[0] = rest(1, from_rest) * control[1];
        }
        if let Some(to_rest) = &self.rests.to {
            control[n + 1] = rest(n, to_rest) * control[n];
        }
        for k in 1..=n {
            let (a, b, c) = (length(k - 1), length(k), length(k + 1));
            let slope = 2.0 * (control[k] - control[k - 1]) / (a + b);
            let next = 2.0 * (control[k + 1] - control[k]) / (b + c);
            let x = (b * control[k - 1] + a * control[k]) / (a + b);
            let w = if self.free[k - 1] { (next - slope) * b } else { 0.0 };
            self.states[k - 1] = [x, slope * b, w, w];
        }
        if let Some(slope) = self.slope_from_rest() {
            self.states[0][1] = slope * self.states[0][0];
        }
        self.stop();
    }

    /// Restricts the problem to the cells in `window`, which start from their current states.
    pub(crate) fn select(&mut self, window: Range<usize>) {
        self.window = window;
        // Blocks at the edge of the window also contain fixed cells, whose step has to be zero.
        self.steps.fill([0.0; 4]);
    }

    /// Returns the smallest window that contains `cells` and can be solved alone.
    pub(crate) fn window_of(&self, mut cells: Range<usize>) -> Range<usize> {
        // The last cell of a window has to reach the fixed state after the window. For this, its W0
        // and W1 must be free.
        while cells.end < self.lengths.len() && !self.free[cells.end - 1] {
            cells.end += 1;
        }
        cells
    }

    /// Resets slacks and duals after limits have changed.
    pub(crate) fn restart(&mut self, start: WarmStart) {
        let mu = start.mu * self.duration_s(Scalar::new()) / self.limits();
        self.mu = mu;
        self.last = InteriorStep::default();
        let start = SlackStart { mu, min_slack: start.slack, kept: start.kept };
        dispatch(Restart { solver: self, start });
        for rest in self.rests.within_mut(&self.window) {
            let s = (1.0 - rest.x(&self.states) / rest.cap).max(start.min_slack);
            let balanced = mu / s;
            // Unlike `clamp`, this does not panic if a bound is NaN.
            let z = rest.slack.z.max(balanced / start.kept).min(balanced * start.kept);
            rest.slack = ScalarSlackPair { s, z, ..ScalarSlackPair::default() };
        }
    }

    /// Solves the problem from the current iterate, until the duality gap is at most `gap` times
    /// the duration, or `stop` is set.
    pub(crate) fn solve(&mut self, gap: f64, stop: &AtomicBool) -> Result<(), SolveError> {
        dispatch(Solve { solver: self, gap, stop })
    }

    /// Tightens the limits of the cells from `first` on.
    pub(crate) fn lower(&mut self, first: usize, by: &[Lowering]) {
        let cells = &(first..first + by.len());
        for_each_block!(&mut self.blocks, cells, block => block.lower(first, by));
    }

    /// x and its first two derivatives with respect to sigma, at `f` (0 to 1) in cell `k`. The
    /// index `k` does not count the two cells at rest.
    #[inline(always)]
    pub(crate) fn at(&self, k: usize, f: f64) -> [f64; 3] {
        let [x, v, w0, w1] = self.states[k];
        let h = self.lengths[k];
        [
            x + f * (v + f * (0.5 * w0 + f * (w1 - w0) / 6.0)),
            (v + f * (w0 + 0.5 * f * (w1 - w0))) / h,
            (w0 + f * (w1 - w0)) / (h * h),
        ]
    }

    /// Duration of the cell that starts at rest, in s; 0 without one.
    pub(crate) fn start_s(&self) -> f64 {
        self.rests.from.as_ref().map_or(0.0, |rest| rest.duration_s(&self.states))
    }

    /// Duration of the cell that ends at rest, in s; 0 without one.
    pub(crate) fn stop_s(&self) -> f64 {
        self.rests.to.as_ref().map_or(0.0, |rest| rest.duration_s(&self.states))
    }

    /// Largest ratio of the jerk to its limit in the cells that begin or end at rest.
    pub(crate) fn rest_jerk(&self) -> f64 {
        // The constant jerk of such a cell is proportional to x^(3/2), with x at the end that
        // moves.
        self.rests
            .iter()
            .map(|rest| (rest.x(&self.states) / rest.cap).powf(1.5))
            .fold(0.0, f64::max)
    }

    /// Factor by which the motion has to be slowed down because of gaps between cells: 1 without
    /// gaps, and otherwise infinity, because no slowdown closes a gap.
    pub(crate) fn continuity_defect(&self) -> f64 {
        /// Share of x and V that counts as rounding.
        const ROUNDING: f64 = 1e-7;
        let continuity_defect = (0..self.lengths.len() - 1).any(|k| {
            let [dx, dv] = self.defect(k);
            let [x, v, ..] = self.states[k + 1];
            !(dx.abs() <= ROUNDING * x && dv.abs() <= ROUNDING * (x + v.abs()))
        });
        if continuity_defect { f64::INFINITY } else { 1.0 }
    }

    /// Duration of the window, as the objective approximates it: by the trapezoidal rule.
    #[inline(always)]
    fn duration_s<S: Simd>(&self, simd: S) -> f64 {
        let window = self.window.clone();
        let (lengths, states) = (&self.lengths[window.clone()], &self.states[window]);
        let mut sums = Lanes::default();
        // The last cells are counted one by one below.
        let eights = lengths.len() / LANES;
        for k in (0..eights).map(|eight| eight * LANES) {
            for r in 0..registers::<S>() {
                let y = &columns(simd, r, |lane| &states[k + lane]);
                let [length] = columns(simd, r, |lane| std::array::from_ref(&lengths[k + lane]));
                let (start, end) = (StartX::of(y).sqrt(), EndX::of(y).sqrt());
                let sum = (start + end) * (start * end).inverse();
                sums.store(r, length.mul_add(sum, sums.load(simd, r)));
            }
        }
        let mut moving = 0.5 * sums.add_to(0.0);
        for (h, y) in std::iter::zip(lengths, states).skip(eights * LANES) {
            moving += 0.5 * h * (1.0 / y[0].sqrt() + 1.0 / riccati::dot(&EndX::ROW, y).sqrt());
        }
        let rests = self.rests.within(&self.window).map(|rest| rest.duration_s(&self.states));
        moving + rests.sum::<f64>()
    }

    /// The ratio V / x at the start of the first cubic cell. It follows from the cell before, which
    /// starts at rest and in which x is proportional to sigma^(4/3). `None` if the window does not
    /// contain the first cell, or the section does not start at rest.
    fn slope_from_rest(&self) -> Option<f64> {
        let from = self.rests.from.as_ref().filter(|_| self.window.start == 0);
        from.map(|rest| 4.0 * self.lengths[0] / (3.0 * rest.length))
    }

    /// Coefficients of a linear function of the state of the last cubic cell. The function is zero
    /// if the end of that cell matches the start of the cell that ends at rest, in which x is
    /// proportional to s^(4/3), where s is the distance in sigma from the point of rest. `None` if
    /// the section does not end at rest.
    fn to_rest(&self) -> Option<CellState> {
        let rest = self.rests.to.as_ref()?;
        let slope = 4.0 * self.lengths[self.lengths.len() - 1] / (3.0 * rest.length);
        Some(std::array::from_fn(|i| EndV::ROW[i] + slope * EndX::ROW[i]))
    }

    /// If the section ends at rest, sets W1 of the last cubic cell so that the end of this cell
    /// matches the cell that ends at rest.
    fn stop(&mut self) {
        if let (Some(to_rest), Some(last)) = (self.to_rest(), self.states.last_mut()) {
            riccati::come_to_rest(&to_rest, last);
        }
    }

    /// Defect in x and V between the end of cell `k` and the start of the next one.
    fn defect(&self, k: usize) -> [f64; 2] {
        riccati::defect(&self.lengths, &self.states, k)
    }

    /// Number of bounds in the window, with those of the two cells that touch rest.
    fn limits(&self) -> f64 {
        (self.blocks.sides(&self.window) + 2) as f64
    }

    #[inline(always)]
    fn iterate<S: Simd>(&mut self, simd: S, gap: f64, stop: &AtomicBool) -> Result<(), SolveError> {
        let limits = self.limits();
        let (short, max_stalled) = SETTINGS.stalled;
        let [primal_beyond, dual_beyond] =
            if self.is_cautious { [1.0; 2] } else { SETTINGS.beyond };
        let mut stalled = 0;
        let Range { start, end } = self.window;
        tracing::trace!("cells {start} to {end} of {}, to a gap of {gap:.0e}", self.lengths.len());
        tracing::trace!("{ITERATIONS}");
        for step in 1..=SETTINGS.steps {
            if stop.load(Ordering::Relaxed) {
                return Err(SolveError::Interrupted);
            }
            let sums = self.assemble(simd);
            self.find_state_steps(simd)?;
            let ratios = self.find_slack_steps(simd, dual_beyond * SETTINGS.to_boundary);
            let share = |fall: f64, value: f64| if fall > value { value / fall } else { 1.0 };
            let primal = (primal_beyond * share(ratios.slack, SETTINGS.to_boundary))
                .min(1.0)
                .min(share(ratios.x, SETTINGS.largest_decrease));
            let dual = (dual_beyond * share(ratios.dual, SETTINGS.to_boundary)).min(1.0);
            // A step uses the absolute value of the Lagrangian's curvature. Where the curvature is
            // negative, full steps can therefore cycle. To prevent this, all primal steps are
            // halved once the number of steps exceeds `patience`.
            let primal = if step > SETTINGS.patience { 0.5 * primal } else { primal };
            // The step length is zero if the relative decrease of a slack, a dual or x is infinite.
            if primal <= 0.0 || dual <= 0.0 {
                return Err(SolveError::NotConverged);
            }
            self.step(primal, dual);
            let duration_s = self.duration_s(simd);
            self.gap = sums.gap / duration_s;
            if !duration_s.is_finite() {
                return Err(SolveError::NotConverged);
            }
            tracing::trace!(
                "{step:4} {duration_s:14.9} {:8.1e} {:8.1e} {:8.1e} {primal:7.3} {dual:7.3}",
                self.gap,
                sums.residual,
                self.mu,
            );
            let step_length = primal.min(dual);
            // Far from the boundary the next step may aim at a smaller gap.
            let aim = SETTINGS.centring.iter().find(|(length, _)| step_length >= *length);
            let aim = aim.map_or(1.0, |(_, aim)| *aim);
            self.mu = (aim * sums.gap / limits).max(SETTINGS.min_mu * gap * duration_s / limits);
            if self.gap < gap && sums.residual < SETTINGS.residual {
                // With limits such as those of torques, the last steps may be short although the
                // gap is closed.
                let is_closer = self.gap < SETTINGS.closer * gap
                    && sums.residual < SETTINGS.closer * SETTINGS.residual;
                if primal > SETTINGS.last_step || is_closer && self.blocks.has_others {
                    return Ok(());
                }
            }
            stalled = if step_length < short { stalled + 1 } else { 0 };
            if stalled > max_stalled {
                return Err(SolveError::NotConverged);
            }
        }
        Err(SolveError::NotConverged)
    }

    #[inline(always)]
    fn assemble<S: Simd>(&mut self, simd: S) -> LimitSums {
        let mu = self.mu;
        let steps = [self.last, InteriorStep { mu, ..InteriorStep::default() }];
        let mut sums = LimitSums::default();
        for_each_block!(&mut self.blocks, &self.window, block => {
            block.assemble(simd, &self.states, steps, &mut self.quadratics, &mut sums);
        });
        for rest in self.rests.within(&self.window) {
            let x = rest.x(&self.states);
            let ScalarSlackPair { s, z, .. } = rest.slack;
            let miss = x / rest.cap - 1.0 + s;
            sums.gap += s * z;
            sums.residual = sums.residual.max(miss.abs());
            // The duration from rest is 3 length x^(-1/2). Eliminating slack and dual leaves z / s
            // as the weight of the row.
            let curvature = z / (s * rest.cap * rest.cap) + 2.25 * rest.length * x.powf(-2.5);
            let slope = (mu + z * miss) / (s * rest.cap) - 1.5 * rest.length * x.powf(-1.5);
            self.quadratics[rest.cell].add(&rest.row, curvature, slope);
        }
        sums
    }

    /// Finds the step of all states that minimises the sum of the quadratic functions of the cells.
    #[inline(always)]
    fn find_state_steps<S: Simd>(&mut self, simd: S) -> Result<(), NotConvex> {
        let chain = StageChain {
            stages: self.window.clone(),
            lengths: &self.lengths,
            free: &self.free,
            quadratics: &self.quadratics,
            states: &self.states,
            slope_from_rest: self.slope_from_rest(),
            to_rest: self.to_rest().unwrap_or_default(),
        };
        riccati::solve(simd, &chain, &mut self.gains, &mut self.steps)
    }

    #[inline(always)]
    fn find_slack_steps<S: Simd>(&mut self, simd: S, irrelevant_dual: f64) -> LargestDecreases {
        let mu = self.mu;
        let mut largest = LargestDecreases { irrelevant_dual, ..LargestDecreases::default() };
        for_each_block!(&mut self.blocks, &self.window, block => {
            block.find_slack_steps(simd, &self.states, &self.steps, mu, &mut largest);
        });
        for rest in self.rests.within_mut(&self.window) {
            let (x, dx) = (rest.x(&self.states), rest.x(&self.steps));
            let slack = &mut rest.slack;
            slack.ds = 1.0 - (x + dx) / rest.cap - slack.s;
            // Linearised complementarity: s z + s dz + z ds = mu.
            slack.dz = (mu - slack.z * slack.ds) / slack.s - slack.z;
            largest.slack = largest.slack.max(-slack.ds / slack.s);
            largest.dual = largest.dual.max(-slack.dz / slack.z);
            largest.x = largest.x.max(-dx / x);
        }
        largest
    }

    #[inline(always)]
    fn step(&mut self, primal: f64, dual: f64) {
        let window = self.window.clone();
        let states = &mut self.states[window.clone()];
        for (y, dy) in std::iter::zip(states, &self.steps[window.clone()]) {
            for a in 0..4 {
                y[a] += primal * dy[a];
            }
        }
        if window.end == self.lengths.len() {
            self.stop();
        }
        self.last = InteriorStep { mu: self.mu, primal, dual };
        for RestCell { slack, .. } in self.rests.within_mut(&self.window) {
            // Each slack and dual stops at its own boundary, as in `SlackPair::advance`.
            slack.s = (slack.s + primal * slack.ds).max(SETTINGS.min_share * slack.s);
            slack.z = (slack.z + dual * slack.dz).max(SETTINGS.min_share * slack.z);
        }
    }
}

/// Lowers `x` at nodes where the path at constant speed would already exceed the jerk limit. The
/// nodes around such a node are lowered as well, to values that the motion can reach from this
/// node. Otherwise the method would not converge from a start that exceeds a jerk limit many times
/// over.
fn lower_to_jerk(segments: &[LimitedSegment<'_>], mesh: &Mesh, x: &mut [f64]) {
    let mut lowered = false;
    for (k, (cell, geometry)) in std::iter::zip(&mesh.cells, &mesh.geometry).enumerate() {
        let segment = &segments[cell.segment];
        x[k] = x[k].min(segment.ramp_x(cell.from));
        if segment.is_line() {
            continue;
        }
        // Start, middle and end of the cell, among the seven places at which its geometry is known.
        let [start, middle, end] = [0, 3, 6].map(|place| {
            let [_, _, dddq] = segment.derivatives_at(geometry, place);
            segment.jerk_at_unit_speed(&dddq)
        });
        for (node, share) in [(k, start), (k, middle), (k + 1, middle), (k + 1, end)] {
            let steady = x[node] / SETTINGS.start_jerk;
            if share * steady * steady.sqrt() > 1.0 {
                lowered = true;
                x[node] = SETTINGS.start_jerk * share.powf(-2.0 / 3.0);
            }
        }
    }
    if !lowered {
        return;
    }
    // With constant jerk from rest, x^(3/4) is linear in sigma.
    let growth: Vec<_> = mesh
        .cells
        .iter()
        .map(|cell| {
            let segment = &segments[cell.segment];
            let [_, _, jerk] = segment.straight(segment.s(cell.from));
            SETTINGS.start_growth * (4.5 * jerk).sqrt() * cell.length
        })
        .collect();
    let mut root: Vec<_> = x.iter().map(|x| x.powf(0.75)).collect();
    for k in 1..root.len() {
        root[k] = root[k].min(root[k - 1] + growth[k - 1]);
    }
    for k in (1..root.len()).rev() {
        root[k - 1] = root[k - 1].min(root[k] + growth[k - 1]);
    }
    for (x, root) in x.iter_mut().zip(root) {
        *x = x.min(root.powf(4.0 / 3.0));
    }
}

struct Solve<'a> {
    solver: &'a mut Solver,
    gap: f64,
    stop: &'a AtomicBool,
}

impl pulp::WithSimd for Solve<'_> {
    type Output = Result<(), SolveError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        self.solver.iterate(simd, self.gap, self.stop)
    }
}

struct Restart<'a> {
    solver: &'a mut Solver,
    start: SlackStart,
}

impl pulp::WithSimd for Restart<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Solver { blocks, states, window, .. } = self.solver;
        for_each_block!(blocks, window, block => block.start(simd, states, self.start));
    }
}
