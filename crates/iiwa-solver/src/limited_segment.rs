//! A piece of a section, as the jerk-limited solver sees it.
//!
//! All pieces of a section share one kind of path parameter, sigma in rad: the way along a line, and
//! `reach (s + alpha(s))` in a blend. With it q' and q'' continue from piece to piece, and of q''' only
//! the part across the path jumps. With s as the parameter the part along the path would jump as
//! well: the solver would have to make the speed's own second derivative jump against it.

use iiwa_kin::{Joints, vector::largest_multiple};
use iiwa_path::{MotionLimits, Segment};

use crate::{limiting_joints::LimitingJoints, swept::SweptNode};

/// A segment and its limits, as the solver sees them.
pub struct LimitedSegment<'a> {
    limits: &'a MotionLimits,
    /// One over the limits of velocity, acceleration and jerk.
    pub(crate) inverse: [Joints; 3],
    pub(crate) length: f64,
    /// The acceleration-limited stamps.
    pub(crate) swept: &'a [SweptNode],
    shape: &'a dyn Segment,
    /// The shortest time in which the jerk of a joint builds up its acceleration, in s.
    pub(crate) least_build_up_s: f64,
    /// The unit of its sigma, in rad.
    unit: f64,
    /// dq/dsigma of a straight segment.
    direction: Option<Joints>,
    /// One over the largest speed, acceleration and jerk of sigma on a line.
    line_shares: [f64; 3],
    /// The joints that can be at their limits of acceleration and of jerk.
    pub(crate) limiting: [LimitingJoints; 2],
}

/// First to third derivative of q by sigma; in 1, 1/rad and 1/rad^2.
pub(crate) type SigmaDerivatives = [Joints; 3];

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
        let direction = shape.is_straight().then(|| shape.at(0.0).dq.map(|d| d / unit));
        let [end, ..] = shape.sigma(1.0);
        let inverse = [limits.velocity_rad_s, limits.acceleration_rad_s2, limits.jerk_rad_s3]
            .map(|limits| limits.map(|limit| 1.0 / limit));
        let mut segment = Self {
            limits,
            inverse,
            length: end * unit,
            swept,
            shape,
            least_build_up_s: std::iter::zip(limits.acceleration_rad_s2, limits.jerk_rad_s3)
                .map(|(acceleration, jerk)| acceleration / jerk)
                .fold(f64::INFINITY, f64::min),
            unit,
            direction,
            limiting: [LimitingJoints::ALL; 2],
            line_shares: [0.0; 3],
        };
        if segment.is_line() {
            segment.line_shares = segment.straight(0.0).map(|limit| 1.0 / limit);
        }
        if shape.is_planar() {
            // Where the curve bends most, its first two derivatives span the plane; at some places it may not bend.
            let bend = |at: &SigmaDerivatives| at[1].iter().map(|v| v * v).sum::<f64>();
            let places = [0.1, 0.25, 0.4, 0.5].map(|s| segment.derivatives(s));
            let most = places.into_iter().max_by(|a, b| bend(a).total_cmp(&bend(b)));
            let [dq, ddq, _] = most.unwrap_or_default();
            let [_, acceleration, jerk] = &segment.inverse;
            segment.limiting = [acceleration, jerk].map(|inverse| {
                LimitingJoints::new(&std::array::from_fn(|j| {
                    [dq[j] * inverse[j], ddq[j] * inverse[j]]
                }))
            });
        }
        Some(segment)
    }

    /// Whether it is straight.
    #[must_use]
    pub fn is_line(&self) -> bool {
        self.direction.is_some()
    }

    /// Its range of sigma, in rad: from 0 to this.
    #[must_use]
    pub fn length_rad(&self) -> f64 {
        self.length
    }

    /// s, 0 to 1, at `sigma`, in rad.
    #[must_use]
    pub fn s(&self, sigma: f64) -> f64 {
        self.shape.s_at(sigma / self.unit)
    }

    /// (dsigma/dt)^2 at a sample of the acceleration-limited stamps.
    pub(crate) fn swept_x(&self, node: &SweptNode) -> f64 {
        (node.rate * self.length).powi(2)
    }

    /// First to third derivative of q by sigma at `s`; in 1, 1/rad and 1/rad^2.
    #[must_use]
    pub fn derivatives(&self, s: f64) -> [Joints; 3] {
        if let Some(direction) = self.direction {
            return [direction, [0.0; 7], [0.0; 7]];
        }
        self.shape.sigma_derivatives(s)
    }

    /// The way in the middle of a blend on which it turns back: infinite for a line, long for a blend
    /// that turns by little, and short if it turns back at a low speed.
    pub(crate) fn turn_back(&self) -> f64 {
        if self.is_line() {
            return f64::INFINITY;
        }
        // There q goes as q' (sigma - middle) + q'' (sigma - middle)^2 / 2.
        let [dq, ddq, _] = self.derivatives(0.5);
        let norm = |row: &Joints| row.iter().map(|v| v * v).sum::<f64>().sqrt();
        let straight = norm(&dq) / norm(&ddq);
        let MotionLimits { velocity_rad_s, acceleration_rad_s2, jerk_rad_s3 } = self.limits;
        let turn = (0..7).map(|j| {
            // On the way `way`, joint j comes from its full speed to rest.
            let speed = velocity_rad_s[j];
            let way = speed * (speed / acceleration_rad_s2[j]).max((speed / jerk_rad_s3[j]).sqrt());
            (way / ddq[j].abs()).sqrt()
        });
        straight + turn.fold(f64::INFINITY, f64::min)
    }

    /// For how long jerk builds up acceleration at `s`, in s: until it, or speed, is at its limit.
    pub(crate) fn build_up_s(&self, s: f64) -> f64 {
        let [speed, acceleration, jerk] = self.straight(s);
        (acceleration / jerk).min((speed / jerk).sqrt())
    }

    /// Way on which the arm stops, straight on, from its start, in rad; `before` is the segment that ends there.
    #[must_use]
    pub fn stop_rad(&self, before: Option<&Self>) -> f64 {
        let swept = self.swept.first().map_or(0.0, |node| self.swept_x(node));
        let x = [(Some(self), 0.0), (before, 1.0)]
            .into_iter()
            .filter_map(|(segment, s)| Some(segment?.x_by_jerk(s)))
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

    /// Largest x at `s` at which the path's own third derivative leaves jerk within its limits.
    pub(crate) fn x_by_jerk(&self, s: f64) -> f64 {
        if self.is_line() {
            return f64::INFINITY;
        }
        let [_, _, dddq] = self.derivatives(s);
        let [_, _, inverse] = &self.inverse;
        largest_share(&dddq, inverse).powf(-2.0 / 3.0)
    }

    /// Largest speed, acceleration and jerk of sigma at `s`, if the path went straight on from there; in rad/s,
    /// rad/s^2 and rad/s^3.
    #[must_use]
    pub fn straight(&self, s: f64) -> [f64; 3] {
        let [direction, ..] = self.derivatives(s);
        let MotionLimits { velocity_rad_s, acceleration_rad_s2, jerk_rad_s3 } = self.limits;
        [velocity_rad_s, acceleration_rad_s2, jerk_rad_s3]
            .map(|limit| largest_multiple(&direction, limit))
    }

    /// Shares of the limits of a line at speed, acceleration and jerk of sigma, with their signs.
    #[inline(always)]
    pub(crate) fn line_shares(&self, [v, a, j]: [f64; 3]) -> [f64; 3] {
        let [speed, acceleration, jerk] = self.line_shares;
        [v * speed, a * acceleration, j * jerk]
    }

    /// Shares of all limits at speed, acceleration and jerk of sigma, where the derivatives are these, with their
    /// signs; of each kind one for each joint, and a zero.
    #[inline(always)]
    #[must_use]
    pub fn shares(&self, [dq, ddq, dddq]: &[Joints; 3], [v, a, j]: [f64; 3]) -> [[f64; 8]; 3] {
        let [speed, acceleration, jerk] = &self.inverse;
        let mut shares = [[0.0; 8]; 3];
        for i in 0..7 {
            shares[0][i] = dq[i] * v * speed[i];
            shares[1][i] = (dq[i] * a + ddq[i] * v * v) * acceleration[i];
            shares[2][i] = (dq[i] * j + 3.0 * ddq[i] * v * a + dddq[i] * v * v * v) * jerk[i];
        }
        shares
    }
}

/// The largest of `|derivative_j| inverse_j`, with one over the limits.
pub(crate) fn largest_share(derivative: &Joints, inverse: &Joints) -> f64 {
    std::iter::zip(derivative, inverse).map(|(d, i)| d.abs() * i).fold(0.0, f64::max)
}
