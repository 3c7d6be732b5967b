//! Motion along a spline within the model's limits of speed and acceleration, as the start of the
//! solver.

use iiwa_kin::RampEnd;
use iiwa_path::Segment;
use iiwa_solver::SweptNode;

use super::limits::{SpeedLimitedSegment, SpeedLimits};
use crate::grid::Grid;

/// Node of a grid over a segment.
#[derive(Clone, Copy, Debug)]
struct SweptPlace {
    /// sigma from the previous rest, in rad.
    sigma: f64,
    /// Share of the segment's sigma.
    p: f64,
    limits: SpeedLimits,
    /// Largest (dsigma/dt)^2, in rad^2/s^2.
    x: f64,
}

impl SweptPlace {
    /// Returns the largest d2sigma/dt2 at `x` = (dsigma/dt)^2.
    fn acceleration(&self, x: f64) -> f64 {
        let [first, second, _] = self.limits.way;
        ((self.limits.acceleration - second.abs() * x) / first).max(0.0)
    }
}

/// Nodes of all segments between two rests.
pub(super) struct SplineSweep {
    places: Vec<SweptPlace>,
    /// Length of each segment in rad, and its number of nodes.
    segments: Vec<(f64, usize)>,
}

impl SplineSweep {
    /// Creates the nodes with the speed limits alone.
    pub(super) fn new(segments: &[SpeedLimitedSegment<'_>], grid: &Grid) -> Self {
        let mut sweep = Self { places: Vec::new(), segments: Vec::with_capacity(segments.len()) };
        let mut start = 0.0;
        for segment in segments {
            let length = segment.sigma_length_rad();
            let (shape, _) = segment.shape_and_limits();
            let nodes = grid.nodes_on(shape);
            let places = grid.s_on(shape).into_iter().zip(nodes.iter()).map(|(s, node)| {
                let limits = segment.limits_at(s);
                let x = (limits.speed / limits.way[0]).powi(2);
                SweptPlace { sigma: start + node.p * length, p: node.p, limits, x }
            });
            sweep.places.extend(places);
            sweep.segments.push((length, nodes.len()));
            start += length;
        }
        sweep
    }

    /// Returns the points by sigma in rad, with the limits of the speeds of y and of sigma.
    pub(super) fn speeds(&self) -> Vec<[f64; 3]> {
        let speeds = |place: &SweptPlace| [place.sigma, place.limits.speed, place.x.sqrt()];
        self.places.iter().map(speeds).collect()
    }

    /// Returns the largest speed of y anywhere, without the acceleration limits.
    pub(super) fn top_speed(&self) -> f64 {
        self.places.iter().map(|place| place.limits.speed).fold(0.0, f64::max)
    }

    /// Returns the way from the rest at an end on which the robot reaches a speed limit, in rad.
    pub(super) fn way_to_limit_rad(&self, end: RampEnd) -> f64 {
        let last = self.places.last().map_or(0.0, |place| place.sigma);
        match end {
            RampEnd::Start => way_to_limit(self.places.iter().map(|place| (place.sigma, place))),
            RampEnd::Stop => {
                way_to_limit(self.places.iter().rev().map(|place| (last - place.sigma, place)))
            }
        }
    }

    /// Returns the nodes of each segment of the motion from rest to rest that keeps the
    /// acceleration limits as well.
    pub(super) fn nodes(mut self) -> Vec<Vec<SweptNode>> {
        lower(self.places.iter_mut());
        lower(self.places.iter_mut().rev());
        let mut places = self.places.as_slice();
        let mut t_s = 0.0;
        let mut segments = Vec::with_capacity(self.segments.len());
        for (length, count) in self.segments {
            let (segment_places, rest) = places.split_at(count);
            places = rest;
            let mut nodes = Vec::with_capacity(count);
            let mut u = 0.0;
            for (i, place) in segment_places.iter().enumerate() {
                let rate = place.x.sqrt() / length;
                let mut dt_s = 0.0;
                if let Some(next) = segment_places.get(i + 1) {
                    let dp = next.p - place.p;
                    let next_rate = next.x.sqrt() / length;
                    u = 0.5 * (next_rate * next_rate - rate * rate) / dp;
                    dt_s = 2.0 * dp / (rate + next_rate);
                }
                nodes.push(SweptNode { t_s, p: place.p, rate, u: [u; 2] });
                t_s += dt_s;
            }
            segments.push(nodes);
        }
        segments
    }
}

/// Returns the way from rest on which a speed limit is reached, without jerk limits; the whole way
/// if none is reached.
fn way_to_limit<'a>(places: impl Iterator<Item = (f64, &'a SweptPlace)>) -> f64 {
    let (mut x, mut way) = (0.0, 0.0);
    for (next, place) in places {
        x += 2.0 * place.acceleration(x) * (next - way);
        way = next;
        if x >= place.x {
            break;
        }
    }
    way
}

/// Lowers x to the values that are reachable from the first point, at rest.
fn lower<'a>(places: impl Iterator<Item = &'a mut SweptPlace>) {
    let mut before: Option<SweptPlace> = None;
    for place in places {
        let reached = before.map_or(0.0, |before| {
            before.x + 2.0 * before.acceleration(before.x) * (place.sigma - before.sigma).abs()
        });
        place.x = place.x.min(reached);
        before = Some(*place);
    }
}
