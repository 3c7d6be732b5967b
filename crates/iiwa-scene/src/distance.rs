//! How far a part of the arm is from an obstacle.

use parry3d_f64::{
    math::{Pose, Vector},
    query::gjk::{self, CsoPoint, GJKResult, VoronoiSimplex},
    shape::Cuboid,
};

use crate::{
    arm::{Body, Round},
    placed::{Placed, PlacedBox, PlacedPlane},
};

/// The nearest points of a part and an obstacle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near {
    /// 0 if they touch or overlap.
    pub(crate) distance: f64,
    pub(crate) on_arm: Vector,
    pub(crate) on_obstacle: Vector,
    /// From the obstacle to the arm, of length 1; it means nothing where they touch.
    pub(crate) away: Vector,
}

impl Near {
    /// Two nearest points, or two that touch.
    fn between(on_arm: Vector, on_obstacle: Vector) -> Self {
        match (on_arm - on_obstacle).try_normalize() {
            Some(away) => {
                Self { distance: (on_arm - on_obstacle).length(), on_arm, on_obstacle, away }
            }
            None => Self::touching(on_obstacle),
        }
    }

    fn touching(point: Vector) -> Self {
        Self { distance: 0.0, on_arm: point, on_obstacle: point, away: Vector::ZERO }
    }
}

/// The nearest points of `body` and `obstacle`, unless they are certainly farther apart than `most`.
pub(crate) fn near(body: &Body, obstacle: &Placed, most: f64) -> Option<Near> {
    match obstacle {
        Placed::Plane(plane) => Some(to_plane(body, plane)),
        Placed::Box(cuboid) => match body.form {
            Round::Ball { radius } => Some(ball_to_box(body.center, radius, cuboid)),
            Round::Cylinder { .. } => cylinder_to_box(body, cuboid, most),
        },
    }
}

fn to_plane(body: &Body, plane: &PlacedPlane) -> Near {
    use parry3d_f64::shape::SupportMap;

    let on_arm = body.local_support_point(-plane.normal);
    let height = plane.normal.dot(on_arm) - plane.offset;
    if height <= 0.0 {
        return Near::touching(on_arm);
    }
    let on_obstacle = on_arm - height * plane.normal;
    Near { distance: height, on_arm, on_obstacle, away: plane.normal }
}

fn ball_to_box(center: Vector, radius: f64, cuboid: &PlacedBox) -> Near {
    let on_obstacle = cuboid.to_base(cuboid.nearest(cuboid.to_local(center)));
    let way = center - on_obstacle;
    if way.length() <= radius {
        return Near::touching(on_obstacle);
    }
    Near::between(center - way.normalize_or_zero() * radius, on_obstacle)
}

/// By the algorithm of Gilbert, Johnson and Keerthi, in the box's frame.
fn cylinder_to_box(body: &Body, cuboid: &PlacedBox, most: f64) -> Option<Near> {
    let local = body.map(|point| cuboid.to_local(point), |axis| cuboid.turn_back(axis));
    let shape = Cuboid::new(cuboid.half);
    let start = local.center - cuboid.nearest(local.center);
    let start = start.try_normalize().unwrap_or(Vector::X);
    let mut simplex = VoronoiSimplex::new();
    simplex.reset(CsoPoint::from_shapes(&Pose::IDENTITY, &shape, &local, start));
    match gjk::closest_points(&Pose::IDENTITY, &shape, &local, most, true, &mut simplex) {
        GJKResult::ClosestPoints(on_box, on_arm, _) => {
            Some(Near::between(cuboid.to_base(on_arm), cuboid.to_base(on_box)))
        }
        GJKResult::Intersection => Some(Near::touching(cuboid.to_base(common(&local, cuboid)))),
        GJKResult::NoIntersection(_) | GJKResult::Proximity(_) => None,
    }
}

/// A point of both, which overlap: projected to one and the other in turn, a point gets there.
fn common(local: &Body, cuboid: &PlacedBox) -> Vector {
    let mut point = cuboid.nearest(local.center);
    for _ in 0..MOST_PROJECTIONS {
        let next = cuboid.nearest(local.nearest(point));
        let moved = (next - point).length();
        point = next;
        if moved < 1e-9 {
            break;
        }
    }
    point
}

/// Most projections in search of a common point; the deeper the overlap, the fewer are needed.
const MOST_PROJECTIONS: usize = 50;
