//! Convex polyhedron, prepared for distance queries.

use glam::DVec3 as Vector;

use crate::hull::ConvexHull;

/// Convex polyhedron relative to its centre, in its own axes.
#[derive(Debug)]
pub(crate) struct Polyhedron {
    corners: Vec<Vector>,
    faces: Vec<Face>,
}

/// Triangle.
#[derive(Debug)]
pub(crate) struct Face {
    pub(crate) corners: [Vector; 3],
    /// Outward unit normal.
    normal: Vector,
    /// Offset of the plane, along the normal.
    offset: f64,
    /// Unit vectors perpendicular to each edge, into the triangle.
    inward: [Vector; 3],
}

/// Width in m below which a triangle has no reliable plane; its neighbours are as close. Rounding
/// can shift any plane by as much.
const SLIVER_M: f64 = 1e-9;

impl Polyhedron {
    /// Creates the polyhedron of a hull, and returns its centre in the frame of the points.
    pub(crate) fn new(hull: &ConvexHull) -> (Self, Vector) {
        let points = || hull.corners_m().iter().map(|corner| Vector::from(*corner));
        let low = points().fold(Vector::MAX, Vector::min);
        let high = points().fold(Vector::MIN, Vector::max);
        let center = 0.5 * (low + high);
        let corners = points().map(|point| point - center).collect::<Vec<_>>();
        let face = |triangle: &[u32; 3]| Face::new(triangle.map(|i| corners[i as usize]));
        let faces = hull.triangles().iter().filter_map(face).collect();
        (Self { corners, faces }, center)
    }

    /// Returns the largest `measure` of the corners.
    pub(crate) fn bound(&self, measure: impl Fn(Vector) -> f64) -> f64 {
        self.corners.iter().map(|corner| measure(*corner)).fold(0.0, f64::max)
    }

    /// Returns the farthest corner along `direction`.
    pub(crate) fn support(&self, direction: Vector) -> Vector {
        let mut best = (f64::MIN, Vector::ZERO);
        for corner in &self.corners {
            let along = direction.dot(*corner);
            if along > best.0 {
                best = (along, *corner);
            }
        }
        best.1
    }

    /// Returns the point of the polyhedron nearest to `point`.
    pub(crate) fn nearest(&self, point: Vector) -> Vector {
        let mut best = (f64::MAX, point);
        // From outside, the nearest point is on a visible face. With a margin, since among coplanar
        // triangles rounding may make another one visible than that with the nearest point.
        let is_visible = |face: &&Face| face.normal.dot(point) > face.offset - SLIVER_M;
        for face in self.faces.iter().filter(is_visible) {
            let on_face = face.nearest(point);
            let square = on_face.distance_squared(point);
            if square < best.0 {
                best = (square, on_face);
            }
        }
        best.1
    }
}

impl Face {
    /// Creates a face; none for a sliver.
    pub(crate) fn new(corners: [Vector; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let across = (b - a).cross(c - a);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        if across.length() <= SLIVER_M * longest {
            return None;
        }
        let normal = across.normalize();
        let inward = [b - a, c - b, a - c].map(|edge| normal.cross(edge).normalize_or_zero());
        Some(Self { corners, normal, offset: normal.dot(a), inward })
    }

    /// Transforms the face by a rigid motion; `place` transforms points, and `turn` transforms
    /// directions. Far from the origin, rounding may make the corners coincide: the directions are
    /// those of the face before the motion.
    pub(crate) fn moved(
        &self,
        place: impl Fn(Vector) -> Vector,
        turn: impl Fn(Vector) -> Vector,
    ) -> Self {
        let corners = self.corners.map(place);
        let normal = turn(self.normal);
        Self { corners, normal, offset: normal.dot(corners[0]), inward: self.inward.map(turn) }
    }

    /// Returns the largest `direction . x` of the triangle's points.
    pub(crate) fn farthest_along(&self, direction: Vector) -> f64 {
        self.corners.iter().map(|corner| direction.dot(*corner)).fold(f64::MIN, f64::max)
    }

    /// Returns the farthest corner along `direction`.
    pub(crate) fn support(&self, direction: Vector) -> Vector {
        let [first, others @ ..] = self.corners;
        others.into_iter().fold(first, |best, corner| {
            if direction.dot(corner) > direction.dot(best) { corner } else { best }
        })
    }

    /// Returns the point of the triangle nearest to `point`.
    pub(crate) fn nearest(&self, point: Vector) -> Vector {
        let within = |i: usize| self.inward[i].dot(point - self.corners[i]) >= 0.0;
        if (0..3).all(within) {
            return point - (self.normal.dot(point) - self.offset) * self.normal;
        }
        let on_edge = |i: usize| {
            let (start, end) = (self.corners[i], self.corners[(i + 1) % 3]);
            let way = end - start;
            let square = way.length_squared();
            // Corners may coincide, as `moved` describes.
            let share = if square > 0.0 { (point - start).dot(way) / square } else { 0.0 };
            start + share.clamp(0.0, 1.0) * way
        };
        let [first, second, third] = [0, 1, 2].map(on_edge);
        let nearer = |a: Vector, b: Vector| {
            if a.distance_squared(point) < b.distance_squared(point) { a } else { b }
        };
        nearer(nearer(first, second), third)
    }
}
