//! Boxes as obstacles, and around other shapes.

use glam::DVec3 as Vector;

/// Box by its centre, its axes and half of its edge lengths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedBox {
    center: Vector,
    axes: [Vector; 3],
    pub(crate) half: Vector,
}

impl PlacedBox {
    /// Creates the box with this centre and these edge lengths, whose axes are the columns of
    /// `rows`.
    pub(crate) fn new(center_m: [f64; 3], size_m: [f64; 3], rows: [[f64; 3]; 3]) -> Self {
        Self {
            center: center_m.into(),
            axes: std::array::from_fn(|i| Vector::new(rows[0][i], rows[1][i], rows[2][i])),
            half: 0.5 * Vector::from(size_m),
        }
    }

    /// Creates the box between two corners, along the axes of the base.
    pub(crate) fn between(low: Vector, high: Vector) -> Self {
        let axes = [Vector::X, Vector::Y, Vector::Z];
        Self { center: 0.5 * (low + high), axes, half: 0.5 * (high - low) }
    }

    /// Transforms a direction from the base frame to the box frame.
    fn turn_back(&self, direction: Vector) -> Vector {
        let [x, y, z] = self.axes;
        Vector::new(x.dot(direction), y.dot(direction), z.dot(direction))
    }

    /// Transforms a direction from the box frame to the base frame.
    fn turn(&self, local: Vector) -> Vector {
        let [x, y, z] = self.axes;
        local.x * x + local.y * y + local.z * z
    }

    /// Returns the point of the box nearest to `point`.
    pub(crate) fn nearest(&self, point: Vector) -> Vector {
        let local = self.turn_back(point - self.center);
        self.center + self.turn(local.clamp(-self.half, self.half))
    }

    /// Returns the farthest point along `direction`, which may have any length.
    pub(crate) fn support(&self, direction: Vector) -> Vector {
        self.center + self.turn(self.half.copysign(self.turn_back(direction)))
    }

    /// Returns the largest `direction . x` of the box's points.
    pub(crate) fn farthest_along(&self, direction: Vector) -> f64 {
        self.center.dot(direction) + self.half.dot(self.turn_back(direction).abs())
    }
}
