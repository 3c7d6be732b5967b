//! The arm's parts: what they are, where they are, how far each joint can move them.

use iiwa_kin::{Along, Joints, Pose, Robot, Solid};
use parry3d_f64::{math::Vector, shape::SupportMap};

/// The first link that counts. Links 0 and 1 stand on the table and turn about their own axis only: how
/// far they are from anything is the same at all poses.
pub(crate) const FIRST_LINK: usize = 2;

/// A primitive shape of the arm.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    pub(crate) link: usize,
    /// Its centre, in its link's frame.
    center: Vector,
    along: Along,
    form: Round,
    /// How far any of its points is from its centre, at most.
    pub(crate) bound: f64,
    /// How far any of its points can be from the axis of each joint, at most, in m; zero for joints
    /// that do not carry it. No point of it moves faster than this times the joint's speed.
    pub(crate) reach: Joints,
}

/// A ball, or a cylinder with flat ends.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Round {
    Cylinder { radius: f64, half: f64 },
    Ball { radius: f64 },
}

/// A part of the arm where it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body {
    pub(crate) center: Vector,
    /// Of length 1; it means nothing for a ball.
    pub(crate) axis: Vector,
    pub(crate) form: Round,
}

/// All parts of `robot` that count.
pub(crate) fn parts(robot: &Robot) -> Vec<Part> {
    let d = robot.dh().map(|row| row.d_m);
    let links = robot.link_shapes();
    let mut parts = Vec::new();
    for (link, shapes) in links.iter().enumerate().skip(FIRST_LINK) {
        for shape in shapes {
            let center = Vector::from(shape.center_m);
            let (form, along) = match shape.solid {
                Solid::Cylinder { along, radius_m, length_m } => {
                    (Round::Cylinder { radius: radius_m, half: 0.5 * length_m }, along)
                }
                Solid::Sphere { radius_m } => (Round::Ball { radius: radius_m }, Along::Z),
            };
            let bound = match form {
                Round::Cylinder { radius, half } => radius.hypot(half),
                Round::Ball { radius } => radius,
            };
            let mut reach = [0.0; 7];
            // The shift d_j runs along the axis of joint j, so that the axis goes through the origin of
            // the next link's frame. From there on it is no farther than along the shifts between.
            let mut way = from_origin(center, form);
            for joint in (0..link - 1).rev() {
                reach[joint] = way;
                way += d[joint];
            }
            reach[link - 1] = from_own_axis(center, along, form);
            parts.push(Part { link, center, along, form, bound, reach });
        }
    }
    parts
}

/// How far the points of a part are from its link's origin, at most. Centres lie on the axis.
fn from_origin(center: Vector, form: Round) -> f64 {
    match form {
        Round::Cylinder { radius, half } => radius.hypot(center.length() + half),
        Round::Ball { radius } => center.length() + radius,
    }
}

/// How far the points of a part are from the axis that its own link turns about, at most: the link's z
/// axis, which all centres lie on or right across of.
fn from_own_axis(center: Vector, along: Along, form: Round) -> f64 {
    match (form, along) {
        (Round::Cylinder { radius, .. }, Along::Z) | (Round::Ball { radius }, _) => {
            center.truncate().length() + radius
        }
        (Round::Cylinder { radius, half }, Along::Y) => {
            (center.y.abs() + half).hypot(center.x.abs() + radius)
        }
    }
}

impl Part {
    /// The part where its link's frame is at `pose`.
    pub(crate) fn at(&self, pose: &Pose) -> Body {
        let column = match self.along {
            Along::Y => 1,
            Along::Z => 2,
        };
        let rows = pose.rotation.map(Vector::from);
        let turned = Vector::from(rows.map(|row| row.dot(self.center)));
        Body {
            center: Vector::from(pose.position_m) + turned,
            axis: pose.rotation.map(|row| row[column]).into(),
            form: self.form,
        }
    }
}

impl Body {
    /// The smallest `direction . x` of its points. `direction` may be of any length.
    pub(crate) fn nearest_along(&self, direction: Vector) -> f64 {
        let reach = match self.form {
            Round::Ball { radius } => radius * direction.length(),
            Round::Cylinder { radius, half } => {
                let along = self.axis.dot(direction);
                let across = (direction - along * self.axis).length();
                half * along.abs() + radius * across
            }
        };
        self.center.dot(direction) - reach
    }

    /// The same part in another frame.
    pub(crate) fn map(
        &self,
        point: impl Fn(Vector) -> Vector,
        turn: impl Fn(Vector) -> Vector,
    ) -> Self {
        Self { center: point(self.center), axis: turn(self.axis), form: self.form }
    }

    /// The point of the part that is nearest to `point`.
    pub(crate) fn nearest(&self, point: Vector) -> Vector {
        let away = point - self.center;
        match self.form {
            Round::Ball { radius } => self.center + away.clamp_length_max(radius),
            Round::Cylinder { radius, half } => {
                let along = self.axis.dot(away);
                let across = away - along * self.axis;
                self.center + along.clamp(-half, half) * self.axis + across.clamp_length_max(radius)
            }
        }
    }
}

/// The farthest point along a direction, in the frame that the part is in.
impl SupportMap for Body {
    fn local_support_point(&self, direction: Vector) -> Vector {
        match self.form {
            Round::Ball { radius } => self.center + radius * direction.normalize_or_zero(),
            Round::Cylinder { radius, half } => {
                let along = self.axis.dot(direction);
                let across = direction - along * self.axis;
                self.center + half.copysign(along) * self.axis + radius * across.normalize_or_zero()
            }
        }
    }
}
