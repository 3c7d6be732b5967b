//! Time-optimal motion along a window of segments.

use std::sync::atomic::AtomicBool;

use crate::{
    attempt::{Attempt, Window},
    limited_segment::LimitedSegment,
    mesh::Mesh,
    settings::{AttemptSettings, SETTINGS},
    solver::SolveError,
};

/// The best motion found for a window.
pub struct Solution(Attempt);

impl Solution {
    /// Solves for `window` on a mesh that is `refinement` times as fine as usual.
    ///
    /// # Errors
    ///
    /// If no attempt is near enough to the optimum, or if `stop` is set, which is checked before
    /// each Newton step.
    pub fn find(
        window: &Window<'_, '_>,
        refinement: f64,
        stop: &AtomicBool,
    ) -> Result<Self, SolveError> {
        let [enough, longest] = SETTINGS.refinement.longer;
        let mut best: Option<Attempt> = None;
        // Two given states may have no feasible motion between them, so one attempt is enough.
        let attempts = if window.exit.is_some() { 1 } else { SETTINGS.refinement.attempts.len() };
        for settings in &SETTINGS.refinement.attempts[..attempts] {
            let settings =
                AttemptSettings { refinement: refinement * settings.refinement, ..*settings };
            let attempt = Attempt::run(window, settings, stop)?;
            let Some(attempt) = attempt else { continue };
            if attempt.longer() <= best.as_ref().map_or(longest, Attempt::longer) {
                best = Some(attempt);
            }
            if best.as_ref().is_some_and(|best| best.longer() <= enough) {
                break;
            }
        }
        best.map(Self).ok_or(SolveError::NotConverged)
    }

    /// The cells.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.0.mesh
    }

    /// Factor on all times that makes the motion satisfy the limits: 1, unless the solver got
    /// stuck. Only [`row_shares`](Self::row_shares) and [`duration_s`](Self::duration_s) include
    /// this factor.
    #[must_use]
    pub fn time_scale(&self) -> f64 {
        self.0.time_scale
    }

    /// x (rad^2/s^2) and its first two derivatives with respect to sigma (rad/s^2 and 1/s^2) at the
    /// share `f` of `cell`, counted without the two cells that touch rest.
    #[must_use]
    pub fn at(&self, cell: usize, f: f64) -> [f64; 3] {
        self.0.solver.at(cell, f)
    }

    /// Speed, acceleration and jerk of sigma at the share `f` of `cell`, in rad/s, rad/s^2 and
    /// rad/s^3.
    #[must_use]
    pub fn rates(&self, cell: usize, f: f64) -> [f64; 3] {
        self.0.rates(cell, f)
    }

    /// Shares of the rows of further limits at the share `f` of `cell`, with the time scale; empty
    /// if the segment of the cell has no further limits.
    pub fn row_shares(&self, cell: usize, f: f64) -> impl Iterator<Item = f64> {
        self.0.row_shares(cell, f, self.time_scale())
    }

    /// x and dx/dsigma at the start of a segment: an [entry](Window::entry). Returns `None` if the
    /// segment starts at rest.
    #[must_use]
    pub fn entry(&self, segment: usize) -> Option<[f64; 2]> {
        let cell = self.0.mesh.cells.iter().position(|cell| cell.segment == segment)?;
        let [x, dx, _] = self.at(cell, 0.0);
        Some([x, dx])
    }

    /// Duration with the time scale, in s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        let cells = 0..self.0.mesh.cells.len();
        let moving: f64 = cells.map(|cell| self.cell_s(cell, 0.0, 1.0)).sum();
        self.time_scale() * (self.start_s() + moving + self.stop_s())
    }

    /// Duration of the cell that starts at rest, in s; 0 without one.
    #[must_use]
    pub fn start_s(&self) -> f64 {
        self.0.solver.start_s()
    }

    /// Duration of the cell that ends at rest, in s; 0 without one.
    #[must_use]
    pub fn stop_s(&self) -> f64 {
        self.0.solver.stop_s()
    }

    /// Time from the share `from` to the share `to` of an inner cell, in s.
    #[must_use]
    pub fn cell_s(&self, cell: usize, from: f64, to: f64) -> f64 {
        self.0.duration_s(cell, from, to)
    }

    /// Number of parts into which to divide an inner cell of `segment` so that a polynomial of
    /// degree five in time approximates each part: many where the cell is slow, or where x changes
    /// much.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "it is from 2 to 64"
    )]
    pub fn parts(&self, segment: &LimitedSegment<'_>, cell: usize) -> u32 {
        let [start, end] = [0.0, 1.0].map(|f| self.at(cell, f)[0]);
        let doublings = (end / start).log2().abs();
        (2.0 + 2.0 * doublings + self.0.slowness(segment, cell)).min(64.0) as u32
    }
}
