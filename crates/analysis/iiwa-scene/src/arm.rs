//! Parts of the arm: shapes, poses, and bounds of their motion by each joint.

use std::{borrow::Borrow, sync::Arc};

use glam::DVec3 as Vector;
use iiwa_kin::{Along, Joints, Pose, Robot, Solid};

use crate::{
    carried::CarriedBody,
    hull::ConvexHull,
    links::{FIRST_LINK, TOOL},
    polyhedron::Polyhedron,
    rotation::rotation,
    tool::ToolShape,
};

/// Last link, which carries the tool.
const LAST_LINK: usize = 7;

/// Convex shape of the arm.
#[derive(Clone, Debug)]
pub(crate) struct ArmPart {
    pub(crate) link: usize,
    /// Link number in results: the link, or [`TOOL`].
    pub(crate) shown: usize,
    /// True for a part of a carried body, which is not always present.
    pub(crate) is_carried: bool,
    /// Centre, in the link frame.
    center: Vector,
    /// Axis, in the link frame.
    axis: Vector,
    form: Volume<Arc<Polyhedron>>,
    /// Largest distance of any point from the centre.
    pub(crate) bound: f64,
    /// Largest distance of any point from the axis of each joint, in m; zero for joints that do not
    /// move the part. No point of the part moves faster than this times the joint's speed.
    pub(crate) reach: Joints,
}

/// Sphere, cylinder with flat ends, box, or convex polyhedron, which is held as an `H`.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Volume<H> {
    Cylinder {
        radius: f64,
        half: f64,
    },
    Ball {
        radius: f64,
    },
    /// The two axes besides `axis`, and half of the lengths along all three.
    Box {
        sides: [Vector; 2],
        half: Vector,
    },
    /// The two axes besides `axis`.
    Hull {
        sides: [Vector; 2],
        hull: H,
    },
}

impl<H: Borrow<Polyhedron>> Volume<H> {
    /// Returns the largest distance of any point from the centre.
    fn bound(&self) -> f64 {
        match self {
            Self::Cylinder { radius, half } => radius.hypot(*half),
            Self::Ball { radius } => *radius,
            Self::Box { half, .. } => half.length(),
            Self::Hull { hull, .. } => hull.borrow().bound(Vector::length),
        }
    }

    /// Returns the volume with rotated directions.
    fn turned(&self, turn: impl Fn(Vector) -> Vector) -> Volume<&Polyhedron> {
        match *self {
            Self::Cylinder { radius, half } => Volume::Cylinder { radius, half },
            Self::Ball { radius } => Volume::Ball { radius },
            Self::Box { sides, half } => Volume::Box { sides: sides.map(turn), half },
            Self::Hull { sides, ref hull } => {
                Volume::Hull { sides: sides.map(turn), hull: hull.borrow() }
            }
        }
    }
}

/// Part of the arm at a pose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PosedPart<'a> {
    pub(crate) center: Vector,
    /// Unit vector; unused for a sphere.
    pub(crate) axis: Vector,
    pub(crate) form: Volume<&'a Polyhedron>,
}

/// Returns all parts of `robot`.
pub(crate) fn parts(robot: &Robot) -> Vec<ArmPart> {
    let d = robot.dh().map(|row| row.d_m);
    let links = robot.link_shapes();
    let mut parts = Vec::new();
    for (link, shapes) in links.iter().enumerate() {
        for shape in shapes {
            let center = Vector::from(shape.center_m);
            let (form, along) = match shape.solid {
                Solid::Cylinder { along, radius_m, length_m } => {
                    (Volume::Cylinder { radius: radius_m, half: 0.5 * length_m }, along)
                }
                Solid::Sphere { radius_m } => (Volume::Ball { radius: radius_m }, Along::Z),
            };
            let axis_distance = distance_from_axis(center, along, &form);
            let reach = reaches(&d, link, from_origin(center, &form), axis_distance);
            let axis = match along {
                Along::Y => Vector::Y,
                Along::Z => Vector::Z,
            };
            let bound = form.bound();
            parts.push(ArmPart {
                link,
                shown: link,
                is_carried: false,
                center,
                axis,
                form,
                bound,
                reach,
            });
        }
    }
    parts
}

/// Returns all parts of `robot` with links made of the convex hulls of meshes, in the link frames.
/// Links without meshes keep their cylinders and spheres.
pub(crate) fn mesh_parts(robot: &Robot, hulls: &[Vec<ConvexHull>; 8]) -> Vec<ArmPart> {
    let d = robot.dh().map(|row| row.d_m);
    let plain = parts(robot).into_iter().filter(|part| hulls[part.link].is_empty());
    let meshed = hulls.iter().enumerate().flat_map(|(link, hulls)| {
        hulls.iter().map(move |hull| {
            let (hull, center) = Polyhedron::new(hull);
            // A corner of a hull has the largest distance from any point or axis.
            let way = hull.bound(|corner| (center + corner).length());
            let axis_distance = hull.bound(|corner| (center + corner).truncate().length());
            let bound = hull.bound(Vector::length);
            let form = Volume::Hull { sides: [Vector::X, Vector::Y], hull: Arc::new(hull) };
            let reach = reaches(&d, link, way, axis_distance);
            ArmPart {
                link,
                shown: link,
                is_carried: false,
                center,
                axis: Vector::Z,
                form,
                bound,
                reach,
            }
        })
    });
    plain.chain(meshed).collect()
}

/// Returns the parts of a carried body.
pub(crate) fn carried_parts(robot: &Robot, body: &CarriedBody) -> impl Iterator<Item = ArmPart> {
    let parts = tool_parts(robot, &body.shapes).into_iter();
    parts.map(|part| ArmPart { shown: body.part, is_carried: true, ..part })
}

/// Returns the parts of a tool, which is given in the flange frame.
pub(crate) fn tool_parts(robot: &Robot, tool: &[ToolShape]) -> Vec<ArmPart> {
    let d = robot.dh().map(|row| row.d_m);
    let part = |shape: &ToolShape| {
        let (center_m, rpy_rad, form) = match *shape {
            ToolShape::Box { center_m, size_m, rpy_rad } => {
                let half = 0.5 * Vector::from(size_m);
                (center_m, rpy_rad, Volume::Box { sides: [Vector::X, Vector::Y], half })
            }
            ToolShape::Cylinder { center_m, radius_m, length_m, rpy_rad } => {
                (center_m, rpy_rad, Volume::Cylinder { radius: radius_m, half: 0.5 * length_m })
            }
            ToolShape::Sphere { center_m, radius_m } => {
                (center_m, [0.0; 3], Volume::Ball { radius: radius_m })
            }
            ToolShape::Mesh { ref hull, origin_m, rpy_rad } => {
                let (hull, center) = Polyhedron::new(hull);
                let rows = rotation(rpy_rad).map(Vector::from);
                let center = Vector::from(origin_m) + Vector::from(rows.map(|row| row.dot(center)));
                let sides = [Vector::X, Vector::Y];
                (center.into(), rpy_rad, Volume::Hull { sides, hull: Arc::new(hull) })
            }
        };
        let rows = rotation(rpy_rad).map(Vector::from);
        let turn = |v: Vector| Vector::from(rows.map(|row| row.dot(v)));
        // The origin of the last link's frame is at the wrist, with the orientation of the flange.
        let center = Vector::from(center_m) + d[LAST_LINK - 1] * Vector::Z;
        let bound = form.bound();
        let (way, axis_distance) = match &form {
            // A corner of a hull has the largest distance from any point or axis.
            Volume::Hull { hull, .. } => (
                hull.bound(|corner| (center + turn(corner)).length()),
                hull.bound(|corner| (center + turn(corner)).truncate().length()),
            ),
            _ => (center.length() + bound, center.truncate().length() + bound),
        };
        let form = match form {
            Volume::Box { sides, half } => Volume::Box { sides: sides.map(turn), half },
            Volume::Hull { sides, hull } => Volume::Hull { sides: sides.map(turn), hull },
            round => round,
        };
        let reach = reaches(&d, LAST_LINK, way, axis_distance);
        let (link, axis) = (LAST_LINK, turn(Vector::Z));
        ArmPart { link, shown: TOOL, is_carried: false, center, axis, form, bound, reach }
    };
    tool.iter().map(part).collect()
}

/// Returns the largest distance of a part's points from the axis of each joint, given their
/// distance `way` from the origin of the link frame, and `axis_distance` from the axis of the
/// link's own joint.
fn reaches(d: &Joints, link: usize, mut way: f64, axis_distance: f64) -> Joints {
    let mut reach = [0.0; 7];
    let Some(joint_index) = link.checked_sub(1) else { return reach };
    // The shift d_j is along the axis of joint j, so that the axis passes through the origin of the
    // next link's frame. Beyond that origin, the distance is bounded by the sum of the shifts in
    // between.
    for joint in (0..joint_index).rev() {
        reach[joint] = way;
        way += d[joint];
    }
    reach[joint_index] = axis_distance;
    reach
}

/// Returns the largest distance of a part's points from the link origin. Centres are on the axis.
fn from_origin(center: Vector, form: &Volume<Arc<Polyhedron>>) -> f64 {
    match form {
        Volume::Cylinder { radius, half } => radius.hypot(center.length() + half),
        _ => center.length() + form.bound(),
    }
}

/// Returns the largest distance of a part's points from the axis of the link's own joint: the
/// link's z axis, on which or perpendicular to which all centres are.
fn distance_from_axis(center: Vector, along: Along, form: &Volume<Arc<Polyhedron>>) -> f64 {
    match (form, along) {
        (Volume::Cylinder { radius, .. }, Along::Z) => center.truncate().length() + radius,
        (Volume::Cylinder { radius, half }, Along::Y) => {
            (center.y.abs() + half).hypot(center.x.abs() + radius)
        }
        _ => center.truncate().length() + form.bound(),
    }
}

impl ArmPart {
    /// Returns true if only joint 1 moves the part: it is rotationally symmetric about the axis of
    /// its own link, the second one.
    pub(crate) fn turns_with_joint_1(&self) -> bool {
        let on_axis = self.center.x == 0.0 && self.center.y == 0.0;
        let is_round = match self.form {
            Volume::Cylinder { .. } => self.axis == Vector::Z,
            Volume::Ball { .. } => true,
            Volume::Box { .. } | Volume::Hull { .. } => false,
        };
        self.link == FIRST_LINK && on_axis && is_round
    }

    /// Returns the part with its link frame at `pose`.
    pub(crate) fn at(&self, pose: &Pose) -> PosedPart<'_> {
        let rows = pose.rotation.map(Vector::from);
        let turn = |v: Vector| Vector::from(rows.map(|row| row.dot(v)));
        PosedPart {
            center: Vector::from(pose.position_m) + turn(self.center),
            axis: turn(self.axis),
            form: self.form.turned(turn),
        }
    }
}

impl PosedPart<'_> {
    /// Returns the largest `direction . x` of the points, for a `direction` of any length.
    pub(crate) fn farthest_along(&self, direction: Vector) -> f64 {
        -self.nearest_along(-direction)
    }

    /// Returns the smallest `direction . x` of the points, for a `direction` of any length.
    pub(crate) fn nearest_along(&self, direction: Vector) -> f64 {
        let reach = match self.form {
            Volume::Ball { radius } => radius * direction.length(),
            Volume::Cylinder { radius, half } => {
                let along = self.axis.dot(direction);
                let across = (direction - along * self.axis).length();
                half * along.abs() + radius * across
            }
            Volume::Box { half, .. } => half.dot(self.in_part_axes(direction).abs()),
            Volume::Hull { hull, .. } => {
                let local = self.in_part_axes(-direction);
                hull.support(local).dot(local)
            }
        };
        self.center.dot(direction) - reach
    }

    /// Returns the three axes of a box or a hull; for other forms only the last one is set.
    fn axes(&self) -> [Vector; 3] {
        match self.form {
            Volume::Box { sides: [x, y], .. } | Volume::Hull { sides: [x, y], .. } => {
                [x, y, self.axis]
            }
            _ => [Vector::ZERO, Vector::ZERO, self.axis],
        }
    }

    fn in_part_axes(&self, direction: Vector) -> Vector {
        Vector::from(self.axes().map(|axis| axis.dot(direction)))
    }

    fn in_base_axes(&self, local: Vector) -> Vector {
        let [x, y, z] = self.axes();
        local.x * x + local.y * y + local.z * z
    }

    /// Returns the point of the part nearest to `point`.
    pub(crate) fn nearest(&self, point: Vector) -> Vector {
        let away = point - self.center;
        match self.form {
            Volume::Ball { radius } => self.center + away.clamp_length_max(radius),
            Volume::Box { half, .. } => {
                self.center + self.in_base_axes(self.in_part_axes(away).clamp(-half, half))
            }
            Volume::Hull { hull, .. } => {
                self.center + self.in_base_axes(hull.nearest(self.in_part_axes(away)))
            }
            Volume::Cylinder { radius, half } => {
                let along = self.axis.dot(away);
                let across = away - along * self.axis;
                self.center + along.clamp(-half, half) * self.axis + across.clamp_length_max(radius)
            }
        }
    }

    /// Returns the farthest point along `direction`, which may have any length.
    pub(crate) fn support(&self, direction: Vector) -> Vector {
        match self.form {
            Volume::Ball { radius } => self.center + radius * direction.normalize_or_zero(),
            Volume::Box { half, .. } => {
                let local = self.in_part_axes(direction);
                self.center + self.in_base_axes(half.copysign(local))
            }
            Volume::Hull { hull, .. } => {
                let local = self.in_part_axes(direction);
                self.center + self.in_base_axes(hull.support(local))
            }
            Volume::Cylinder { radius, half } => {
                let along = self.axis.dot(direction);
                let across = direction - along * self.axis;
                // Near the axis, rounding leaves a part along it, which is large for its length.
                let is_along = across.length_squared() < 1e-24 * direction.length_squared();
                let across = across - self.axis.dot(across) * self.axis;
                let across = if is_along { Vector::ZERO } else { across };
                self.center + half.copysign(along) * self.axis + radius * across.normalize_or_zero()
            }
        }
    }
}
