//! Bounds of the motion of the arm within a span of a path segment, and of its distance from an
//! obstacle or from itself.
//!
//! Around the middle m of the span `[m - h, m + h]`, the joint positions are
//! `q(m) + x h dq/ds + e`, with x from -1 to 1 and `|e| <= h^2 / 2 max |d2q/ds2|`. For a part with
//! the distance d at m, two bounds follow:
//!
//! - First order: no point of the part moves farther than the sum over the joints of their motion
//!   times the part's reach from the joint axis. The distance is at least d minus this sum.
//! - Second order: with the direction n from the obstacle to the part, the part remains beyond the
//!   plane perpendicular to n that touches the obstacle, by the distance of its nearest point along
//!   n. Along the tangent, that point moves as a point of a rigid body with the twist of its link,
//!   and the smallest value along n is at one end of the span. The remainder consists of e and of
//!   the difference between the arcs of the joints and their tangents: `|d2p / dq_j dq_k|` is at
//!   most the reach from the axis of the outer one of the two joints.
//!
//! The distance of two links is that of one of them in the frame of the other, where only the
//! joints between the two move it.
//!
//! The first bound excludes distant obstacles, the second one obstacles that the part passes or
//! moves along: its error is proportional to the square of the span, so that an arm at a constant
//! distance requires few spans.

use std::ops::Sub;

use glam::DVec3 as Vector;
use iiwa_kin::{Joints, Pose, Robot};
use iiwa_path::Segment;

use crate::{
    arm::{ArmPart, PosedPart},
    distance::Near,
};

/// Span of a segment, with the arm at its middle.
pub(crate) struct Span {
    pub(crate) poses: [Pose; 9],
    /// Largest motion of each joint to either side, in rad.
    motion: Joints,
    /// Part of the motion that is not along the tangent, in rad.
    bend: Joints,
    /// Twist of each link along the tangent, from the middle to an end.
    twists: [VelocityField; 8],
}

/// Velocity field `turn x p + shift`.
#[derive(Clone, Copy, Default)]
struct VelocityField {
    turn: Vector,
    shift: Vector,
}

impl Sub for VelocityField {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { turn: self.turn - other.turn, shift: self.shift - other.shift }
    }
}

/// Bounds of the motion of a part within a span, in m.
#[derive(Clone, Copy)]
pub(crate) struct MotionBounds {
    /// Bound from the middle of the span to any point in it.
    pub(crate) max_m: f64,
    /// Bound of the part that is not along the tangent.
    off_tangent: f64,
}

impl Span {
    /// Creates the span from `middle - half` to `middle + half`.
    pub(crate) fn new(robot: &Robot, segment: &dyn Segment, middle: f64, half: f64) -> Self {
        let state = segment.at(middle);
        let bend = segment.bend_bound_rad().map(|bound| 0.5 * half * half * bound);
        let tangent = state.dq.map(|dq| half * dq);
        let poses = robot.link_poses(&state.q);
        let mut twists = [VelocityField::default(); 8];
        for j in 0..7 {
            let pose = &poses[j + 1];
            let turn = tangent[j] * Vector::from(pose.rotation.map(|row| row[2]));
            let VelocityField { turn: inner, shift } = twists[j];
            let shift = shift - turn.cross(pose.position_m.into());
            twists[j + 1] = VelocityField { turn: inner + turn, shift };
        }
        let motion = std::array::from_fn(|j| tangent[j].abs() + bend[j]);
        Self { poses, motion, bend, twists }
    }

    /// Returns the bounds of the motion of `part` in the frame of the link `from`.
    pub(crate) fn moves(&self, part: &ArmPart, from: usize) -> MotionBounds {
        let (mut max_m, mut off_tangent) = (0.0, 0.0);
        let mut inner = 0.0;
        for j in from..7 {
            let motion = self.motion[j];
            max_m += motion * part.reach[j];
            // Half of the squared motion of this joint plus its product with each inner one (twice
            // a half).
            let arcs = 0.5 * motion * motion + motion * inner;
            off_tangent += (self.bend[j] + arcs) * part.reach[j];
            inner += motion;
        }
        MotionBounds { max_m, off_tangent }
    }

    /// Returns a lower bound of the distance of a part with the bounds `moves` in the frame of the
    /// link `from` from a shape in that frame. `near` holds their nearest points in the middle, and
    /// `beyond` the extent of that shape in the direction of [`Near::away`].
    pub(crate) fn lower_bound(
        &self,
        (part, body): (&ArmPart, &PosedPart<'_>),
        (from, moves): (usize, MotionBounds),
        near: &Near,
        beyond: f64,
    ) -> f64 {
        let by_reach = near.distance - moves.max_m;
        if near.distance == 0.0 {
            return by_reach;
        }
        let away = near.away;
        let VelocityField { turn, shift } = self.twists[part.link] - self.twists[from];
        // away . (p + turn x p + shift), as a linear function of p.
        let (change, shift) = (away.cross(turn), away.dot(shift));
        let forth = body.nearest_along(away + change) + shift;
        let back = body.nearest_along(away - change) - shift;
        let along_tangent = forth.min(back) - beyond;
        by_reach.max(along_tangent - moves.off_tangent)
    }
}
