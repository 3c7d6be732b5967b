//! User meshes with a reduced number of triangles, and with normals.

use std::collections::HashMap;

use super::surface::{Surface, cross, difference, dot, unit};

/// Points, and triangles as point indices.
#[derive(Clone, Debug, Default)]
pub(super) struct Soup {
    /// Points, in m.
    pub(super) points: Vec<[f64; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Distance below which points are merged, in m.
const SAME_M: f64 = 1e-6;

/// Cosine of the smallest angle between two triangles whose edge is a crease.
const CREASE: f64 = 0.76;

impl Soup {
    /// Merges corners at equal positions, and removes triangles without area.
    pub(super) fn welded(&self) -> Self {
        let cell = |point: [f64; 3]| point.map(|v| (v / SAME_M).round());
        self.gathered(cell, |points| points[0])
    }

    /// Reduces the soups to at most `max_triangles` in all. The points in each cell of a grid
    /// become one corner: the point nearest to the planes of all triangles there (Lindstrom 2000),
    /// which preserves edges and flat faces.
    pub(super) fn thinned(soups: Vec<Self>, max_triangles: usize) -> Vec<Self> {
        let count = |soups: &[Self]| soups.iter().map(|soup| soup.triangles.len()).sum::<usize>();
        if count(&soups) <= max_triangles {
            return soups;
        }
        // The finest grid that is coarse enough, within a twentieth.
        let (mut fine_m, mut coarse_m) = (1e-4, 2e-4);
        let clustered =
            |size_m: f64| soups.iter().map(|soup| soup.clustered(size_m)).collect::<Vec<_>>();
        let mut thin = clustered(coarse_m);
        while count(&thin) > max_triangles {
            (fine_m, coarse_m) = (coarse_m, 2.0 * coarse_m);
            thin = clustered(coarse_m);
        }
        while coarse_m / fine_m > 1.05 {
            let middle_m = (fine_m * coarse_m).sqrt();
            let other = clustered(middle_m);
            if count(&other) > max_triangles {
                fine_m = middle_m;
            } else {
                (coarse_m, thin) = (middle_m, other);
            }
        }
        thin
    }

    fn clustered(&self, size_m: f64) -> Self {
        let cell = |point: [f64; 3]| point.map(|v| (v / size_m).floor());
        let mut planes: HashMap<[i64; 3], Quadric> = HashMap::new();
        for corners in &self.triangles {
            let [a, b, c] = corners.map(|it| self.points[it as usize]);
            let across = cross(difference(b, a), difference(c, a));
            for corner in [a, b, c] {
                planes.entry(to_grid_cell(cell(corner))).or_default().add(across, a);
            }
        }
        let middle = |points: &[[f64; 3]]| -> [f64; 3] {
            std::array::from_fn(|i| points.iter().map(|p| p[i]).sum::<f64>() / points.len() as f64)
        };
        self.gathered(cell, |points| {
            let home = cell(points[0]);
            let near = middle(points);
            let best = planes.get(&to_grid_cell(home)).map_or(near, |planes| planes.nearest(near));
            // Keeps the point near its cell.
            std::array::from_fn(|i| {
                best[i].clamp((home[i] - 0.5) * size_m, (home[i] + 1.5) * size_m)
            })
        })
    }

    /// Merges all points of a cell into one point, computed by `one`. Removes triangles between
    /// fewer than three cells, and duplicates.
    fn gathered(
        &self,
        cell: impl Fn([f64; 3]) -> [f64; 3],
        one: impl Fn(&[[f64; 3]]) -> [f64; 3],
    ) -> Self {
        let mut numbers: HashMap<[i64; 3], usize> = HashMap::new();
        let mut groups: Vec<Vec<[f64; 3]>> = Vec::new();
        let mut number_of = |point: [f64; 3]| {
            let number = *numbers.entry(to_grid_cell(cell(point))).or_insert_with(|| {
                groups.push(Vec::new());
                groups.len() - 1
            });
            groups[number].push(point);
            u32::try_from(number).unwrap_or(u32::MAX)
        };
        let mut known = std::collections::HashSet::new();
        let mut triangles = Vec::new();
        for corners in &self.triangles {
            let [a, b, c] = corners.map(|it| number_of(self.points[it as usize]));
            if a == b || b == c || c == a {
                continue;
            }
            let mut sorted = [a, b, c];
            sorted.sort_unstable();
            // A triangle and its reverse are the two sides of a sheet.
            let is_even = sorted == [a, b, c] || sorted == [b, c, a] || sorted == [c, a, b];
            if known.insert((sorted, is_even)) {
                triangles.push([a, b, c]);
            }
        }
        let points = groups.iter().map(|points| one(points)).collect();
        Self { points, triangles }
    }

    /// Returns the surface with normals: smooth where triangles meet at a small angle, with creases
    /// elsewhere.
    pub(super) fn surface(&self) -> Surface {
        let normals: Vec<[f64; 3]> =
            self.triangles.iter().map(|corners| self.across(corners)).collect();
        let mut around: Vec<Vec<usize>> = vec![Vec::new(); self.points.len()];
        for (number, corners) in self.triangles.iter().enumerate() {
            for corner in corners {
                around[*corner as usize].push(number);
            }
        }
        let mut surface = Surface::default();
        let mut generated: HashMap<(u32, [i64; 3]), u32> = HashMap::new();
        for (number, corners) in self.triangles.iter().enumerate() {
            let normal = unit(normals[number]);
            surface.triangles.push(corners.map(|corner| {
                let sum = around[corner as usize]
                    .iter()
                    .filter(|other| dot(unit(normals[**other]), normal) > CREASE)
                    .fold([0.0; 3], |sum, other| {
                        std::array::from_fn(|i| sum[i] + normals[*other][i])
                    });
                let normal = if dot(sum, sum) > 0.0 { unit(sum) } else { normal };
                let key = (corner, normal.map(|v| (v * 500.0).round()));
                *generated.entry((key.0, to_grid_cell(key.1))).or_insert_with(|| {
                    surface.positions.push(self.points[corner as usize]);
                    surface.normals.push(normal);
                    u32::try_from(surface.positions.len() - 1).unwrap_or(u32::MAX)
                })
            }));
        }
        surface
    }

    /// Outward normal of a triangle, of twice its area.
    fn across(&self, corners: &[u32; 3]) -> [f64; 3] {
        let [a, b, c] = corners.map(|it| self.points[it as usize]);
        cross(difference(b, a), difference(c, a))
    }
}

/// Sum of squared distances from planes, as a quadratic form about the origin.
#[derive(Clone, Copy, Debug, Default)]
struct Quadric {
    /// Sums of the products of the normals, and of the normals and the plane offsets.
    squares: [[f64; 3]; 3],
    offsets: [f64; 3],
}

impl Quadric {
    /// Adds the plane of a triangle through `point`; the length of the normal is its weight.
    fn add(&mut self, across: [f64; 3], point: [f64; 3]) {
        let weight = dot(across, across).sqrt();
        let normal = unit(across);
        let offset = dot(normal, point);
        for i in 0..3 {
            for j in 0..3 {
                self.squares[i][j] += weight * normal[i] * normal[j];
            }
            self.offsets[i] += weight * normal[i] * offset;
        }
    }

    /// Returns the point nearest to all planes; in undetermined directions, the point nearest to
    /// `near`.
    fn nearest(&self, near: [f64; 3]) -> [f64; 3] {
        let trace = self.squares[0][0] + self.squares[1][1] + self.squares[2][2];
        if trace <= 0.0 {
            return near;
        }
        // Slight regularisation towards `near`: a flat sheet leaves two directions undetermined.
        let pull = 1e-3 * trace;
        let mut rows: [[f64; 3]; 3] = self.squares;
        for (i, row) in rows.iter_mut().enumerate() {
            row[i] += pull;
        }
        let right: [f64; 3] = std::array::from_fn(|i| self.offsets[i] + pull * near[i]);
        let to_grid_cell = dot(rows[0], cross(rows[1], rows[2]));
        if to_grid_cell <= 0.0 {
            return near;
        }
        // Cramer's rule; the matrix is symmetric.
        std::array::from_fn(|i| {
            let mut columns = rows;
            columns[i] = right;
            dot(columns[0], cross(columns[1], columns[2])) / to_grid_cell
        })
    }
}

#[expect(clippy::cast_possible_truncation, reason = "a cell of a grid")]
fn to_grid_cell(cell: [f64; 3]) -> [i64; 3] {
    cell.map(|v| v as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a box of quads divided into squares, with separate corners for each triangle.
    fn cuboid(size: [f64; 3], cuts: u32) -> Soup {
        let mut soup = Soup::default();
        for axis in 0..3 {
            for side in [0.0, 1.0] {
                let point_at = |u: u32, v: u32| -> [f64; 3] {
                    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                    let mut point = [0.0; 3];
                    point[axis] = side * size[axis];
                    point[i] = size[i] * f64::from(u) / f64::from(cuts);
                    point[j] = size[j] * f64::from(v) / f64::from(cuts);
                    point
                };
                for (u, v) in (0..cuts).flat_map(|u| (0..cuts).map(move |v| (u, v))) {
                    let quad = [
                        point_at(u, v),
                        point_at(u + 1, v),
                        point_at(u + 1, v + 1),
                        point_at(u, v + 1),
                    ];
                    for corners in [[0, 1, 2], [0, 2, 3]] {
                        let corners =
                            if side > 0.0 { corners } else { [corners[0], corners[2], corners[1]] };
                        let first = u32::try_from(soup.points.len()).expect("few");
                        soup.points.extend(corners.map(|it| quad[it]));
                        soup.triangles.push([first, first + 1, first + 2]);
                    }
                }
            }
        }
        soup
    }

    fn ball(radius: f64, steps: u32) -> Soup {
        let mut soup = cuboid([2.0; 3], steps).welded();
        for point in &mut soup.points {
            *point = unit(point.map(|v| v - 1.0)).map(|v| radius * v);
        }
        soup
    }

    #[test]
    fn boxes_have_creases_and_balls_have_none() {
        let soup = cuboid([0.1, 0.2, 0.3], 4).welded();
        assert_eq!((soup.points.len(), soup.triangles.len()), (98, 192));
        let surface = soup.surface();
        // Two normals at edges, three at corners.
        assert_eq!(surface.positions.len(), 6 * 25);
        for normal in &surface.normals {
            let along: Vec<_> = normal.iter().filter(|v| v.abs() > 1e-9).collect();
            assert!(along.len() == 1 && (along[0].abs() - 1.0).abs() < 1e-12, "{normal:?}");
        }
        let ball = ball(0.1, 20).surface();
        assert_eq!(ball.positions.len(), 6 * 20 * 20 + 2);
        for (normal, position) in std::iter::zip(&ball.normals, &ball.positions) {
            assert!(dot(*normal, unit(*position)) > 0.995);
        }
    }

    #[test]
    fn thinned_meshes_keep_their_shape() {
        let soups = vec![ball(0.1, 60), cuboid([0.1, 0.2, 0.3], 40).welded()];
        let before: usize = soups.iter().map(|soup| soup.triangles.len()).sum();
        let thin = Soup::thinned(soups, 5000);
        let count: usize = thin.iter().map(|soup| soup.triangles.len()).sum();
        assert!((3500..=5000).contains(&count), "{count} of {before}");
        for point in &thin[0].points {
            let radius = dot(*point, *point).sqrt();
            assert!((radius - 0.1).abs() < 5e-4, "{radius}");
        }
        // Faces of a box keep their position, and so do its corners.
        for point in &thin[1].points {
            let off = std::iter::zip(point, [0.1, 0.2, 0.3])
                .map(|(v, size)| v.abs().min((v - size).abs()));
            assert!(off.fold(f64::MAX, f64::min) < 1e-5, "{point:?}");
        }
        for corner in 0..8 {
            let place: [f64; 3] =
                std::array::from_fn(
                    |i| if corner >> i & 1 == 0 { 0.0 } else { [0.1, 0.2, 0.3][i] },
                );
            let away = |point: &[f64; 3]| dot(difference(*point, place), difference(*point, place));
            let nearest = thin[1].points.iter().map(away).fold(f64::MAX, f64::min).sqrt();
            assert!(nearest < 1e-3, "corner {corner}: {nearest}");
        }
        // Small meshes are unchanged.
        let soup = cuboid([0.1; 3], 2).welded();
        assert_eq!(Soup::thinned(vec![soup.clone()], 48)[0].triangles, soup.triangles);
    }

    #[test]
    fn sheets_have_two_sides() {
        let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let soup = Soup { points, triangles: vec![[0, 1, 2], [0, 2, 1], [1, 2, 0], [0, 0, 1]] };
        assert_eq!(soup.welded().triangles.len(), 2);
        assert_eq!(soup.surface().triangles.len(), 4);
    }
}
