//! Triangles of smooth surfaces.

use std::f64::consts::{PI, TAU};

/// Triangles with a normal at each corner. Seen from outside, corners go round to the left.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surface {
    /// In m.
    pub(crate) positions: Vec<[f64; 3]>,
    /// Of length 1, outwards.
    pub(crate) normals: Vec<[f64; 3]>,
    /// Numbers of their corners.
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// A corner of an outline: its distance from the axis, its height, and the radius that rounds it off, all in m.
pub(super) type Bend = (f64, f64, f64);

/// From one side to the next of what is turned about an axis.
const SIDES: usize = 36;

impl Surface {
    /// What an outline encloses that is turned about the z axis: from the axis at the bottom to the axis at the top.
    pub(super) fn turned(outline: &[Bend]) -> Self {
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
            // At the axis, one side of four has no length.
            let ends = [profile[row - 1].0[0], profile[row].0[0]];
            surface.stitch(
                [row - 1, row].map(|row| row * SIDES),
                SIDES,
                ends.map(|radius| radius > 0.0),
            );
        }
        surface
    }

    /// A tube through rings of points, each of as many, with flat ends. `at` takes how far along (0 to 1) and the angle
    /// around the tube, in rad, to the left of the way along.
    pub(super) fn tube(rows: usize, at: impl Fn(f64, f64) -> [f64; 3]) -> Self {
        const STEP: f64 = 1e-4;
        let mut surface = Self::default();
        for row in 0..=rows {
            let along = row as f64 / rows as f64;
            for k in 0..SIDES {
                let angle = TAU * k as f64 / SIDES as f64;
                let (before, after) = ((along - STEP).max(0.0), (along + STEP).min(1.0));
                let forth = difference(at(after, angle), at(before, angle));
                let round = difference(at(along, angle + STEP), at(along, angle - STEP));
                surface.positions.push(at(along, angle));
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
                let (here, next) = (first + k, first + (k + 1) % sides);
                if is_end { [here, next, first + sides] } else { [next, here, first + sides] }
            }));
        }
        surface
    }

    /// Joins two rings of corners.
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

    /// All points taken elsewhere by `place`, their normals by `turn`, which may mirror both.
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

/// Points of an outline whose corners are arcs, and the normals there, both as distance from the axis and height.
fn rounded(outline: &[Bend]) -> Vec<([f64; 2], [f64; 2])> {
    // As fine as it takes for edges to look round: small ones need less.
    let step = |radius_m: f64| PI / (3.0 + 300.0 * radius_m).clamp(3.0, 14.0);
    let way = |from: Bend, to: Bend| {
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
        // As long as both sides of the corner have room for it.
        let room = 0.499 * come_m.min(go_m);
        let cut = (corner.2 * (turn / 2.0).tan().abs()).min(room);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
        let steps = ((turn.abs() / step(corner.2)).ceil() as usize).max(1);
        let radius = if turn == 0.0 { 0.0 } else { cut / (turn / 2.0).tan() };
        let start = [place[0] - cut * come[0], place[1] - cut * come[1]];
        for step in 0..=steps {
            let angle = turn * step as f64 / steps as f64;
            let (sin, cos) = angle.sin_cos();
            // On the circle that touches both sides; to the left, if the outline turns left.
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

/// The vector of length 1; none of length 0.
pub(super) fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    if length > 0.0 { v.map(|value| value / length) } else { [0.0, 0.0, 1.0] }
}
