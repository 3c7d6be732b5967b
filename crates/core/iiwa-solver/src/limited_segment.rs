//! A segment of a section in the form that the jerk-limited solver uses.
//!
//! All segments of a section share one kind of path parameter, sigma in rad: the distance along a
//! line, and `reach (s + alpha(s))` in a blend. With sigma, q' and q'' are continuous from segment
//! to segment, and q''' jumps only across the path. With s, q''' would jump along the path as well,
//! and the solver would have to compensate by a jump of the second derivative of speed.

use iiwa_kin::{Joints, RampEnd, vector};
use iiwa_path::{Coordinates, PlanarGraph, Segment, ToolCoordinate};
use iiwa_program::{ByKind, LimitKind, MotionLimits};

use crate::{
    geometry::{Geometry, PlaceValues, SigmaDerivatives, in_plane},
    limiting_joints::LimitingJoints,
    peaks::{Peak, larger, parabola_error},
    rest_ramp::RestRamp,
    row_limit::{PathRow, RowLimits},
};

/// A sample of a motion along a segment that satisfies the velocity and acceleration limits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SweptNode {
    /// Time, in s, from an instant common to all segments.
    pub t_s: f64,
    /// Share of sigma along the segment, 0 to 1.
    pub p: f64,
    /// dp/dt, in 1/s.
    pub rate: f64,
    /// d2p/dt2 just after this node and just before the next one, in 1/s^2.
    pub u: [f64; 2],
}

/// A segment and its limits, as input of the solver.
pub struct LimitedSegment<'a> {
    /// Limits; infinite for the tool without a limit.
    limits: ByKind<Coordinates>,
    /// Reciprocals of the limits.
    pub(crate) inverse: ByKind<Coordinates>,
    pub(crate) length: f64,
    /// The acceleration-limited stamps.
    pub(crate) swept: &'a [SweptNode],
    shape: &'a dyn Segment,
    /// The tool coordinate, if it is limited.
    tool: Option<ToolCoordinate>,
    /// Shortest time in which the jerk of a joint or the tool builds up its acceleration, in s.
    pub(crate) min_build_up_s: f64,
    /// Unit of sigma of the shape, in rad.
    unit: f64,
    /// dq/dsigma of a straight segment.
    direction: Option<Joints>,
    /// Largest shares of the limits on a straight segment, for a speed, acceleration and jerk of
    /// sigma of 1 rad/s, rad/s^2 and rad/s^3.
    pub(crate) line_shares: Option<ByKind<f64>>,
    /// The curve as a graph in a plane, if it has this form.
    graph: Option<&'a dyn PlanarGraph>,
    /// Directions ahead and across of a line or a graph in a plane, perpendicular to each other.
    plane: [Joints; 2],
    /// Slope to add to that of the graph, due to the change to perpendicular directions.
    slope: f64,
    /// Coordinates that can be at their limits.
    pub(crate) limiting: ByKind<LimitingJoints>,
    /// Further limits, if any.
    rows: Option<&'a RowLimits>,
    /// Ramps at the rests at the start and at the end.
    ramps: [Option<RestRamp>; 2],
}

/// Largest share of a further limit, at any speed and acceleration that the other limits allow, up
/// to which it needs no row.
const NEAR_LIMIT: f64 = 0.97;

impl<'a> LimitedSegment<'a> {
    /// Creates the segment with its limits and at least two acceleration-limited stamps to start
    /// from.
    ///
    /// Returns `None` if the curvature jumps at its ends: the robot would have to stop there.
    #[must_use]
    pub fn new(
        shape: &'a dyn Segment,
        limits: &'a MotionLimits,
        swept: &'a [SweptNode],
    ) -> Option<Self> {
        if !shape.has_continuous_curvature() {
            return None;
        }
        let unit = shape.sigma_unit_rad();
        let tool = ToolCoordinate::new(shape, limits.tool());
        // All coordinates of a graph have to be in its plane, and the tool is not: a segment with a
        // limited tool is treated as a general curve.
        let is_straight = shape.is_straight() && tool.is_none();
        let direction = is_straight.then(|| shape.at(0.0).dq.map(|d| d / unit));
        let limits = ByKind::from_fn(|kind| {
            let tool = tool.as_ref().map_or(f64::INFINITY, |tool| tool.limits()[kind]);
            with_tool(limits.of(kind), tool)
        });
        let inverse = limits.map(|_, limits| limits.map(|limit| 1.0 / limit));
        let line_shares = direction.map(|direction| {
            inverse.map(|_, inverse| largest_share(&with_tool(&direction, 0.0), &inverse))
        });
        let min_build_up_s =
            std::iter::zip(&limits[LimitKind::Acceleration], &limits[LimitKind::Jerk])
                .filter(|(_, jerk)| jerk.is_finite())
                .map(|(acceleration, jerk)| acceleration / jerk)
                .fold(f64::INFINITY, f64::min);
        let mut segment = Self {
            limits,
            inverse,
            length: shape.sigma_length_rad(),
            swept,
            shape,
            tool,
            min_build_up_s,
            unit,
            direction,
            line_shares,
            graph: if tool.is_none() { shape.as_planar_graph() } else { None },
            plane: [direction.unwrap_or_default(), [0.0; 7]],
            slope: 0.0,
            limiting: ByKind::from_fn(|_| {
                if tool.is_some() { LimitingJoints::ALL } else { LimitingJoints::JOINTS }
            }),
            rows: None,
            ramps: [None; 2],
        };
        if let Some(graph) = segment.graph {
            // Made perpendicular: in a near turn-back, both directions would be almost parallel.
            let (ahead, across) = (graph.ahead(), graph.across());
            let square = vector::dot(&across, &across);
            if square > 0.0 {
                segment.slope = vector::dot(&ahead, &across) / square;
            }
            segment.plane = [vector::add_scaled(&ahead, -segment.slope, &across), across];
        }
        if segment.is_line() || segment.graph.is_some() {
            let [ahead, across] = &segment.plane;
            segment.limiting = segment.inverse.map(|_, inverse| {
                LimitingJoints::new(&std::array::from_fn(|j| {
                    [ahead[j] * inverse[j], across[j] * inverse[j]]
                }))
            });
        }
        Some(segment)
    }

    /// Adds further limits, which change along straight segments as well.
    #[must_use]
    pub fn with_rows(self, limits: &'a RowLimits) -> Self {
        Self { rows: (limits.count() > 0).then_some(limits), ..self }
    }

    /// Lowers the jerk limits next to the rest at one end.
    pub fn set_rest_ramp(&mut self, end: RampEnd, ramp: RestRamp) {
        let [start, stop] = &mut self.ramps;
        *match end {
            RampEnd::Start => start,
            RampEnd::Stop => stop,
        } = Some(ramp);
    }

    /// sigma, in rad, and (dsigma/dt)^2 of the acceleration-limited stamps.
    #[must_use]
    pub fn swept(&self) -> impl DoubleEndedIterator<Item = [f64; 2]> + Clone {
        self.swept.iter().map(|node| [node.p * self.length, self.swept_x(node)])
    }

    /// Share of the jerk limits that applies at `sigma`, in rad.
    pub(crate) fn jerk_rel(&self, sigma: f64) -> f64 {
        let ways = [sigma, self.length - sigma];
        let shares = std::iter::zip(&self.ramps, ways)
            .filter_map(|(ramp, way)| Some(ramp.as_ref()?.jerk_rel_at(way)));
        shares.fold(1.0, f64::min)
    }

    /// Largest x at `sigma`, in rad, for constant jerk from or to a rest with a ramp; infinite
    /// without a ramp.
    pub(crate) fn ramp_x(&self, sigma: f64) -> f64 {
        let ends = [(sigma, 0.0), (self.length - sigma, 1.0)];
        let ramps = std::iter::zip(&self.ramps, ends).filter(|(ramp, _)| ramp.is_some());
        ramps
            .map(|(_, (way, s))| (4.5 * self.straight(s)[2] * way * way).powf(2.0 / 3.0))
            .fold(f64::INFINITY, f64::min)
    }

    /// True if the segment has further limits.
    #[must_use]
    pub fn has_rows(&self) -> bool {
        self.rows.is_some()
    }

    /// Number of rows of further limits at each place.
    #[must_use]
    pub fn row_count(&self) -> usize {
        self.rows.map_or(0, RowLimits::count)
    }

    /// Rows of further limits at some sigma (rad), place after place: coefficients of the second
    /// derivative of sigma (rad/s^2) and of the square of the first, and an offset.
    #[must_use]
    pub fn rows(&self, sigma: &[f64]) -> Vec<PathRow> {
        let Some(limits) = self.rows else { return Vec::new() };
        let [mut q, mut first, mut second] = [(); 3].map(|()| Vec::with_capacity(sigma.len()));
        for sigma in sigma {
            let s = self.s(*sigma).clamp(0.0, 1.0);
            let [dq, ddq, _] = self.derivatives(s);
            q.push(self.shape.at(s).q);
            first.push(joints(&dq));
            second.push(joints(&ddq));
        }
        limits.rows(&q, &first, &second)
    }

    /// Marks in `near` the `rows` that can come near their limit at a place with these derivatives,
    /// at any speed and acceleration that the velocity and acceleration limits allow.
    pub(crate) fn mark_near(
        &self,
        [dq, ddq, _]: &SigmaDerivatives,
        rows: &[PathRow],
        near: &mut [bool],
    ) {
        let [velocity, acceleration] =
            [LimitKind::Velocity, LimitKind::Acceleration].map(|kind| &self.limits[kind]);
        let x = largest_multiple(dq, velocity).powi(2);
        let u = (0..8)
            .map(|j| (acceleration[j] + ddq[j].abs() * x) / dq[j].abs())
            .fold(f64::INFINITY, |min, u| if u < min { u } else { min });
        for (near, row) in near.iter_mut().zip(rows) {
            let moving = row.acceleration.abs() * u + row.square.abs() * x;
            let total = moving + row.offset.abs();
            // NaN means that no other limit bounds the speed.
            *near |= total >= NEAR_LIMIT || total.is_nan();
        }
    }

    /// Largest acceleration of sigma (rad/s^2) that further limits allow at a stop at `s`, either
    /// way.
    fn row_acceleration(&self, s: f64) -> f64 {
        let rows = self.rows(&[s * self.length]);
        rows.iter()
            .map(|row| (1.0 - row.offset.abs()) / row.acceleration.abs())
            .fold(f64::INFINITY, f64::min)
    }

    /// Largest x that further limits allow at `sigma`, where the second derivative of sigma is `u`
    /// times x.
    pub(crate) fn row_cap(&self, sigma: f64, u: f64) -> f64 {
        let rows = self.rows(&[sigma]);
        rows.iter()
            .map(|row| {
                let by_x = row.acceleration * u + row.square;
                (1.0 - row.offset.copysign(row.offset * by_x)) / by_x.abs()
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// True if the segment is straight and only joints are limited.
    #[must_use]
    pub fn is_line(&self) -> bool {
        self.direction.is_some()
    }

    /// True if the robot may as well stop at the end of the segment: on lines, and on lines and
    /// circles of the TCP, whose limits hardly change.
    #[must_use]
    pub fn is_stop(&self) -> bool {
        self.is_line() || self.shape.has_even_tool_way()
    }

    /// Largest speed, acceleration and jerk of sigma by the tool limits, in rad/s, rad/s^2 and
    /// rad/s^3, if the tool moves evenly and all three are limited; jerk for a motion from rest to
    /// rest.
    #[must_use]
    pub fn even_tool_limits(&self) -> Option<[f64; 3]> {
        if self.tool.is_none() || !self.shape.has_even_tool_way() {
            return None;
        }
        let is_even = |s| {
            let [_, second, third] = self.derivatives(s);
            second[7] == 0.0 && third[7] == 0.0
        };
        if ![0.0, 0.5, 1.0].into_iter().all(is_even) {
            // The path parameter is not the distance.
            return None;
        }
        let [direction, ..] = self.derivatives(0.0);
        let mut limits = LimitKind::ALL.map(|kind| self.limits[kind][7] / direction[7]);
        // One jerk for both ramps, with the same total time.
        let [start, stop] = [0.0, self.length].map(|sigma| 1.0 / self.jerk_rel(sigma));
        limits[2] /= 0.5 * (start + stop);
        limits.iter().all(|limit| limit.is_finite()).then_some(limits)
    }

    /// True if the tool is limited.
    pub(crate) fn has_tool(&self) -> bool {
        self.tool.is_some()
    }

    /// Length of the segment in sigma, in rad.
    #[must_use]
    pub fn length_rad(&self) -> f64 {
        self.length
    }

    /// s, 0 to 1, at `sigma`, in rad.
    pub(crate) fn s(&self, sigma: f64) -> f64 {
        self.shape.s_at(sigma / self.unit)
    }

    /// (dsigma/dt)^2 at a sample of the acceleration-limited stamps.
    pub(crate) fn swept_x(&self, node: &SweptNode) -> f64 {
        (node.rate * self.length).powi(2)
    }

    /// Derivatives of q with respect to sigma at some sigma, in rad.
    #[must_use]
    pub fn geometry(&self, sigma: &PlaceValues) -> Geometry {
        if self.is_line() {
            return Geometry::Line;
        }
        match self.graph {
            Some(graph) => {
                let [slope, second, third] = graph.derivatives(sigma);
                Geometry::Planar([slope.map(|slope| slope + self.slope), second, third])
            }
            None => Geometry::General(Box::new(
                sigma.map(|sigma| self.derivatives(self.s(sigma).clamp(0.0, 1.0))),
            )),
        }
    }

    /// First to third derivative of q with respect to sigma at one place of `geometry`.
    pub(crate) fn derivatives_at(&self, geometry: &Geometry, place: usize) -> SigmaDerivatives {
        let [ahead, across] = &self.plane;
        match geometry {
            Geometry::Line => [with_tool(ahead, 0.0), [0.0; 8], [0.0; 8]],
            Geometry::Planar(_) => {
                let [one, two, three] = geometry.across(place);
                [
                    with_tool(&vector::add_scaled(ahead, one, across), 0.0),
                    with_tool(&vector::scale(two, across), 0.0),
                    with_tool(&vector::scale(three, across), 0.0),
                ]
            }
            Geometry::General(derivatives) => derivatives[place],
        }
    }

    /// First to third derivative of q with respect to sigma at `s`; in 1, 1/rad and 1/rad^2.
    pub(crate) fn derivatives(&self, s: f64) -> SigmaDerivatives {
        if let Some(direction) = &self.direction {
            return [with_tool(direction, 0.0), [0.0; 8], [0.0; 8]];
        }
        let joints = self.shape.sigma_derivatives(s);
        let tool = self.tool.map_or([0.0; 3], |tool| tool.sigma_derivatives(self.shape, s));
        std::array::from_fn(|k| with_tool(&joints[k], tool[k]))
    }

    /// Distance in the middle of a blend over which it turns back, in rad: infinite for a line,
    /// long for a blend with a small turn, and short for a blend that turns back at low speed.
    pub(crate) fn turn_back(&self) -> f64 {
        if self.is_line() {
            return f64::INFINITY;
        }
        // q is q' (sigma - middle) + q'' (sigma - middle)^2 / 2 there.
        let [dq, ddq, _] = self.derivatives(0.5);
        let norm = |row: &Coordinates| row[..7].iter().map(|v| v * v).sum::<f64>().sqrt();
        let straight = norm(&dq) / norm(&ddq);
        let [speed, acceleration, jerk] = LimitKind::ALL.map(|kind| &self.limits[kind]);
        // The tool never turns back.
        let turn = (0..7).map(|j| {
            // Joint j decelerates from full speed to rest over the distance `way`.
            let speed = speed[j];
            let way = speed * (speed / acceleration[j]).max((speed / jerk[j]).sqrt());
            (way / ddq[j].abs()).sqrt()
        });
        straight + turn.fold(f64::INFINITY, f64::min)
    }

    /// Time in which jerk builds up acceleration at `s`, in s, until acceleration or speed is at
    /// its limit.
    pub(crate) fn build_up_s(&self, s: f64) -> f64 {
        let [speed, acceleration, jerk] = self.straight(s);
        let acceleration = acceleration.min(self.row_acceleration(s));
        (acceleration / jerk).min((speed / jerk).sqrt())
    }

    /// Distance from a rest at `s` over which curvature takes at most a `share` of a jerk limit, in
    /// rad.
    ///
    /// For a constant third derivative j of sigma, `sigma = j t^3 / 6` and the jerk is
    /// `j (q' + 9 q'' sigma + 14 q''' sigma^2)` with the derivatives at the rest, up to higher
    /// powers.
    pub(crate) fn even_way(&self, s: f64, share: f64) -> f64 {
        let [_, ddq, dddq] = self.derivatives(s);
        let [_, _, jerk] = self.straight(s);
        let jerk_share = |row| jerk * largest_share(row, &self.inverse[LimitKind::Jerk]);
        (share / (9.0 * jerk_share(&ddq))).min((share / (14.0 * jerk_share(&dddq))).sqrt())
    }

    /// Straight stopping distance from the start of the segment, in rad; `before` is the segment
    /// that ends there.
    #[must_use]
    pub fn stop_rad(&self, before: Option<&Self>) -> f64 {
        let swept = self.swept.first().map_or(0.0, |node| self.swept_x(node));
        let x = [(Some(self), 0.0), (before, 1.0)]
            .into_iter()
            .filter_map(|(segment, s)| {
                let [_, _, dddq] = segment?.derivatives(s);
                Some(segment?.jerk_at_unit_speed(&dddq).powf(-2.0 / 3.0))
            })
            .fold(swept, f64::min);
        let speed = x.sqrt();
        let [_, acceleration, jerk] = self.straight(0.0);
        let build_up_s = (acceleration / jerk).min((speed / jerk).sqrt());
        if build_up_s > 0.0 {
            0.5 * speed * (speed / (jerk * build_up_s) + build_up_s)
        } else {
            0.0
        }
    }

    /// Largest share of a jerk limit for a constant speed of sigma of 1 rad/s and the third
    /// derivative `dddq` of the curve; proportional to the cube of the speed.
    pub(crate) fn jerk_at_unit_speed(&self, dddq: &Coordinates) -> f64 {
        largest_share(dddq, &self.inverse[LimitKind::Jerk])
    }

    /// Largest speed, acceleration and jerk of sigma at `s` on a straight path from there; in
    /// rad/s, rad/s^2 and rad/s^3.
    #[must_use]
    pub fn straight(&self, s: f64) -> [f64; 3] {
        let [direction, ..] = self.derivatives(s);
        let [speed, acceleration, jerk] =
            LimitKind::ALL.map(|kind| largest_multiple(&direction, &self.limits[kind]));
        if self.ramps == [None; 2] {
            return [speed, acceleration, jerk];
        }
        [speed, acceleration, jerk * self.jerk_rel(self.shape.sigma(s)[0] * self.unit)]
    }

    /// Signed shares of all limits at one place of `geometry`, for this speed, acceleration and
    /// jerk of sigma; for each kind and coordinate.
    #[inline(always)]
    #[must_use]
    pub fn shares(
        &self,
        geometry: &Geometry,
        place: usize,
        rates: [f64; 3],
    ) -> ByKind<Coordinates> {
        let mut shares = [[0.0; 8]; 3];
        if let Geometry::General(derivatives) = geometry {
            let ([dq, ddq, dddq], [v, a, j]) = (&derivatives[place], rates);
            for i in 0..8 {
                shares[0][i] = dq[i] * v;
                shares[1][i] = dq[i] * a + ddq[i] * v * v;
                shares[2][i] = dq[i] * j + 3.0 * ddq[i] * v * a + dddq[i] * v * v * v;
            }
        } else {
            let [ahead, across] = &self.plane;
            let of_plane = in_plane(geometry.across(place), rates);
            for (shares, [along, aside]) in std::iter::zip(&mut shares, of_plane) {
                for i in 0..7 {
                    shares[i] = ahead[i] * along + across[i] * aside;
                }
            }
        }
        for (shares, inverse) in std::iter::zip(&mut shares, self.inverse.as_array()) {
            for i in 0..8 {
                shares[i] *= inverse[i];
            }
        }
        ByKind::from_array(shares)
    }

    /// Shares of all limits of each coordinate at all places of `geometry`.
    #[inline(always)]
    fn sampled_shares(
        &self,
        geometry: &Geometry,
        rates: &[PlaceValues; 3],
    ) -> [[PlaceValues; 8]; 3] {
        let mut shares = [[PlaceValues::default(); 8]; 3];
        for i in 0..PlaceValues::default().len() {
            let lane_shares = self.shares(geometry, i, rates.map(|rate| rate[i])).into_array();
            for (shares, lane) in std::iter::zip(&mut shares, lane_shares) {
                std::iter::zip(shares, lane).for_each(|(share, value)| share[i] = value);
            }
        }
        shares
    }

    /// Error bounds of the shares that [`largest_shares`](Self::largest_shares) finds. They are
    /// negligible on lines and graphs in a plane, whose derivatives are polynomials along the whole
    /// segment.
    pub(crate) fn share_errors(
        &self,
        geometry: &Geometry,
        rates: &[PlaceValues; 3],
    ) -> ByKind<f64> {
        let Geometry::General(_) = geometry else { return ByKind::default() };
        let limited = if self.has_tool() { 8 } else { 7 };
        ByKind::from_array(
            self.sampled_shares(geometry, rates)
                .map(|shares| shares[..limited].iter().map(parabola_error).fold(0.0, larger)),
        )
    }

    /// Largest shares of the limits from samples of a stretch: its `geometry` at
    /// [`SHARES`](crate::peaks::SHARES) of it, and speed, acceleration and jerk of sigma there.
    #[inline(always)]
    pub(crate) fn largest_shares(
        &self,
        geometry: &Geometry,
        rates: &[PlaceValues; 3],
    ) -> ByKind<f64> {
        // Loops: closures that `map` calls would be compiled without vector registers.
        let mut largest = [0.0; 3];
        match geometry {
            Geometry::Line => {
                let shares = self.line_shares.unwrap_or_default().into_array();
                for order in 0..3 {
                    let mut peak = Peak::default();
                    peak.add(&rates[order]);
                    largest[order] = peak.get() * shares[order];
                }
            }
            Geometry::Planar([one, two, three]) => {
                let [v, a, j] = rates;
                // Coefficients of the direction ahead are the rates themselves.
                let mut aside = [PlaceValues::default(); 3];
                for i in 0..v.len() {
                    let [[_, first], [_, second], [_, third]] =
                        in_plane([one[i], two[i], three[i]], [v[i], a[i], j[i]]);
                    (aside[0][i], aside[1][i], aside[2][i]) = (first, second, third);
                }
                for order in 0..3 {
                    let mut peak = Peak::default();
                    for [ahead, across] in self.limiting.as_array()[order].points() {
                        let mut shares = PlaceValues::default();
                        for i in 0..shares.len() {
                            shares[i] = ahead * rates[order][i] + across * aside[order][i];
                        }
                        peak.add(&shares);
                    }
                    largest[order] = peak.get();
                }
            }
            Geometry::General(_) => {
                let limited = if self.has_tool() { 8 } else { 7 };
                let shares = self.sampled_shares(geometry, rates);
                for order in 0..3 {
                    let mut peak = Peak::default();
                    for shares in &shares[order][..limited] {
                        peak.add(shares);
                    }
                    largest[order] = peak.get();
                }
            }
        }
        ByKind::from_array(largest)
    }
}

/// Largest `|derivative_j| inverse_j`, with the reciprocals of the limits.
pub(crate) fn largest_share(derivative: &Coordinates, inverse: &Coordinates) -> f64 {
    std::iter::zip(derivative, inverse).map(|(d, i)| d.abs() * i).fold(0.0, f64::max)
}

/// Largest multiple of `direction` within the limits.
fn largest_multiple(direction: &Coordinates, limits: &Coordinates) -> f64 {
    std::iter::zip(direction, limits).map(|(d, limit)| limit / d.abs()).fold(f64::MAX, f64::min)
}

/// Values of the joints alone.
fn joints(coordinates: &Coordinates) -> Joints {
    std::array::from_fn(|j| coordinates[j])
}

/// Values of the joints, followed by that of the tool.
#[inline(always)]
fn with_tool(joints: &Joints, tool: f64) -> Coordinates {
    let mut all = [tool; 8];
    all[..7].copy_from_slice(joints);
    all
}
