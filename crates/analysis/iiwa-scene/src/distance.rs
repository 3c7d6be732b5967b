//! Distance of a part of the arm from an obstacle, or from another part.

use glam::DVec3 as Vector;

use crate::{
    arm::{PosedPart, Volume},
    gjk::{Approach, Convex, EXACT_M, apart, approach},
    placed::{Placed, PlacedPlane},
    placed_box::PlacedBox,
    placed_mesh::{PlacedMesh, SurfacePart},
    polyhedron::Face,
};

/// Nearest points of a part and another shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near {
    /// 0 if they touch or overlap.
    pub(crate) distance: f64,
    pub(crate) on_part: Vector,
    pub(crate) on_other: Vector,
    /// Unit vector from the other shape to the part; zero if they touch.
    pub(crate) away: Vector,
}

impl Near {
    /// Creates the result for two nearest points, or for two points that touch.
    fn between(on_part: Vector, on_other: Vector) -> Self {
        match (on_part - on_other).try_normalize() {
            Some(away) => Self { distance: (on_part - on_other).length(), on_part, on_other, away },
            None => Self::touching(on_other),
        }
    }

    fn touching(point: Vector) -> Self {
        Self { distance: 0.0, on_part: point, on_other: point, away: Vector::ZERO }
    }
}

macro_rules! convex {
    ($($solid:ty),*) => {$(
        impl Convex for $solid {
            fn support(&self, direction: Vector) -> Vector {
                Self::support(self, direction)
            }

            fn nearest(&self, point: Vector) -> Vector {
                Self::nearest(self, point)
            }

            fn farthest_along(&self, direction: Vector) -> f64 {
                Self::farthest_along(self, direction)
            }
        }
    )*};
}

convex!(PosedPart<'_>, PlacedBox, Face);

/// Returns the nearest points of `body` and `obstacle`; none if they are farther apart than
/// `max_distance` for certain.
pub(crate) fn near(body: &PosedPart<'_>, obstacle: &Placed, max_distance: f64) -> Option<Near> {
    match obstacle {
        Placed::Plane(plane) => Some(to_plane(body, plane)),
        Placed::Box(cuboid) => near_convex(body, cuboid, max_distance),
        Placed::Round(solid) => near_convex(body, solid, max_distance),
        Placed::Mesh(mesh) => to_mesh(body, mesh, max_distance),
    }
}

/// Returns the nearest points of `body` and a part of a surface: a triangle, or the box around
/// several triangles. None if they are farther apart than `max_distance` for certain.
pub(crate) fn to_surface_part(
    body: &PosedPart<'_>,
    part: &SurfacePart<'_>,
    max_distance: f64,
) -> Option<Near> {
    match part {
        SurfacePart::Face(face) => near_convex(body, *face, max_distance),
        SurfacePart::Box(cuboid, _) => near_convex(body, cuboid, max_distance),
    }
}

/// Returns the nearest points of a body and a surface, by branch and bound from the root of its
/// tree.
fn to_mesh(body: &PosedPart<'_>, mesh: &PlacedMesh, max_distance: f64) -> Option<Near> {
    let mut best: Option<Near> = None;
    // Nodes with a lower bound of their distance; the nearest one is the last one.
    let mut open = vec![(0.0, 0)];
    while let Some((lower_bound, node)) = open.pop() {
        let max_distance = best.map_or(max_distance, |near| near.distance);
        if lower_bound >= max_distance {
            continue;
        }
        let part = mesh.part(node);
        let Some(near) = to_surface_part(body, &part, max_distance) else { continue };
        match part {
            SurfacePart::Face(_) if best.is_none_or(|best| near.distance < best.distance) => {
                best = Some(near);
            }
            SurfacePart::Box(_, first) if near.distance < max_distance => {
                // The nearer box to the centre is searched first.
                let mut nodes = [first, first + 1];
                nodes.sort_by(|a, b| {
                    let [a, b] = [a, b].map(|node| mesh.lower_bound_of(*node, body.center));
                    b.total_cmp(&a)
                });
                open.extend(nodes.map(|node| (near.distance, node)));
            }
            _ => {}
        }
    }
    best
}

fn to_plane(body: &PosedPart<'_>, plane: &PlacedPlane) -> Near {
    let on_part = body.support(-plane.normal);
    let height = plane.normal.dot(on_part) - plane.offset;
    if height <= 0.0 {
        return Near::touching(on_part);
    }
    let on_other = on_part - height * plane.normal;
    Near { distance: height, on_part, on_other, away: plane.normal }
}

/// Returns the nearest points of a sphere and another shape, whose point nearest to the centre of
/// the sphere is `nearest`.
fn ball_to_point(center: Vector, radius: f64, nearest: Vector) -> Near {
    let way = center - nearest;
    if way.length() <= radius {
        return Near::touching(nearest);
    }
    Near::between(center - way.normalize_or_zero() * radius, nearest)
}

/// Returns the nearest points of a part and another solid; none if they are farther apart than
/// `max_distance` for certain.
pub(crate) fn near_convex(
    body: &PosedPart<'_>,
    other: &impl Convex,
    max_distance: f64,
) -> Option<Near> {
    let nearest = other.nearest(body.center);
    if let Volume::Ball { radius } = body.form {
        return Some(ball_to_point(body.center, radius, nearest));
    }
    match approach(body, other, body.center - nearest, max_distance) {
        Approach::Apart => None,
        Approach::Nearest(on_part, on_other) => Some(Near::between(on_part, on_other)),
        Approach::Unproven(on_other) => {
            let (on_part, on_other) = refined(body, other, on_other);
            Some(Near::between(on_part, on_other))
        }
    }
}

/// Returns the nearest points of both solids, from a point of `other` close to the solution; a
/// common point, twice, if there is one.
///
/// Alternating projections onto both solids converge to the nearest points. This is a gradient
/// descent, accelerated with Nesterov's momentum. It ends when the points are proven to be the
/// nearest ones, to within [`EXACT_M`]. After the last round, the points with the smallest proven
/// error count if a plane separates the solids.
fn refined(body: &impl Convex, other: &impl Convex, start: Vector) -> (Vector, Vector) {
    let (mut on_other, mut ahead) = (start, start);
    let mut momentum = 1.0_f64;
    let mut last = f64::MAX;
    let mut separated: Option<(f64, (Vector, Vector))> = None;
    for _ in 0..MAX_ROUNDS {
        let on_body = body.nearest(on_other);
        let way = on_body - on_other;
        let length = way.length();
        if length < TOUCHING_M {
            return (on_other, on_other);
        }
        let apart = apart(body, other, way / length);
        let error = length - apart;
        if error < EXACT_M {
            return (on_body, on_other);
        }
        if apart > 0.0 && separated.is_none_or(|(least, _)| error < least) {
            separated = Some((error, (on_body, on_other)));
        }
        if length > last {
            // Overshoot: restart the momentum.
            (momentum, ahead) = (1.0, on_other);
        }
        last = length;
        let next = other.nearest(body.nearest(ahead));
        let faster = 0.5 + (0.25 + momentum * momentum).sqrt();
        ahead = next + (momentum - 1.0) / faster * (next - on_other);
        (momentum, on_other) = (faster, next);
    }
    separated.map_or((on_other, on_other), |(_, nearest)| nearest)
}

/// Maximum number of rounds. Two of a hundred thousand random pairs need more than a hundred. Pairs
/// that are neither found to touch nor separated by a plane in all rounds touch to within 0.1 mm.
const MAX_ROUNDS: u32 = 1000;

/// Distance in m below which solids touch.
const TOUCHING_M: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_4, TAU};

    use super::*;
    use crate::{hull::ConvexHull, polyhedron::Polyhedron};

    /// Draws random rotations, every third one in steps of 45 degrees: simplices degenerate for
    /// parallel faces and axes.
    fn turn(random: &mut fastrand::Rng, aligned: bool) -> [f64; 3] {
        [(); 3].map(|()| {
            let angle = 8.0 * FRAC_PI_4 * (random.f64() - 0.5);
            if aligned { (angle / FRAC_PI_4).round() * FRAC_PI_4 } else { angle }
        })
    }

    /// Creates bodies with few and with many corners: of random points, blocks, and prisms with
    /// many sides, whose caps are triangle fans.
    fn hulls(random: &mut fastrand::Rng) -> Vec<Polyhedron> {
        let hull = |i: u32| {
            let mut between = |from: f64, to: f64| from + (to - from) * random.f64();
            let half = [(); 3].map(|()| between(0.005, 0.2));
            let prism = |i: u32| {
                let (sin, cos) = (f64::from(i / 2) * TAU / 60.0).sin_cos();
                [cos * half[0], sin * half[1], if i.is_multiple_of(2) { half[2] } else { -half[2] }]
            };
            let points = match i % 3 {
                0 => (0..4 + 4 * i)
                    .map(|_| half.map(|half| between(-half, half)))
                    .collect::<Vec<_>>(),
                1 => (0..8)
                    .map(|i| [0, 1, 2].map(|k| if i >> k & 1 == 0 { half[k] } else { -half[k] }))
                    .collect(),
                _ => (0..120).map(prism).collect(),
            };
            Polyhedron::new(&ConvexHull::new(points).unwrap()).0
        };
        (0..61).map(hull).collect()
    }

    /// Solid for a test: a cylinder, a box or a hull.
    fn solid(
        kind: usize,
        turn: [f64; 3],
        center: Vector,
        hull: &Polyhedron,
        mut between: impl FnMut(f64, f64) -> f64,
    ) -> PosedPart<'_> {
        let rows = crate::rotation::rotation(turn);
        let [x, y, axis] = [0, 1, 2].map(|k| rows.map(|row| row[k]).into());
        let form = match kind {
            0 => Volume::Cylinder { radius: between(0.04, 0.12), half: between(0.005, 0.2) },
            1 => {
                let half = [(); 3].map(|()| between(0.005, 0.2)).into();
                Volume::Box { sides: [x, y], half }
            }
            _ => Volume::Hull { sides: [x, y], hull },
        };
        PosedPart { center, axis, form }
    }

    /// Checks a result: the points are on both solids, and a separating plane proves that none are
    /// nearer. Returns whether the solids are apart.
    fn check(body: &PosedPart<'_>, other: &impl Convex, near: &Near) -> bool {
        let [off_body, off_other] = [
            (body.nearest(near.on_part) - near.on_part).length(),
            (other.nearest(near.on_other) - near.on_other).length(),
        ];
        assert!(off_other < 1e-8, "{off_other}: {near:?}");
        let is_apart = near.distance > 0.0;
        if is_apart {
            let expected = body.nearest_along(near.away) - other.farthest_along(near.away);
            let error = (near.distance - expected).abs();
            assert!(off_body < 1e-8 && error < 1.1 * EXACT_M, "{error}, {off_body}: {near:?}");
        } else {
            assert!(off_body < 1e-4, "{off_body}: {near:?}");
        }
        // A bound just beyond the distance changes nothing; below it, the pair may be left out.
        if let Some(bound) = near_convex(body, other, near.distance - 1e-6) {
            assert!((bound.distance - near.distance).abs() < 2.1 * EXACT_M, "{bound:?} {near:?}");
        }
        let within = near_convex(body, other, near.distance + 1e-6).unwrap();
        let difference = (within.distance - near.distance).abs();
        assert!(difference < 2.1 * EXACT_M || !is_apart, "{within:?} {near:?}");
        is_apart
    }

    /// Every third pair has axes in steps of 45 degrees; of these, every fourth pair has one axis.
    #[test]
    fn nearest_points_are_the_nearest() {
        let mut random = fastrand::Rng::with_seed(1);
        let (mut apart, mut touching) = (0, 0);
        let hulls = hulls(&mut random);
        for i in 0..200_000 {
            let turns = [(); 2].map(|()| turn(&mut random, i % 3 == 0));
            let mut between = |from: f64, to: f64| from + (to - from) * random.f64();
            let center = [(); 3].map(|()| between(-1.0, 1.0)).into();
            let hull = |i: usize| &hulls[i % hulls.len()];
            let mut body = solid(i % 4, turns[0], center, hull(i), &mut between);
            let mut count = |is_apart: bool| {
                if is_apart { apart += 1 } else { touching += 1 }
            };
            let size_m = [1.0, 1.5, 2.0].map(|max_size| between(0.005, max_size));
            let rows = crate::rotation::rotation(turns[1]);
            let cuboid = PlacedBox::new([0.0; 3], size_m, rows);
            count(check(&body, &cuboid, &near_convex(&body, &cuboid, f64::MAX).unwrap()));
            let other = solid(i / 4 % 3, turns[1], Vector::ZERO, hull(7 * i + 1), &mut between);
            if i % 12 == 0 {
                body =
                    PosedPart { axis: other.axis, center: between(-1.0, 1.0) * other.axis, ..body };
            }
            count(check(&body, &other, &near_convex(&body, &other, f64::MAX).unwrap()));
        }
        assert!(apart > 250_000 && touching > 20_000, "{apart} {touching}");
    }

    /// Along its axis, the farthest point of a cylinder is on a cap, whatever is lost by rounding.
    #[test]
    fn the_farthest_point_is_on_the_solid() {
        let mut random = fastrand::Rng::with_seed(4);
        for i in 0..20_000 {
            let rows = crate::rotation::rotation(turn(&mut random, i % 2 == 0));
            let axis = Vector::from(rows.map(|row| row[2]));
            let form = Volume::Cylinder { radius: 0.1, half: 0.2 };
            let part = PosedPart { center: Vector::ZERO, axis, form };
            let noise = Vector::from([(); 3].map(|()| random.f64() - 0.5));
            let direction =
                (4.0 * random.f64() - 2.0) * axis + noise * [0.0, 1e-17, 1e-14, 1e-11, 1e-8][i % 5];
            let farthest = PosedPart::support(&part, direction);
            assert!((PosedPart::nearest(&part, farthest) - farthest).length() < 1e-9);
            let short = PosedPart::farthest_along(&part, direction) - direction.dot(farthest);
            assert!(short < 1e-12 * direction.length(), "{short}");
        }
    }
}
