//! How far the arm can get within a span of a path's segment, and how near to an obstacle or to itself at most.
//!
//! About the middle m of the span `[m - h, m + h]`, the joints are at `q(m) + x h dq/ds + e`, with x from -1
//! to 1 and `|e| <= h^2 / 2 max |d2q/ds2|`. Two bounds follow for a part that is at a distance d at m:
//!
//! - Of order one: no point of it moves farther than the sum of each joint's motion times the part's reach
//!   from that joint's axis. d less that is left.
//! - Of order two: if n is the direction from the obstacle to the part, the part stays beyond the plane
//!   across n that touches the obstacle, as far as its nearest point along n is. Along the tangent, that
//!   point's way is that of a rigid body with the twist of its link, and the smallest value along n is at
//!   one of the span's ends. What is missing is e, and what the arcs of the joints add to their tangents:
//!   `|d2p / dq_j dq_k|` is at most the reach from the axis of the outer one of the two joints.
//!
//! The distance of two links is that of one of them in the frame of the other, in which it is moved by the joints
//! between the two alone.
//!
//! The first bound rules out what is far away, the second one what moves past or along an obstacle: its
//! error falls with the square of the span, so that an arm that keeps its distance needs few spans.

use std::ops::Sub;

use iiwa_kin::{Joints, Pose, Robot};
use iiwa_path::Segment;
use parry3d_f64::math::Vector;

use crate::{
    arm::{Body, Part},
    distance::Near,
};

/// A span of a segment, and the arm in its middle.
pub(crate) struct Span {
    pub(crate) poses: [Pose; 9],
    /// The largest motion of each joint, to either side, in rad.
    motion: Joints,
    /// What of it is not along the tangent, in rad.
    bend: Joints,
    /// How each link moves along the tangent, from the middle to an end.
    twists: [Twist; 8],
}

/// A velocity field `turn x p + shift`.
#[derive(Clone, Copy, Default)]
struct Twist {
    turn: Vector,
    shift: Vector,
}

impl Sub for Twist {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { turn: self.turn - other.turn, shift: self.shift - other.shift }
    }
}

/// How far a part moves within a span, at most, in m.
#[derive(Clone, Copy)]
pub(crate) struct Moves {
    /// From the middle of the span to anywhere in it.
    pub(crate) most: f64,
    /// Of this, what is not along the tangent.
    off_tangent: f64,
}

impl Span {
    /// The span from `middle - half` to `middle + half`.
    pub(crate) fn new(robot: &Robot, segment: &dyn Segment, middle: f64, half: f64) -> Self {
        let at = segment.at(middle);
        let bend = segment.bend_bound_rad().map(|bound| 0.5 * half * half * bound);
        let tangent = at.dq.map(|dq| half * dq);
        let poses = robot.link_poses(&at.q);
        let mut twists = [Twist::default(); 8];
        for j in 0..7 {
            let pose = &poses[j + 1];
            let turn = tangent[j] * Vector::from(pose.rotation.map(|row| row[2]));
            let Twist { turn: inner, shift } = twists[j];
            let shift = shift - turn.cross(pose.position_m.into());
            twists[j + 1] = Twist { turn: inner + turn, shift };
        }
        let motion = std::array::from_fn(|j| tangent[j].abs() + bend[j]);
        Self { poses, motion, bend, twists }
    }

    /// How far `part` moves in the frame of the link `from`.
    pub(crate) fn moves(&self, part: &Part, from: usize) -> Moves {
        let (mut most, mut off_tangent) = (0.0, 0.0);
        let mut inner = 0.0;
        for j in from..7 {
            let motion = self.motion[j];
            most += motion * part.reach[j];
            // Half of the square of the motion of this joint and, twice, its product with each inner one.
            let arcs = 0.5 * motion * motion + motion * inner;
            off_tangent += (self.bend[j] + arcs) * part.reach[j];
            inner += motion;
        }
        Moves { most, off_tangent }
    }

    /// A lower bound of the distance that a part with `moves` in the frame of the link `from` keeps from something in this
    /// frame, if they are `near` in the middle; `beyond` is how far that reaches in the direction of [`Near::away`].
    pub(crate) fn least(
        &self,
        (part, body): (&Part, &Body<'_>),
        (from, moves): (usize, Moves),
        near: &Near,
        beyond: f64,
    ) -> f64 {
        let by_reach = near.distance - moves.most;
        if near.distance == 0.0 {
            return by_reach;
        }
        let away = near.away;
        let Twist { turn, shift } = self.twists[part.link] - self.twists[from];
        // away . (p + turn x p + shift), as a linear function of p.
        let (change, shift) = (away.cross(turn), away.dot(shift));
        let forth = body.nearest_along(away + change) + shift;
        let back = body.nearest_along(away - change) - shift;
        let along_tangent = forth.min(back) - beyond;
        by_reach.max(along_tangent - moves.off_tangent)
    }
}
