//! Stamps of solutions of the jerk-limited solver.

use std::ops::Range;

use iiwa_path::PLACES;
use iiwa_solver::{Cell, Geometry, LimitedSegment, Mesh, Solution, Window};

use crate::{
    interval::{Node, later},
    limit_usage::LimitUsage,
};

/// Stamps of one segment.
pub(crate) struct SegmentStamps {
    /// Range of the segment's nodes among all nodes.
    pub(crate) nodes: Range<usize>,
    pub(crate) usage: LimitUsage,
}

/// Stamps of a section.
#[derive(Default)]
pub(crate) struct Stamps {
    pub(crate) nodes: Vec<Node>,
    pub(crate) segments: Vec<SegmentStamps>,
}

/// Builder of the stamps of a section, window after window.
pub(crate) struct Stamper {
    start_s: f64,
    /// First segment with stamps.
    first: usize,
    /// Time since the start of the section, in s.
    t_s: f64,
    /// Factor by which the added solution is slowed down.
    time_scale: f64,
    stamps: Stamps,
}

impl Stamper {
    /// Creates an empty builder for a section that starts at `start_s`, from the segment `first`
    /// on.
    pub(crate) fn new(start_s: f64, first: usize) -> Self {
        Self { start_s, first, t_s: 0.0, time_scale: 1.0, stamps: Stamps::default() }
    }

    /// Returns the stamps.
    pub(crate) fn finish(self) -> Stamps {
        self.stamps
    }

    /// Adds a node at a sigma and an instant, with the way and the time to the next node; x and its
    /// derivative with respect to sigma are those before the motion is slowed down.
    fn node(
        &mut self,
        segment: &LimitedSegment<'_>,
        [sigma, way]: [f64; 2],
        [t_s, dt_s]: [f64; 2],
        [x, dx]: [f64; 2],
    ) {
        let time_scale = self.time_scale;
        let length = segment.length_rad();
        let rate = x.sqrt() / (length * time_scale);
        let u = 0.5 * dx / (length * time_scale * time_scale);
        self.stamps.nodes.push(Node {
            t_s,
            dt_s,
            p: sigma / length,
            dp: way / length,
            rate,
            u: [u; 2],
        });
    }

    /// Adds the usage at a `place` of some `geometry` for a time `dt`, with speed, acceleration and
    /// jerk of sigma before the motion is slowed down.
    #[inline(always)]
    fn usage(
        &mut self,
        segment: &LimitedSegment<'_>,
        (geometry, place): (&Geometry, usize),
        [v, a, j]: [f64; 3],
        dt: f64,
    ) {
        let time_scale = self.time_scale;
        let scaled = [v / time_scale, a / time_scale.powi(2), j / time_scale.powi(3)];
        if let Some(stamps) = self.stamps.segments.last_mut() {
            stamps.usage.sample(&segment.shares(geometry, place, scaled), dt);
        }
    }

    /// Adds shares of further limits for a time `dt`.
    fn rows(&mut self, shares: impl Iterator<Item = f64>, dt: f64) {
        if let Some(stamps) = self.stamps.segments.last_mut() {
            stamps.usage.sample_rows(shares, dt);
        }
    }

    /// Adds a cell next to rest, in which jerk is constant.
    fn rest(&mut self, segment: &LimitedSegment<'_>, cell: &Cell, seconds: f64) {
        let jerk = 6.0 * cell.length / seconds.powi(3);
        let half = [0.125 * jerk * seconds * seconds, 0.5 * jerk * seconds, jerk];
        let geometry = segment.geometry(&[cell.from; PLACES]);
        let dt = seconds * self.time_scale;
        self.usage(segment, (&geometry, 0), half, dt);
        let [speed, acceleration, _] = half;
        let [speed, acceleration] =
            [speed / self.time_scale, acceleration / self.time_scale.powi(2)];
        let rows = segment.rows(&[cell.from]);
        self.rows(rows.iter().map(|row| row.at(speed, acceleration)), dt);
    }

    /// Begins the next segment, unless it has begun.
    fn begin(&mut self, segment: usize) {
        if self.stamps.segments.len() <= segment - self.first {
            let nodes = self.stamps.nodes.len()..self.stamps.nodes.len();
            self.stamps.segments.push(SegmentStamps { nodes, usage: LimitUsage::default() });
        }
    }

    /// Ends the current segment.
    fn end(&mut self) {
        if let Some(stamps) = self.stamps.segments.last_mut() {
            stamps.nodes.end = self.stamps.nodes.len();
        }
    }

    /// Adds the stamps of the segments of `window` before the segment `end`.
    pub(crate) fn add(&mut self, solution: &Solution, window: &Window<'_, '_>, end: usize) {
        pulp::Arch::new().dispatch(Add { stamper: self, solution, window, end });
    }

    #[inline(always)]
    fn add_all(&mut self, solution: &Solution, window: &Window<'_, '_>, end: usize) {
        self.time_scale = solution.time_scale();
        let segments = window.segments;
        let Mesh { from_rest, cells, to_rest, .. } = solution.mesh();
        if let Some(cell) = from_rest {
            let segment = &segments[cell.segment];
            let dt = self.time_scale * solution.start_s();
            self.begin(cell.segment);
            self.node(segment, [0.0, cell.length], [self.t_s, dt], [0.0; 2]);
            self.rest(segment, cell, solution.start_s());
            self.t_s = later(self.start_s, self.t_s, dt);
        }
        for (k, cell) in cells.iter().enumerate().take_while(|(_, cell)| cell.segment < end) {
            let segment = &segments[cell.segment];
            self.begin(cell.segment);
            let parts = solution.parts(segment, k);
            let mut geometry = Geometry::Line;
            for part in 0..parts {
                let share = |half: f64| (f64::from(part) + half) / f64::from(parts);
                let [from, middle, to] = [0.0, 0.5, 1.0].map(share);
                let place = part as usize % PLACES;
                if place == 0 {
                    // Places beyond the last part are not used.
                    let middles = std::array::from_fn(|i| share(i as f64 + 0.5).min(1.0));
                    geometry = segment.geometry(&middles.map(|f: f64| cell.from + f * cell.length));
                }
                let [x, dx, _] = solution.at(k, from);
                let dt = self.time_scale * solution.cell_s(k, from, to);
                let way = [cell.from + from * cell.length, (to - from) * cell.length];
                self.node(segment, way, [self.t_s, dt], [x, dx]);
                self.usage(segment, (&geometry, place), solution.rates(k, middle), dt);
                if segment.has_rows() {
                    self.rows(solution.row_shares(k, middle), dt);
                }
                self.t_s = later(self.start_s, self.t_s, dt);
            }
            if cells.get(k + 1).is_none_or(|next| next.segment != cell.segment) {
                let [x, dx, _] = solution.at(k, 1.0);
                // The exact end of the segment, unless a cell to rest follows.
                let rests = to_rest.as_ref().is_some_and(|rest| rest.segment == cell.segment);
                let end = if rests { cell.from + cell.length } else { segment.length_rad() };
                self.node(segment, [end, 0.0], [self.t_s, 0.0], [x, dx]);
                self.end();
            }
        }
        if let Some(to_rest) = to_rest.as_ref().filter(|rest| rest.segment < end) {
            let segment = &segments[to_rest.segment];
            let length = segment.length_rad();
            self.begin(to_rest.segment);
            let dt = self.time_scale * solution.stop_s();
            // The node before was the last of its cells and got neither way nor time.
            if let Some(before) = self.stamps.nodes.last_mut() {
                (before.dp, before.dt_s) = (to_rest.length / length, dt);
            }
            self.rest(segment, to_rest, solution.stop_s());
            self.t_s = later(self.start_s, self.t_s, dt);
            self.node(segment, [length, 0.0], [self.t_s, 0.0], [0.0; 2]);
            self.end();
        }
    }
}

/// Stamps of a window, with the widest vector instructions of the machine.
struct Add<'a, 'b, 'c> {
    stamper: &'a mut Stamper,
    solution: &'a Solution,
    window: &'a Window<'b, 'c>,
    end: usize,
}

impl pulp::WithSimd for Add<'_, '_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.stamper.add_all(self.solution, self.window, self.end);
    }
}
