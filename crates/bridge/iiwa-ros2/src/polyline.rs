//! Polylines in joint space: arc length, and the points at which the robot has to stop.

use std::f64::consts::FRAC_1_SQRT_2;

use iiwa_kin::{
    Joints,
    vector::{self, distance},
};

/// Distance below which a point is omitted, in rad: the direction from the previous point would be
/// dominated by rounding.
const SAME_RAD: f64 = 1e-7;

/// Cosine of the sharpest corner that is rounded, as the angle between the directions before and
/// after: 135 degrees. At a sharper corner the path reverses and cannot be rounded.
const SHARPEST: f64 = -FRAC_1_SQRT_2;

/// Points connected by straight lines, and the arc length up to each point, in rad.
#[derive(Clone, Debug)]
pub(super) struct Polyline {
    points: Vec<Joints>,
    ways: Vec<f64>,
}

impl Polyline {
    /// Creates a polyline through `points`, without repeated points. The first and the last point
    /// are kept.
    pub(super) fn new(points: &[Joints]) -> Self {
        let mut vertices: Vec<Joints> = Vec::with_capacity(points.len());
        for point in points {
            if vertices.last().is_none_or(|last| distance(last, point) > SAME_RAD) {
                vertices.push(*point);
            }
        }
        // The end is exact, regardless of which one of two close points was omitted.
        if let (Some(vertices), Some(last)) = (vertices.last_mut(), points.last()) {
            *vertices = *last;
        }
        let mut way = 0.0;
        let mut ways = vec![0.0; vertices.len()];
        for i in 1..vertices.len() {
            way += distance(&vertices[i - 1], &vertices[i]);
            ways[i] = way;
        }
        Self { points: vertices, ways }
    }

    pub(super) fn points(&self) -> &[Joints] {
        &self.points
    }

    pub(super) fn ways(&self) -> &[f64] {
        &self.ways
    }

    pub(super) fn length(&self) -> f64 {
        self.ways.last().copied().unwrap_or_default()
    }

    /// Returns the points at these increasing arc lengths.
    pub(super) fn at(&self, ways: &[f64]) -> Vec<Joints> {
        let mut i = 1;
        ways.iter()
            .map(|way| {
                while i + 1 < self.ways.len() && self.ways[i] < *way {
                    i += 1;
                }
                let [from, to] = [self.ways[i - 1], self.ways[i]];
                let share = ((way - from) / (to - from)).clamp(0.0, 1.0);
                let [a, b] = [&self.points[i - 1], &self.points[i]];
                // Exact at both ends.
                std::array::from_fn(|j| (1.0 - share) * a[j] + share * b[j])
            })
            .collect()
    }

    /// Returns the parts between the points at which the path reverses, detected with this
    /// `tolerance`, in rad.
    pub(super) fn parts(&self, tolerance: f64) -> Vec<Self> {
        let corners = self.corners(tolerance);
        let mut stops = vec![0];
        for around in corners.windows(3) {
            let [before, point, after] = [0, 1, 2].map(|k| &self.points[around[k]]);
            let [into, leaving] = [vector::sub(point, before), vector::sub(after, point)];
            let cosine =
                vector::dot(&into, &leaving) / (vector::norm(&into) * vector::norm(&leaving));
            if cosine < SHARPEST {
                stops.push(around[1]);
            }
        }
        stops.push(self.points.len().saturating_sub(1));
        stops.windows(2).map(|ends| Self::new(&self.points[ends[0]..=ends[1]])).collect()
    }

    /// Returns true if all points lie on the line from the first to the last, in order.
    pub(super) fn is_straight(&self, tolerance: f64) -> bool {
        self.corners(tolerance).len() <= 2
    }

    /// Returns the indices of the remaining points after removal of points within `tolerance` of
    /// the lines between the others (Douglas and Peucker 1973), including the first and the last.
    fn corners(&self, tolerance: f64) -> Vec<usize> {
        let last = self.points.len().saturating_sub(1);
        let mut corners = vec![0];
        let mut open = vec![(0, last)];
        while let Some((from, to)) = open.pop() {
            let worst = (from + 1..to)
                .map(|i| (i, line_distance(&self.points[i], &self.points[from], &self.points[to])))
                .max_by(|a, b| a.1.total_cmp(&b.1));
            match worst {
                Some((index, off)) if off > tolerance => open.extend([(index, to), (from, index)]),
                _ => corners.push(to),
            }
        }
        corners.dedup();
        corners
    }
}

/// Returns the distance of a point from the line segment between two points.
fn line_distance(point: &Joints, from: &Joints, to: &Joints) -> f64 {
    let [line, way] = [vector::sub(to, from), vector::sub(point, from)];
    let length = vector::dot(&line, &line);
    let share =
        if length > 0.0 { (vector::dot(&way, &line) / length).clamp(0.0, 1.0) } else { 0.0 };
    vector::norm(&vector::sub(&way, &vector::scale(share, &line)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(points: &[[f64; 2]]) -> Polyline {
        let points: Vec<Joints> =
            points.iter().map(|[a, b]| [*a, *b, 0.0, 0.0, 0.0, 0.0, 0.0]).collect();
        Polyline::new(&points)
    }

    #[test]
    fn repeated_points_are_left_out() {
        let line =
            plane(&[[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 1.0 + 1e-9], [1.0, 1.0]]);
        assert_eq!(line.points().len(), 3);
        assert_eq!(line.points()[2][1], 1.0);
        assert!((line.length() - 2.0).abs() < 1e-9);
        assert_eq!(plane(&[[0.5, 0.5]; 3]).points().len(), 1);
    }

    #[test]
    fn the_way_is_straight_with_points_in_between() {
        assert!(plane(&[[0.0, 0.0], [0.3, 0.3], [1.0, 1.0]]).is_straight(1e-9));
        assert!(!plane(&[[0.0, 0.0], [0.3, 0.31], [1.0, 1.0]]).is_straight(1e-9));
        // Beyond the end and back.
        assert!(!plane(&[[0.0, 0.0], [1.5, 1.5], [1.0, 1.0]]).is_straight(1e-9));
    }

    #[test]
    fn the_arm_stops_where_the_way_turns_back() {
        let there_and_back = plane(&[[0.0, 0.0], [1.0, 0.0], [0.2, 0.0]]);
        assert_eq!(there_and_back.parts(0.001).len(), 2);
        let hairpin = plane(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1e-4], [0.0, 1e-4]]);
        assert_eq!(hairpin.parts(0.001).len(), 2);
        let corner = plane(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]);
        assert_eq!(corner.parts(0.001).len(), 1);
    }
}
