//! A piece of a section, as the jerk-limited solver sees it.
//!
//! All pieces of a section share one kind of path parameter, sigma in rad: the way along a line, and
//! `reach (s + alpha(s))` in a blend. With it q' and q'' continue from piece to piece, and of q''' only
//! the part across the path jumps. With s as the parameter the part along the path would jump as
//! well: the solver would have to make the speed's own second derivative jump against it.

use iiwa_kin::{Joints, RampEnd, vector};
use iiwa_path::{Coordinates, PlanarGraph, Segment, ToolCoordinate};
use iiwa_program::{ByKind, LimitKind, MotionLimits};

use crate::{
    geometry::{Geometry, Places, SigmaDerivatives, in_plane},
    limiting_joints::LimitingJoints,
    peaks::{Peak, larger, parabola_error},
    rest_ramp::RestRamp,
    row_limit::{PathRow, RowLimits},
};

/// A sample of a motion along a segment that keeps the limits of velocity and acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SweptNode {
    /// Time, in s, since any instant that all segments share.
    pub t_s: f64,
    /// Share of the segment's sigma, 0 to 1.
    pub p: f64,
    /// dp/dt, in 1/s.
    pub rate: f64,
    /// d2p/dt2 just after this node and just before the next one, in 1/s^2.
    pub u: [f64; 2],
}

/// A segment and its limits, as the solver sees them.
pub struct LimitedSegment<'a> {
    /// Infinite for the tool where it has none.
    limits: ByKind<Coordinates>,
    /// One over the limits.
    pub(crate) inverse: ByKind<Coordinates>,
    pub(crate) length: f64,
    /// The acceleration-limited stamps.
    pub(crate) swept: &'a [SweptNode],
    shape: &'a dyn Segment,
    /// The coordinate of the tool, if it is limited.
    tool: Option<ToolCoordinate>,
    /// The shortest time in which the jerk of a joint or the tool builds up its acceleration, in s.
    pub(crate) least_build_up_s: f64,
    /// The unit of its sigma, in rad.
    unit: f64,
    /// dq/dsigma of a straight segment.
    direction: Option<Joints>,
    /// The curve as a graph in a plane, if it is one.
    graph: Option<&'a dyn PlanarGraph>,
    /// The directions ahead and across of a line or a graph in a plane.
    plane: [Joints; 2],
    /// What the slope of the graph has to be raised by in these directions.
    slope: f64,
    /// The coordinates that can be at their limits.
    pub(crate) limiting: ByKind<LimitingJoints>,
    /// Further limits, if there are any.
    rows: Option<&'a RowLimits>,
    /// The ramps at the rests at its start and its end.
    ramps: [Option<RestRamp>; 2],
}

/// Largest share of a further limit, at any speed and acceleration that the other limits allow, up to which it needs no row.
const NEAR_LIMIT: f64 = 0.97;

impl<'a> LimitedSegment<'a> {
    /// The segment under its limits, with the acceleration-limited stamps to start from, at least two.
    ///
    /// None if the curvature jumps at its ends: then the arm would have to stop there.
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
        // In a plane, all coordinates would have to be: where the tool is limited, it is a curve like any other.
        let is_straight = shape.is_straight() && tool.is_none();
        let direction = is_straight.then(|| shape.at(0.0).dq.map(|d| d / unit));
        let limits = ByKind::from_fn(|kind| {
            let tool = tool.as_ref().map_or(f64::INFINITY, |tool| tool.limits()[kind]);
            with_tool(limits.of(kind), tool)
        });
        let inverse = limits.map(|_, limits| limits.map(|limit| 1.0 / limit));
        let least_build_up_s =
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
            least_build_up_s,
            unit,
            direction,
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
            // Perpendicular to each other: in a near turn-back, both would point almost the same way.
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

    /// The segment under further limits, too. They change along straight segments as well.
    #[must_use]
    pub fn with_rows(self, limits: &'a RowLimits) -> Self {
        Self { rows: (limits.count() > 0).then_some(limits), ..self }
    }

    /// Lowers the limits of jerk next to the rest at one end.
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

    /// The share of its limits of jerk that holds at `sigma`, in rad.
    pub(crate) fn jerk_rel(&self, sigma: f64) -> f64 {
        let ways = [sigma, self.length - sigma];
        let shares = std::iter::zip(&self.ramps, ways)
            .filter_map(|(ramp, way)| Some(ramp.as_ref()?.jerk_rel_at(way)));
        shares.fold(1.0, f64::min)
    }

    /// The largest x at `sigma`, in rad, that a constant jerk leaves on the way from or to a rest with a ramp.
    pub(crate) fn ramp_x(&self, sigma: f64) -> f64 {
        let ends = [(sigma, 0.0), (self.length - sigma, 1.0)];
        let ramps = std::iter::zip(&self.ramps, ends).filter(|(ramp, _)| ramp.is_some());
        ramps
            .map(|(_, (way, s))| (4.5 * self.straight(s)[2] * way * way).powf(2.0 / 3.0))
            .fold(f64::INFINITY, f64::min)
    }

    /// True if the segment has further limits, as rows.
    #[must_use]
    pub fn has_rows(&self) -> bool {
        self.rows.is_some()
    }

    /// The number of rows of further limits at each place.
    #[must_use]
    pub fn row_count(&self) -> usize {
        self.rows.map_or(0, RowLimits::count)
    }

    /// The rows of further limits at some sigma (rad), place after place: by the second derivative of sigma (rad/s^2), by the
    /// square of the first, and by neither.
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

    /// Marks in `near` the `rows` that can come near to their limit at a place with these derivatives, at any speed and
    /// acceleration that the limits of velocity and acceleration allow.
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
            .fold(f64::INFINITY, |least, u| if u < least { u } else { least });
        for (near, row) in near.iter_mut().zip(rows) {
            let moving = row.acceleration.abs() * u + row.square.abs() * x;
            let most = moving + row.offset.abs();
            // Where nothing else limits the speed, either.
            *near |= most >= NEAR_LIMIT || most.is_nan();
        }
    }

    /// The largest acceleration of sigma (rad/s^2) that further limits leave at a stop at `s`, either way.
    fn row_acceleration(&self, s: f64) -> f64 {
        let rows = self.rows(&[s * self.length]);
        rows.iter()
            .map(|row| (1.0 - row.offset.abs()) / row.acceleration.abs())
            .fold(f64::INFINITY, f64::min)
    }

    /// The largest x that further limits leave at `sigma`, where the second derivative of sigma is `u` times x.
    pub(crate) fn row_cap(&self, sigma: f64, u: f64) -> f64 {
        let rows = self.rows(&[sigma]);
        rows.iter()
            .map(|row| {
                let by_x = row.acceleration * u + row.square;
                (1.0 - row.offset.copysign(row.offset * by_x)) / by_x.abs()
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// Whether it is straight, and only joints are limited.
    #[must_use]
    pub fn is_line(&self) -> bool {
        self.direction.is_some()
    }

    /// Whether the arm may as well stop where it ends: on lines, and on lines and circles of the TCP, whose limits hardly
    /// change.
    #[must_use]
    pub fn is_stop(&self) -> bool {
        self.is_line() || self.shape.has_even_tool_way()
    }

    /// Largest speed, acceleration and jerk of sigma by the limits of the tool, in rad/s, rad/s^2 and rad/s^3, where it goes
    /// evenly and all of these are limited; of jerk from rest to rest.
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
            // Its parameter is not the way.
            return None;
        }
        let [direction, ..] = self.derivatives(0.0);
        let mut limits = LimitKind::ALL.map(|kind| self.limits[kind][7] / direction[7]);
        // With the same time for both ramps together.
        let [start, stop] = [0.0, self.length].map(|sigma| 1.0 / self.jerk_rel(sigma));
        limits[2] /= 0.5 * (start + stop);
        limits.iter().all(|limit| limit.is_finite()).then_some(limits)
    }

    /// Whether the tool is limited.
    pub(crate) fn has_tool(&self) -> bool {
        self.tool.is_some()
    }

    /// Its range of sigma, in rad: from 0 to this.
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

    /// The derivatives of q by sigma at some sigma, in rad.
    #[must_use]
    pub fn geometry(&self, sigma: &Places) -> Geometry {
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

    /// First to third derivative of q by sigma at one place of its `geometry`.
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

    /// First to third derivative of q by sigma at `s`; in 1, 1/rad and 1/rad^2.
    pub(crate) fn derivatives(&self, s: f64) -> SigmaDerivatives {
        if let Some(direction) = &self.direction {
            return [with_tool(direction, 0.0), [0.0; 8], [0.0; 8]];
        }
        let joints = self.shape.sigma_derivatives(s);
        let tool = self.tool.map_or([0.0; 3], |tool| tool.sigma_derivatives(self.shape, s));
        std::array::from_fn(|k| with_tool(&joints[k], tool[k]))
    }

    /// The way in the middle of a blend on which it turns back: infinite for a line, long for a blend
    /// that turns by little, and short if it turns back at a low speed.
    pub(crate) fn turn_back(&self) -> f64 {
        if self.is_line() {
            return f64::INFINITY;
        }
        // There q goes as q' (sigma - middle) + q'' (sigma - middle)^2 / 2.
        let [dq, ddq, _] = self.derivatives(0.5);
        let norm = |row: &Coordinates| row[..7].iter().map(|v| v * v).sum::<f64>().sqrt();
        let straight = norm(&dq) / norm(&ddq);
        let [speed, acceleration, jerk] = LimitKind::ALL.map(|kind| &self.limits[kind]);
        // The tool never does.
        let turn = (0..7).map(|j| {
            // On the way `way`, joint j comes from its full speed to rest.
            let speed = speed[j];
            let way = speed * (speed / acceleration[j]).max((speed / jerk[j]).sqrt());
            (way / ddq[j].abs()).sqrt()
        });
        straight + turn.fold(f64::INFINITY, f64::min)
    }

    /// For how long jerk builds up acceleration at `s`, in s: until it, or speed, is at its limit.
    pub(crate) fn build_up_s(&self, s: f64) -> f64 {
        let [speed, acceleration, jerk] = self.straight(s);
        let acceleration = acceleration.min(self.row_acceleration(s));
        (acceleration / jerk).min((speed / jerk).sqrt())
    }

    /// The way from a rest at `s` on which the curve's bend takes no more than a `share` of a limit of jerk, in rad.
    ///
    /// Where the third derivative of sigma is a constant j, `sigma = j t^3 / 6` and the jerk is
    /// `j (q' + 9 q'' sigma + 14 q''' sigma^2)` with the derivatives there, but for higher powers.
    pub(crate) fn even_way(&self, s: f64, share: f64) -> f64 {
        let [_, ddq, dddq] = self.derivatives(s);
        let [_, _, jerk] = self.straight(s);
        let of = |row| jerk * largest_share(row, &self.inverse[LimitKind::Jerk]);
        (share / (9.0 * of(&ddq))).min((share / (14.0 * of(&dddq))).sqrt())
    }

    /// Way on which the arm stops, straight on, from its start, in rad; `before` is the segment that ends there.
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

    /// The largest share of a limit of jerk where sigma goes on at a steady speed of 1 rad/s and the curve's
    /// third derivative is `dddq`; it goes with the speed's cube.
    pub(crate) fn jerk_at_unit_speed(&self, dddq: &Coordinates) -> f64 {
        largest_share(dddq, &self.inverse[LimitKind::Jerk])
    }

    /// Largest speed, acceleration and jerk of sigma at `s`, if the path went straight on from there; in rad/s,
    /// rad/s^2 and rad/s^3.
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

    /// Shares of all limits at one place of its `geometry`, where speed, acceleration and jerk of sigma are these,
    /// with their signs; of each kind one for each coordinate.
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

    /// Shares of all limits of each coordinate at all places of a `geometry`.
    #[inline(always)]
    fn sampled_shares(&self, geometry: &Geometry, rates: &[Places; 3]) -> [[Places; 8]; 3] {
        let mut shares = [[Places::default(); 8]; 3];
        for i in 0..Places::default().len() {
            let found = self.shares(geometry, i, rates.map(|rate| rate[i])).into_array();
            for (shares, found) in std::iter::zip(&mut shares, found) {
                std::iter::zip(shares, found).for_each(|(share, found)| share[i] = found);
            }
        }
        shares
    }

    /// By how much shares of the limits may exceed those that [`largest_shares`](Self::largest_shares) finds. On lines and
    /// graphs in a plane that is next to nothing: their derivatives are polynomials along the whole segment.
    pub(crate) fn share_errors(&self, geometry: &Geometry, rates: &[Places; 3]) -> ByKind<f64> {
        let Geometry::General(_) = geometry else { return ByKind::default() };
        let limited = if self.has_tool() { 8 } else { 7 };
        ByKind::from_array(
            self.sampled_shares(geometry, rates)
                .map(|shares| shares[..limited].iter().map(parabola_error).fold(0.0, larger)),
        )
    }

    /// The largest shares of the limits from samples of a stretch: its `geometry` at
    /// [`SHARES`](crate::peaks::SHARES) of it, and speed, acceleration and jerk of sigma there.
    #[inline(always)]
    pub(crate) fn largest_shares(&self, geometry: &Geometry, rates: &[Places; 3]) -> ByKind<f64> {
        let at = |i: usize| rates.map(|rate| rate[i]);
        let mut peaks = ByKind::<Peak>::default();
        if let Geometry::General(_) = geometry {
            let shares = self.sampled_shares(geometry, rates);
            for (peak, shares) in std::iter::zip(peaks.values_mut(), shares) {
                let limited = if self.has_tool() { 8 } else { 7 };
                for shares in &shares[..limited] {
                    peak.add(shares);
                }
            }
            return peaks.map(|_, peak| peak.get());
        }
        let mut of_plane = [[Places::default(); 2]; 3];
        let across =
            if let Geometry::Planar(across) = geometry { *across } else { Default::default() };
        for i in 0..Places::default().len() {
            let found = in_plane(across.map(|derivative| derivative[i]), at(i));
            for (of_plane, [along, aside]) in std::iter::zip(&mut of_plane, found) {
                (of_plane[0][i], of_plane[1][i]) = (along, aside);
            }
        }
        for ((kind, peak), [along, aside]) in std::iter::zip(&mut peaks, &of_plane) {
            for [ahead, across] in self.limiting[kind].points() {
                peak.add(&std::array::from_fn(|i| ahead * along[i] + across * aside[i]));
            }
        }
        peaks.map(|_, peak| peak.get())
    }
}

/// The largest of `|derivative_j| inverse_j`, with one over the limits.
pub(crate) fn largest_share(derivative: &Coordinates, inverse: &Coordinates) -> f64 {
    std::iter::zip(derivative, inverse).map(|(d, i)| d.abs() * i).fold(0.0, f64::max)
}

/// The largest multiple of `direction` within the limits.
fn largest_multiple(direction: &Coordinates, limits: &Coordinates) -> f64 {
    std::iter::zip(direction, limits).map(|(d, limit)| limit / d.abs()).fold(f64::MAX, f64::min)
}

/// The values of the joints alone.
fn joints(of: &Coordinates) -> Joints {
    std::array::from_fn(|j| of[j])
}

/// Values of the joints, and that of the tool.
#[inline(always)]
fn with_tool(joints: &Joints, tool: f64) -> Coordinates {
    let mut all = [tool; 8];
    all[..7].copy_from_slice(joints);
    all
}
