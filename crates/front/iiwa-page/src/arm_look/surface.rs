//! Triangles of smooth surfaces.

use std::f64::consts::{PI, TAU};

/// Triangles with a normal at each corner. Seen from outside, the corners are in counter-clockwise
/// order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surface {
    /// Corners, in m.
    pub(crate) positions: Vec<[f64; 3]>,
    /// Outward unit normals.
    pub(crate) normals: Vec<[f64; 3]>,
    /// Indices of the corners.
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// Corner of an outline: distance from the axis, height, and rounding radius, all in m.
pub(super) type OutlineCorner = (f64, f64, f64);

/// Number of sides of a body of revolution.
const SIDES: usize = 36;

impl Surface {
    /// Returns the body of revolution of an outline about the z axis: from the axis at the bottom
    /// to the axis at the top.
    pub(super) fn turned(outline: &[OutlineCorner]) -> Self {
        let profile = rounded(outline);
        let mut surface = Self::default();
        for ([radius, height], [out, up]) in &profile {
            for k in 0..SIDES {
                let (sin, cos) = (TAU * k as f64 / SIDES as f64).sin_cos();
                surface.positions.push([radius * cos, radius * sin, *height]);
                surface.normals.push([out * cos, out * sin, *up]);
            }
        }
        for row in 1..profile.len() {
            // At the axis, one of the four sides has zero length.
            let ends = [profile[row - 1].0[0], profile[row].0[0]];
            surface.stitch(
                [row - 1, row].map(|row| row * SIDES),
                SIDES,
                ends.map(|radius| radius > 0.0),
            );
        }
        surface
    }

    /// Returns a tube through rings of points, with flat ends. `point_at` takes the position along
    /// the tube (0 to 1) and the angle around it, in rad, counter-clockwise about its direction.
    pub(super) fn tube(rows: usize, point_at: impl Fn(f64, f64) -> [f64; 3]) -> Self {
        const STEP: f64 = 1e-4;
        let mut surface = Self::default();
        for row in 0..=rows {
            let along = row as f64 / rows as f64;
            for k in 0..SIDES {
                let angle = TAU * k as f64 / SIDES as f64;
                let (before, after) = ((along - STEP).max(0.0), (along + STEP).min(1.0));
                let forth = difference(point_at(after, angle), point_at(before, angle));
                let round =
                    difference(point_at(along, angle + STEP), point_at(along, angle - STEP));
                surface.positions.push(point_at(along, angle));
                surface.normals.push(unit(cross(round, forth)));
            }
            if row > 0 {
                surface.stitch([row - 1, row].map(|row| row * SIDES), SIDES, [true, true]);
            }
        }
        for (row, is_end) in [(0, false), (rows, true)] {
            let ring = surface.positions[row * SIDES..(row + 1) * SIDES].to_vec();
            let [a, b, c] = [0, SIDES / 3, 2 * SIDES / 3].map(|k| ring[k]);
            let across = unit(cross(difference(b, a), difference(c, a)));
            let normal = if is_end { across } else { across.map(|v| -v) };
            let first = count(surface.positions.len());
            let middle = [0, 1, 2].map(|i| ring.iter().map(|p| p[i]).sum::<f64>() / SIDES as f64);
            surface.positions.extend(ring.into_iter().chain([middle]));
            surface.normals.extend([normal; SIDES + 1]);
            let sides = count(SIDES);
            surface.triangles.extend((0..sides).map(|k| {
                let (current, next) = (first + k, first + (k + 1) % sides);
                if is_end { [current, next, first + sides] } else { [next, current, first + sides] }
            }));
        }
        surface
    }

    /// Connects two rings of corners by triangles.
    fn stitch(&mut self, [low, high]: [usize; 2], sides: usize, [below, above]: [bool; 2]) {
        for k in 0..sides {
            let next = (k + 1) % sides;
            let [a, b, c, d] = [low + k, low + next, high + next, high + k].map(count);
            if below {
                self.triangles.push([a, b, c]);
            }
            if above {
                self.triangles.push([a, c, d]);
            }
        }
    }

    /// Maps all points by `place` and their normals by `turn`, which may mirror both.
    pub(super) fn moved(
        mut self,
        place: impl Fn([f64; 3]) -> [f64; 3],
        turn: impl Fn([f64; 3]) -> [f64; 3],
    ) -> Self {
        let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(&turn);
        for position in &mut self.positions {
            *position = place(*position);
        }
        for normal in &mut self.normals {
            *normal = turn(*normal);
        }
        if dot(cross(x, y), z) < 0.0 {
            for triangle in &mut self.triangles {
                triangle.swap(1, 2);
            }
        }
        self
    }
}

/// Returns points of an outline whose corners are arcs, and their normals, both as distance from
/// the axis and height.
fn rounded(outline: &[OutlineCorner]) -> Vec<([f64; 2], [f64; 2])> {
    // Fine enough for edges to look round: small radii need fewer steps.
    let step = |radius_m: f64| PI / (3.0 + 300.0 * radius_m).clamp(3.0, 14.0);
    let way = |from: OutlineCorner, to: OutlineCorner| {
        let [r, z] = [to.0 - from.0, to.1 - from.1];
        let length = r.hypot(z);
        ([r / length, z / length], length)
    };
    let right = |[r, z]: [f64; 2]| [z, -r];
    let mut profile = Vec::new();
    for (i, corner) in outline.iter().enumerate() {
        let place = [corner.0, corner.1];
        let before = i.checked_sub(1).map(|i| way(outline[i], *corner));
        let after = outline.get(i + 1).map(|next| way(*corner, *next));
        let (Some((come, come_m)), Some((go, go_m))) = (before, after) else {
            profile.extend(before.or(after).map(|(way, _)| (place, right(way))));
            continue;
        };
        let turn = (come[0] * go[1] - come[1] * go[0]).atan2(come[0] * go[0] + come[1] * go[1]);
        // Limited to the length available on both sides of the corner.
        let room = 0.499 * come_m.min(go_m);
        let cut = (corner.2 * (turn / 2.0).tan().abs()).min(room);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
        let steps = ((turn.abs() / step(corner.2)).ceil() as usize).max(1);
        let radius = if turn == 0.0 { 0.0 } else { cut / (turn / 2.0).tan() };
        let start = [place[0] - cut * come[0], place[1] - cut * come[1]];
        for step in 0..=steps {
            let angle = turn * step as f64 / steps as f64;
            let (sin, cos) = angle.sin_cos();
            // On the circle tangent to both sides; to the left if the outline turns left.
            let (forth, left) = (radius * sin, radius * (1.0 - cos));
            let point = [
                start[0] + forth * come[0] - left * come[1],
                start[1] + forth * come[1] + left * come[0],
            ];
            let heading = [come[0] * cos - come[1] * sin, come[0] * sin + come[1] * cos];
            profile.push((point, right(heading)));
        }
    }
    profile
}

#[expect(clippy::cast_possible_truncation, reason = "far fewer")]
fn count(number: usize) -> u32 {
    number as u32
}

pub(super) fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    std::iter::zip(a, b).map(|(a, b)| a * b).sum()
}

/// Returns the unit vector; the z axis for the zero vector.
pub(super) fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    if length > 0.0 { v.map(|value| value / length) } else { [0.0, 0.0, 1.0] }
}
