//! Convex hull of points in space.
//!
//! Uses Quickhull (Barber, Dobkin, Huhdanpaa, "The Quickhull algorithm for convex hulls", 1996),
//! with Shewchuk's exact predicate for the side of a plane on which a point is: CAD models contain
//! thousands of coplanar and collinear points, for which rounding leads to hulls that are not
//! closed.

use std::collections::HashMap;

use glam::DVec3 as Vector;
use robust::{Coord3D, orient3d};

/// Reason why points have no hull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum NoHull {
    /// All points are within this distance of one plane, or there are fewer than four.
    Flat,
    /// The hull has more facets than allowed.
    TooMany,
}

/// Triangle of the current hull.
struct Facet {
    /// Counterclockwise from outside.
    corners: [u32; 3],
    /// Facets across the edge from each corner to the next.
    neighbours: [u32; 3],
    /// Points outside that are not assigned to another facet.
    outside: Vec<u32>,
    is_alive: bool,
}

/// Returns the triangles of the hull, as indices of `points`, counterclockwise from outside.
///
/// The points must be finite, sorted and unique. Points within a thickness of `min_thickness` are
/// flat.
pub(crate) fn hull(
    points: &[Vector],
    min_thickness: f64,
    max_facets: usize,
) -> Result<Vec<[u32; 3]>, NoHull> {
    let first = tetrahedron(points, min_thickness).ok_or(NoHull::Flat)?;
    let [a, b, c, d] = first;
    let mut hull = Growing { points, facets: Vec::new() };
    for (corners, neighbours) in [
        ([a, b, c], [1, 2, 3]),
        ([b, a, d], [0, 3, 2]),
        ([c, b, d], [0, 1, 3]),
        ([a, c, d], [0, 2, 1]),
    ] {
        hull.facets.push(Facet { corners, neighbours, outside: Vec::new(), is_alive: true });
    }
    let rest = (0..).zip(points).map(|(index, _)| index).filter(|point| !first.contains(point));
    hull.share_out(rest.collect(), 0);
    let (mut next, mut alive) = (0, 4);
    while next < hull.facets.len() {
        if hull.facets[next].is_alive
            && let Some(point) = hull.farthest(next)
        {
            let (removed, new) = hull.add(point, next);
            alive = alive - removed + new;
            if alive > max_facets {
                return Err(NoHull::TooMany);
            }
        }
        next += 1;
    }
    Ok(hull.facets.iter().filter(|facet| facet.is_alive).map(|facet| facet.corners).collect())
}

/// Returns four points with a volume; the last one is below the plane of the others.
fn tetrahedron(points: &[Vector], min_thickness: f64) -> Option<[u32; 4]> {
    // Any four points are valid: the farther apart they are, the fewer points remain outside.
    let best = |measure: &dyn Fn(Vector) -> f64| {
        let measured = (0..).zip(points).map(|(index, point)| (index, measure(*point)));
        measured.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(index, _): (u32, _)| index)
    };
    let at = |index: u32| points[index as usize];
    let a = best(&|p| -p.x)?;
    let b = best(&|p| p.distance_squared(at(a)))?;
    let along = (at(b) - at(a)).try_normalize()?;
    let c = best(&|p| (p - at(a)).cross(along).length_squared())?;
    let normal = (at(b) - at(a)).cross(at(c) - at(a)).try_normalize()?;
    let d = best(&|p| normal.dot(p - at(a)).abs())?;
    if normal.dot(at(d) - at(a)).abs() < min_thickness {
        return None;
    }
    let side = side(points, [a, b, c], d);
    match side {
        _ if side < 0.0 => Some([a, b, c, d]),
        _ if side > 0.0 => Some([b, a, c, d]),
        _ => None,
    }
}

/// Returns a positive value if `point` is on the side of a plane from which its corners are
/// counterclockwise. The sign is exact, and the value is 0 in the plane.
fn side(points: &[Vector], plane: [u32; 3], point: u32) -> f64 {
    let at = |index: u32| {
        let Vector { x, y, z } = points[index as usize];
        Coord3D { x, y, z }
    };
    let [a, b, c] = plane.map(at);
    -orient3d(a, b, c, at(point))
}

struct Growing<'a> {
    points: &'a [Vector],
    facets: Vec<Facet>,
}

impl Growing<'_> {
    fn sees(&self, point: u32, facet: usize) -> bool {
        side(self.points, self.facets[facet].corners, point) > 0.0
    }

    /// Assigns each of `outside` to a visible facet with an index of at least `from`. Points
    /// without such a facet are inside.
    fn share_out(&mut self, outside: Vec<u32>, from: usize) {
        for point in outside {
            if let Some(facet) = (from..self.facets.len()).find(|facet| self.sees(point, *facet)) {
                self.facets[facet].outside.push(point);
            }
        }
    }

    /// Returns the point assigned to a facet that is farthest from it: a corner of the hull.
    fn farthest(&self, facet: usize) -> Option<u32> {
        let Facet { corners, outside, .. } = &self.facets[facet];
        let [a, b, c] = corners.map(|corner| self.points[corner as usize]);
        let normal = (b - a).cross(c - a);
        let height = |point: u32| normal.dot(self.points[point as usize]);
        // Among points at the same distance, one that is not a corner must not be taken first: the
        // last one in order is a corner.
        outside.iter().copied().max_by(|a, b| height(*a).total_cmp(&height(*b)).then(a.cmp(b)))
    }

    /// Adds a point that sees `facet` to the hull. Returns the numbers of removed and added facets.
    fn add(&mut self, point: u32, facet: usize) -> (usize, usize) {
        // All visible facets are connected, and their boundary is a single ring.
        let mut visible = vec![facet];
        self.facets[facet].is_alive = false;
        let mut ring = Vec::new();
        let mut next = 0;
        while let Some(&facet) = visible.get(next) {
            next += 1;
            for edge in 0..3 {
                let beyond = self.facets[facet].neighbours[edge] as usize;
                if !self.facets[beyond].is_alive {
                    continue;
                }
                if self.sees(point, beyond) {
                    self.facets[beyond].is_alive = false;
                    visible.push(beyond);
                } else {
                    let corners = self.facets[facet].corners;
                    ring.push((corners[edge], corners[(edge + 1) % 3], beyond));
                }
            }
        }
        let first = self.facets.len();
        let index = |value: usize| u32::try_from(value).unwrap_or(u32::MAX);
        let starts = (first..).zip(&ring).map(|(new, edge)| (edge.0, index(new)));
        let starts = starts.collect::<HashMap<_, _>>();
        let ends = (first..).zip(&ring).map(|(new, edge)| (edge.1, index(new)));
        let ends = ends.collect::<HashMap<_, _>>();
        for (new, (start, end, beyond)) in (first..).zip(&ring) {
            let neighbour = &mut self.facets[*beyond];
            if let Some(edge) = (0..3).find(|edge| neighbour.corners[*edge] == *end) {
                neighbour.neighbours[edge] = index(new);
            }
            let neighbours = [index(*beyond), starts[end], ends[start]];
            let corners = [*start, *end, point];
            self.facets.push(Facet { corners, neighbours, outside: Vec::new(), is_alive: true });
        }
        let orphans =
            visible.iter().flat_map(|facet| std::mem::take(&mut self.facets[*facet].outside));
        let orphans = orphans.filter(|orphan| *orphan != point).collect();
        self.share_out(orphans, first);
        (visible.len(), ring.len())
    }
}
