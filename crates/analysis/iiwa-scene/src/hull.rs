//! Convex hulls, as parts of a tool.

use std::sync::Arc;

use glam::DVec3 as Vector;

use crate::{
    extent::{MAX_M, MIN_SIZE_M},
    quickhull::{NoHull, hull},
};

/// Convex hull of points, in their frame: the smallest convex solid that contains all of them.
///
/// ```
/// use iiwa_scene::ConvexHull;
///
/// // A pyramid, and a point inside.
/// let corners =
///     [[0.0, 0.0, 0.1], [0.1, 0.1, 0.0], [-0.1, 0.1, 0.0], [-0.1, -0.1, 0.0], [0.1, -0.1, 0.0]];
/// let hull = ConvexHull::new(corners.into_iter().chain([[0.0, 0.0, 0.05]]))?;
/// assert_eq!((hull.corners_m().len(), hull.triangles().len()), (5, 6));
/// # Ok::<(), iiwa_scene::NotSolid>(())
/// ```
///
/// Clones share the data.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvexHull(Arc<HullSurface>);

#[derive(Debug, PartialEq)]
struct HullSurface {
    corners_m: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

/// Maximum number of corners of a hull: a hull that costs a thousand times as much as a link is not
/// useful.
const MAX_CORNERS: usize = 10_000;

/// Reason why points have no usable convex hull.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NotSolid {
    /// A coordinate is not finite, or out of range.
    #[error("a point has a coordinate that is not a number, or farther than {} m away", MAX_M)]
    Range,
    /// The points are coplanar.
    #[error("its points are all in one plane, or fewer than four: it has no volume")]
    Flat,
    /// The hull has too many corners.
    #[error("its convex hull has more than {max} corners: make it coarser")]
    TooManyCorners {
        /// Maximum number of corners.
        max: usize,
    },
}

impl ConvexHull {
    /// Creates the hull of `points_m`, in m; exact for any points.
    ///
    /// # Errors
    ///
    /// If a coordinate is not finite or beyond a kilometre, if the points are coplanar, or if the
    /// hull has more than 10 000 corners.
    pub fn new(points_m: impl IntoIterator<Item = [f64; 3]>) -> Result<Self, NotSolid> {
        let mut points = points_m.into_iter().collect::<Vec<_>>();
        if points.iter().flatten().any(|value| !(-MAX_M..=MAX_M).contains(value)) {
            return Err(NotSolid::Range);
        }
        // Meshes repeat a corner for each of its triangles. Adding 0 removes the sign of zeros, so
        // that equal points compare equal.
        points.iter_mut().flatten().for_each(|value| *value += 0.0);
        let order = |a: &[f64; 3], b: &[f64; 3]| {
            a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]))
        };
        points.sort_unstable_by(order);
        points.dedup();
        let points = points.into_iter().map(Vector::from).collect::<Vec<_>>();
        let too_many = NotSolid::TooManyCorners { max: MAX_CORNERS };
        if u32::try_from(points.len()).is_err() {
            return Err(too_many);
        }
        // A closed surface with n corners has 2 n - 4 triangles.
        let triangles = hull(&points, MIN_SIZE_M, 2 * MAX_CORNERS - 4);
        let mut triangles = triangles.map_err(|error| match error {
            NoHull::Flat => NotSolid::Flat,
            NoHull::TooMany => too_many,
        })?;
        let mut used = triangles.iter().flatten().copied().collect::<Vec<_>>();
        used.sort_unstable();
        used.dedup();
        for corner in triangles.iter_mut().flatten() {
            let place = used.partition_point(|used| used < corner);
            *corner = u32::try_from(place).unwrap_or(u32::MAX);
        }
        let corners_m = used.iter().map(|point| points[*point as usize].into()).collect();
        Ok(Self(Arc::new(HullSurface { corners_m, triangles })))
    }

    /// Returns the corners, in m.
    #[must_use]
    pub fn corners_m(&self) -> &[[f64; 3]] {
        &self.0.corners_m
    }

    /// Returns the surface: triangles of corner indices, counterclockwise from outside.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.0.triangles
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rotation::rotation;

    fn turned(points: &[[f64; 3]], rpy: [f64; 3]) -> Vec<[f64; 3]> {
        let rows = rotation(rpy).map(Vector::from);
        let turn = |p: &[f64; 3]| rows.map(|row| row.dot(Vector::from(*p)));
        points.iter().map(turn).collect()
    }

    /// The surface is closed, with each edge once in each direction; no point is outside, and its
    /// corners are points.
    fn is_hull(hull: &ConvexHull, points: &[[f64; 3]], error: f64) {
        let mut edges = std::collections::HashSet::new();
        for triangle in hull.triangles() {
            for edge in 0..3 {
                assert!(edges.insert((triangle[edge], triangle[(edge + 1) % 3])));
            }
            let [a, b, c] = triangle.map(|corner| Vector::from(hull.corners_m()[corner as usize]));
            let normal = (b - a).cross(c - a);
            for point in points {
                let outside = normal.dot(Vector::from(*point) - a);
                // Slivers have no reliable normal.
                assert!(outside <= error * normal.length() + 1e-16, "{outside}");
            }
        }
        assert!(edges.iter().all(|(from, to)| edges.contains(&(*to, *from))));
        assert_eq!(hull.triangles().len(), 2 * hull.corners_m().len() - 4);
        assert!(hull.corners_m().iter().all(|corner| points.contains(corner)));
    }

    #[test]
    fn holds_random_points() {
        let mut random = fastrand::Rng::with_seed(2);
        for round in 0..200 {
            let points = (0..4 + 3 * round).map(|_| [(); 3].map(|()| random.f64() - 0.5));
            let points = points.collect::<Vec<_>>();
            is_hull(&ConvexHull::new(points.iter().copied()).unwrap(), &points, 1e-13);
        }
    }

    /// A lattice contains all kinds of collinear and coplanar points, for which rounding leads to
    /// errors.
    #[test]
    fn holds_lattices_however_they_are_turned() {
        let mut random = fastrand::Rng::with_seed(3);
        for round in 0..60 {
            let steps = || (0..7).map(|i| f64::from(i) / 10.0);
            let lattice =
                steps().flat_map(|x| steps().flat_map(move |y| steps().map(move |z| [x, y, z])));
            let lattice = lattice.collect::<Vec<_>>();
            let angle = || if round == 0 { 0.0 } else { 6.0 * random.f64() };
            let rpy = [(); 3].map({
                let mut angle = angle;
                move |()| angle()
            });
            let mut points = turned(&lattice, rpy);
            if round % 2 == 1 {
                // Single precision, as in a file.
                #[expect(clippy::cast_possible_truncation, reason = "it is meant")]
                points.iter_mut().flatten().for_each(|v| *v = f64::from(*v as f32));
            }
            let hull = ConvexHull::new(points.iter().copied()).unwrap();
            is_hull(&hull, &points, if round % 2 == 1 { 1e-7 } else { 1e-14 });
            if round == 0 {
                assert_eq!(hull.corners_m().len(), 8);
            }
        }
    }

    #[test]
    fn points_without_volume_are_refused() {
        let plane = (0..30).map(|i| [f64::from(i % 5), f64::from(i / 5), 0.0]).collect::<Vec<_>>();
        for rpy in [[0.0; 3], [0.3, 0.4, 0.5]] {
            assert_eq!(ConvexHull::new(turned(&plane, rpy)), Err(NotSolid::Flat));
        }
        assert_eq!(ConvexHull::new(plane[..4].to_vec()), Err(NotSolid::Flat));
        assert_eq!(ConvexHull::new([[1.0; 3]; 10]), Err(NotSolid::Flat));
        assert_eq!(ConvexHull::new([]), Err(NotSolid::Flat));
        assert_eq!(ConvexHull::new([[f64::NAN, 0.0, 0.0]]), Err(NotSolid::Range));
        assert_eq!(ConvexHull::new([[2000.0, 0.0, 0.0]]), Err(NotSolid::Range));
        let mut random = fastrand::Rng::with_seed(5);
        let ball = (0..20_000).map(|_| {
            let point = Vector::from([(); 3].map(|()| random.f64() - 0.5));
            <[f64; 3]>::from(point.normalize())
        });
        assert_eq!(ConvexHull::new(ball), Err(NotSolid::TooManyCorners { max: MAX_CORNERS }));
    }
}
