//! Nearest points of two convex solids by the algorithm of Gilbert, Johnson and Keerthi (1988).
//!
//! The differences `body - other` of all pairs of points form a convex set, whose distance from the
//! origin is that of the solids. A simplex of up to four of its corners approaches the origin: the
//! corner farthest along the way from the simplex to the origin is added, and corners that do not
//! support the nearest point of the new simplex are removed.

use glam::DVec3 as Vector;

/// Convex solid.
pub(crate) trait Convex {
    /// Returns the farthest point of the solid along `direction`, which may have any length.
    fn support(&self, direction: Vector) -> Vector;

    /// Returns the point of the solid nearest to `point`.
    fn nearest(&self, point: Vector) -> Vector;

    /// Returns the largest `direction . x` of the solid's points.
    fn farthest_along(&self, direction: Vector) -> f64;
}

/// Accepted error of a distance, in m.
pub(crate) const EXACT_M: f64 = 1e-7;

/// Nearest points of two solids, as far as GJK finds them.
pub(crate) enum Approach {
    /// The solids are at least the given distance apart.
    Apart,
    /// Nearest points of the body and of the other solid, to within [`EXACT_M`].
    Nearest(Vector, Vector),
    /// A point of the other solid: rounding has stopped the simplex on its way, or the solids
    /// overlap.
    Unproven(Vector),
}

/// Pair of points, one of each solid.
#[derive(Clone, Copy, Default)]
struct CornerPair {
    on_body: Vector,
    on_other: Vector,
}

impl CornerPair {
    /// Returns the pair whose difference is farthest along `direction`.
    fn farthest(body: &impl Convex, other: &impl Convex, direction: Vector) -> Self {
        Self { on_body: body.support(direction), on_other: other.support(-direction) }
    }

    fn way(&self) -> Vector {
        self.on_body - self.on_other
    }
}

/// Maximum number of corners that are added. Most pairs need fewer than ten.
const MAX_CORNERS: usize = 50;

/// Searches for the nearest points. `first_way` leads from the other solid to the body. The search
/// ends early if the solids are at least `max_distance` apart.
pub(crate) fn approach(
    body: &impl Convex,
    other: &impl Convex,
    first_way: Vector,
    max_distance: f64,
) -> Approach {
    let mut nearest = CornerPair::farthest(body, other, -first_way);
    let mut simplex = [nearest; 4];
    let mut len = 1;
    for _ in 0..MAX_CORNERS {
        let way = nearest.way();
        let length = way.length();
        if length < EXACT_M {
            break;
        }
        let corner = CornerPair::farthest(body, other, -way);
        let along = way.dot(corner.way()) / length;
        if along >= max_distance || length - along < EXACT_M {
            // A proof that does not use the corners, which rounding may have moved.
            let apart = apart(body, other, way / length);
            if apart >= max_distance {
                return Approach::Apart;
            }
            if (length - apart).abs() < EXACT_M {
                return Approach::Nearest(nearest.on_body, nearest.on_other);
            }
            break;
        }
        if len == simplex.len() {
            break;
        }
        simplex[len] = corner;
        let next;
        (next, len) = reduce(&mut simplex, len);
        if next.way().length_squared() >= length * length {
            break;
        }
        nearest = next;
    }
    Approach::Unproven(nearest.on_other)
}

/// Returns the separation of both solids along `way`, a unit vector from the other solid to the
/// body: a lower bound of their distance. If it is positive, a plane perpendicular to `way`
/// separates them.
pub(crate) fn apart(body: &impl Convex, other: &impl Convex, way: Vector) -> f64 {
    -body.farthest_along(-way) - other.farthest_along(way)
}

/// Returns the point of a simplex that is nearest to the origin; the last corner of the simplex has
/// the index `last`. Keeps only the corners that span the face with this point, and returns their
/// number.
///
/// The nearest point of the other corners is known already, and the last corner leads beyond it, so
/// that only faces with the last corner are searched. Whatever is lost by rounding, the result is a
/// point of the simplex.
fn reduce(simplex: &mut [CornerPair; 4], last: usize) -> (CornerPair, usize) {
    let corner = simplex[last];
    let from = corner.way();
    let edges = simplex.map(|other| other.way() - from);
    let mut best = (corner, 0);
    let mut best_square = from.length_squared();
    for face in 1..1_usize << last {
        let mut chosen = [0; 3];
        let mut size = 0;
        for i in (0..last).filter(|i| face >> i & 1 == 1) {
            chosen[size] = i;
            size += 1;
        }
        let Some(shares) = shares(chosen.map(|i| edges[i]), size, from) else { continue };
        let mut point = corner;
        for (i, share) in chosen.into_iter().zip(shares).take(size) {
            point.on_body += share * (simplex[i].on_body - corner.on_body);
            point.on_other += share * (simplex[i].on_other - corner.on_other);
        }
        let square = point.way().length_squared();
        if square < best_square {
            (best, best_square) = ((point, face), square);
        }
    }
    let (point, face) = best;
    let mut kept = 0;
    for i in (0..last).filter(|i| face >> i & 1 == 1) {
        simplex[kept] = simplex[i];
        kept += 1;
    }
    simplex[kept] = corner;
    (point, kept + 1)
}

/// Returns the multiples of the first `size` edges from a corner at `from` that lead to the point
/// of their line, plane or space nearest to the origin; none if it is not between the corners.
fn shares([a, b, c]: [Vector; 3], size: usize, from: Vector) -> Option<[f64; 3]> {
    let shares = match size {
        1 => [-from.dot(a) / a.dot(a), 0.0, 0.0],
        2 => {
            let (aa, ab, bb) = (a.dot(a), a.dot(b), b.dot(b));
            let (fa, fb) = (from.dot(a), from.dot(b));
            let square = aa * bb - ab * ab;
            [(fb * ab - fa * bb) / square, (fa * ab - fb * aa) / square, 0.0]
        }
        _ => {
            let bc = b.cross(c);
            let fa = from.cross(a);
            [-from.dot(bc) / a.dot(bc), fa.dot(c) / a.dot(bc), -fa.dot(b) / a.dot(bc)]
        }
    };
    // NaN, of a degenerate face, is not between any corners.
    let is_between = shares.iter().all(|share| *share >= 0.0) && shares.iter().sum::<f64>() <= 1.0;
    is_between.then_some(shares)
}
