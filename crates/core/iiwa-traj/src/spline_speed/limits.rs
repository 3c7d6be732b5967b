//! Limits of the model in the form of joint limits, as input of the solver.
//!
//! With the TCP way y, v = dy/dt and the joint positions q(y), there is a largest speed V(y),
//! acceleration A(y) and jerk J(y):
//! - V, the minimum of `V_i / |q'_i|`, of `sqrt(b A_i / |q''_i|)` and of the whole way over the
//!   minimum cruise time,
//! - A, a share of `min_i A_i / |q'_i|`,
//! - J, `min_i A_i / |q'_i|` over a time.
//!
//! Each of them becomes a virtual joint with a single limit, 1, that moves by y over V, A or J.
//! These quotients are not the derivatives of any position: the solver evaluates them point by
//! point, and needs no more.

use std::sync::Arc;

use iiwa_kin::{Joints, SplineSpeed};
use iiwa_path::{Derivatives, Segment, ToolCoordinate, ToolWay};
use iiwa_program::{ByKind, LimitKind, MotionLimits, ToolLimits};

use super::held_speed::HeldSpeed;
use crate::{grid::Grid, sunrise::EndRamp};

/// Virtual joint for each kind of limit.
const STANDS_FOR: [(LimitKind, usize); 3] =
    [(LimitKind::Velocity, 0), (LimitKind::Acceleration, 1), (LimitKind::Jerk, 2)];

/// Spline segment whose derivatives with respect to sigma are those of the virtual joints for the
/// model's limits.
#[derive(Debug)]
pub(super) struct SpeedLimitedSegment<'a> {
    shape: &'a dyn Segment,
    limits: &'a MotionLimits,
    /// Joint acceleration limits from which jerk limits follow: the robot's limits, times the
    /// motion's share of jerk.
    jerk_base_rad_s2: Joints,
    model: SplineSpeed,
    /// TCP way; none if the TCP does not move.
    way: Option<TcpWay>,
    /// Largest speed of y, at which the whole way takes the minimum cruise time.
    cruise: f64,
    /// sigma from the previous rest to the segment's start, and from its end to the next rest, in
    /// rad.
    from_rests_rad: [f64; 2],
    /// Speeds that are held around minima; if unset, each point has its own limit.
    held: Option<Arc<HeldSpeed>>,
    /// Ramps at both rests; if unset, the whole acceleration limit may be used everywhere.
    ramps: Option<[EndRamp; 2]>,
}

/// TCP way along a segment: a tool coordinate, and its unit in m.
#[derive(Clone, Copy, Debug)]
struct TcpWay {
    coordinate: ToolCoordinate,
    unit_m: f64,
}

impl TcpWay {
    fn new(shape: &dyn Segment) -> Option<Self> {
        let mut limits = ToolLimits::NONE;
        limits.way[LimitKind::Velocity] = 1.0;
        let coordinate = ToolCoordinate::new(shape, &limits)?;
        let ToolWay { way_m: [whole_m, ..], .. } = shape.tool_way(0.0);
        let unit_m = if shape.has_even_tool_way() { whole_m } else { 1.0 };
        Some(Self { coordinate, unit_m })
    }
}

/// Limits of the model at a point, in units of y.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpeedLimits {
    /// First to third derivative of y with respect to sigma.
    pub(super) way: [f64; 3],
    pub(super) speed: f64,
    pub(super) acceleration: f64,
    pub(super) jerk: f64,
}

impl<'a> SpeedLimitedSegment<'a> {
    /// Creates the segment under the `limits` of its motion; `full` are the robot's.
    pub(super) fn new(
        shape: &'a dyn Segment,
        limits: &'a MotionLimits,
        full: &MotionLimits,
        model: SplineSpeed,
    ) -> Self {
        let [motion_jerk, all] = [limits, full].map(MotionLimits::jerk_rad_s3);
        let jerk_base_rad_s2 =
            std::array::from_fn(|j| full.acceleration_rad_s2()[j] * motion_jerk[j] / all[j]);
        Self {
            shape,
            limits,
            jerk_base_rad_s2,
            model,
            way: TcpWay::new(shape),
            cruise: f64::INFINITY,
            from_rests_rad: [0.0; 2],
            held: None,
            ramps: None,
        }
    }

    /// Sets sigma from both rests, in rad, and the largest speed of y.
    pub(super) fn set_place(&mut self, from_rests_rad: [f64; 2], cruise: f64) {
        (self.from_rests_rad, self.cruise) = (from_rests_rad, cruise);
    }

    /// Returns the largest speed of y, at which the whole way takes the minimum cruise time.
    pub(super) fn cruise(&self) -> f64 {
        self.cruise
    }

    /// Returns the ratio of the speed of y to its largest, at the share `p` of sigma and dp/dt.
    pub(super) fn cruise_share(&self, p: f64, rate: f64) -> f64 {
        let s = self.shape.s_at(p * self.shape.sigma(1.0)[0]).clamp(0.0, 1.0);
        self.way_by_sigma(s)[0] * self.shape.sigma_length_rad() * rate / self.cruise
    }

    /// Sets the speeds that are held around minima.
    pub(super) fn set_held(&mut self, held: Arc<HeldSpeed>) {
        self.held = Some(held);
    }

    /// Sets the ramps at the start and the end of the way from rest to rest.
    pub(super) fn set_ramps(&mut self, ramps: [EndRamp; 2]) {
        self.ramps = Some(ramps);
    }

    /// Returns the segment and the limits of the real joints.
    pub(super) fn shape_and_limits(&self) -> (&'a dyn Segment, &'a MotionLimits) {
        (self.shape, self.limits)
    }

    /// Returns true if the TCP moves. If it does not, y is sigma (assumption: nothing was
    /// recorded).
    pub(super) fn has_way(&self) -> bool {
        self.way.is_some()
    }

    /// Returns the whole y, by the trapezoidal rule.
    pub(super) fn way(&self, grid: &Grid) -> f64 {
        let length_rad = self.sigma_length_rad();
        let rates = grid.s_on(self.shape).into_iter().map(|s| self.way_by_sigma(s)[0]);
        let rates: Vec<f64> = rates.collect();
        std::iter::zip(grid.nodes_on(self.shape).windows(2), rates.windows(2))
            .map(|(nodes, rates)| (nodes[1].p - nodes[0].p) * f64::midpoint(rates[0], rates[1]))
            .sum::<f64>()
            * length_rad
    }

    fn way_by_sigma(&self, s: f64) -> [f64; 3] {
        match &self.way {
            Some(TcpWay { coordinate, unit_m }) => {
                coordinate.sigma_derivatives(self.shape, s).map(|rate| rate * unit_m)
            }
            None => [1.0, 0.0, 0.0],
        }
    }

    /// Returns the limits at `s`.
    pub(super) fn limits_at(&self, s: f64) -> SpeedLimits {
        let [first, second, _] = self.shape.sigma_derivatives(s);
        let way = self.way_by_sigma(s);
        let mut speed = self.cruise;
        let [mut by_acceleration, mut by_jerk] = [f64::INFINITY; 2];
        for j in 0..7 {
            // By y: q' over y', and (q'' - q' y'' / y') over the square of y'.
            let rate = first[j].abs() / way[0];
            let bend = (second[j] - first[j] * way[1] / way[0]).abs() / (way[0] * way[0]);
            let acceleration = self.limits.acceleration_rad_s2()[j];
            speed = speed
                .min(self.limits.velocity_rad_s()[j] / rate)
                .min((self.model.bend_rel * acceleration / bend).sqrt());
            by_acceleration = by_acceleration.min(acceleration / rate);
            by_jerk = by_jerk.min(self.jerk_base_rad_s2[j] / rate);
        }
        let at_rad = self.shape.sigma(s)[0] * self.shape.sigma_unit_rad();
        if let Some(held) = &self.held {
            speed = speed.min(held.at(self.from_rests_rad[0] + at_rad));
        }
        let [share, per_s] = self.ramping(at_rad);
        SpeedLimits { way, speed, acceleration: share * by_acceleration, jerk: per_s * by_jerk }
    }

    /// Returns the share of the acceleration limit, and the reciprocal of its build-up time, at a
    /// sigma in rad.
    fn ramping(&self, at_rad: f64) -> [f64; 2] {
        let SplineSpeed { tangent_rel, build_up_s, .. } = self.model;
        let Some(ramps) = &self.ramps else { return [1.0, 1.0 / build_up_s] };
        let mut limits = [tangent_rel, 1.0 / build_up_s];
        let ways_rad = [at_rad, self.shape.sigma_length_rad() - at_rad];
        for (k, ramp) in ramps.iter().enumerate() {
            let weight = ramp.weight(self.from_rests_rad[k] + ways_rad[k]);
            let rest_ramp = [ramp.acceleration_rel, 1.0 / ramp.build_up_s];
            limits = std::array::from_fn(|i| limits[i] + weight * (rest_ramp[i] - limits[i]));
        }
        limits
    }

    /// Returns the limits of the virtual joints, and those of the TCP; velocity limits are divided
    /// by `slower`.
    pub(super) fn joint_limits(&self, slower: f64) -> MotionLimits {
        let mut joints = ByKind::from_fn(|_| [f64::INFINITY; 7]);
        for (kind, joint) in STANDS_FOR {
            joints[kind][joint] = if kind == LimitKind::Velocity { 1.0 / slower } else { 1.0 };
        }
        MotionLimits::of_joints(joints, *self.limits.tool())
    }
}

impl Segment for SpeedLimitedSegment<'_> {
    fn at(&self, s: f64) -> Derivatives {
        self.shape.at(s)
    }

    fn bend_bound_rad(&self) -> Joints {
        self.shape.bend_bound_rad()
    }

    fn has_continuous_curvature(&self) -> bool {
        self.shape.has_continuous_curvature()
    }

    fn tool_way(&self, s: f64) -> ToolWay {
        self.shape.tool_way(s)
    }

    fn has_even_tool_way(&self) -> bool {
        self.shape.has_even_tool_way()
    }

    fn sigma(&self, s: f64) -> [f64; 4] {
        self.shape.sigma(s)
    }

    fn sigma_unit_rad(&self) -> f64 {
        self.shape.sigma_unit_rad()
    }

    fn s_at(&self, sigma: f64) -> f64 {
        self.shape.s_at(sigma)
    }

    fn sigma_derivatives(&self, s: f64) -> [Joints; 3] {
        let SpeedLimits { way, speed, acceleration, jerk } = self.limits_at(s);
        let mut derivatives = [[0.0; 7]; 3];
        for ((_, joint), limit) in STANDS_FOR.into_iter().zip([speed, acceleration, jerk]) {
            for (derivative, rate) in derivatives.iter_mut().zip(way) {
                derivative[joint] = rate / limit;
            }
        }
        derivatives
    }
}
